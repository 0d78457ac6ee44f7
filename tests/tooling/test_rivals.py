# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What else Blender offers is blended as it says, and the figures mean what they say."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks import side_by_side
from benchmarks.rival_measures import Hold, Passage, detour, overlap, solid
from benchmarks.rivals import METHODS, TIMES, Ends, has_sdf_grids
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.applications.morphs.volumes import Lattice
from convwass_addon.geometry.mesh import TriangleMesh
from tests.shapes import ball, joined, torus

RADII = (1.0, 0.6)
CELLS = 40


@pytest.fixture(scope="module")
def balls():
    """Two balls of different size about one center, of which every method's frames are known."""
    shapes = tuple(ball(radius) for radius in RADII)
    settings = MorphSettings(resolution=CELLS)
    return Ends(("large", "small"), shapes, settings, Lattice.around(shapes, CELLS, settings.sigma))


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.usefixtures("empty_scene")
def test_balls_become_each_other(method, balls):
    if method == "sdf" and not has_sdf_grids():
        pytest.skip("this Blender has no SDF grids")
    frames = METHODS[method](balls)
    assert len(frames) == len(TIMES)
    volumes = [shape.volume for shape in balls.shapes]
    for t, frame in zip(TIMES, frames, strict=True):
        # A radius is interpolated where distances or places are, and the volume where mass is.
        by_radius = 4.0 / 3.0 * np.pi * ((1.0 - t) * RADII[0] + t * RADII[1]) ** 3
        by_volume = (1.0 - t) * volumes[0] + t * volumes[1]
        assert frame.volume == pytest.approx(by_radius if method in ("sdf", "shrinkwrap") else by_volume, rel=0.03)
        np.testing.assert_allclose(frame.vertices.mean(axis=0), 0.0, atol=0.03)


def passage(middle):
    ends = (ball(0.3, (-1.0, 0.0, 0.0)), ball(0.3, (1.0, 0.0, 0.0)))
    lattice = Lattice.around([joined(*ends)], 64, 1.0)
    lattice = Lattice(lattice.shape, lattice.spacing, lattice.origin, np.zeros((1, 3)))
    return Passage.of((ends[0], middle, ends[1]), ends, (0.0, 0.5, 1.0), lattice)


def test_what_travels_is_under_way_and_goes_straight():
    found = passage(ball(0.3))
    assert found.outside == 1.0
    assert found.detour == pytest.approx(1.0, abs=0.01)
    np.testing.assert_allclose(found.volumes, 1.0, atol=0.01)
    assert (found.pieces, found.handles, found.smallest, found.arrival) == (1, 0, 1.0, 1.0)


def test_what_fades_stays_and_makes_a_detour():
    # Half of the mass here and half there: the half that is nearer has gone all the way.
    size = 0.3 * 0.5 ** (1.0 / 3.0)
    found = passage(joined(ball(size, (-1.0, 0.0, 0.0)), ball(size, (1.0, 0.0, 0.0))))
    assert found.outside == 0.0
    # The middle of half a ball is three eighths of the radius away from its center.
    near, far = 3.0 / 8.0 * 0.3, 2.0 - 3.0 / 8.0 * 0.3
    assert found.detour == pytest.approx(np.sqrt(0.5 * (near**2 + far**2)), abs=0.01)
    assert found.pieces == 2
    assert found.smallest == pytest.approx(0.5, abs=0.01)


def test_the_way_through_an_end_is_no_detour():
    filled = np.zeros((2, 24, 24, 24))
    filled[0, 4:8, 8:16, 8:16] = filled[1, 14:18, 8:16, 8:16] = 1.0
    assert detour(filled[0], filled) == pytest.approx(1.0, abs=1e-3)


def test_pieces_handles_and_bubbles_are_counted():
    both = joined(torus(), ball(0.5, (3.0, 0.0, 0.0)), ball(0.2, (3.0, 0.0, 0.0)).flipped())
    hold = Hold.of(both)
    assert len(hold.shares) == 2
    assert hold.handles == 1
    np.testing.assert_allclose(hold.shares.sum(), 1.0)


def test_overlap_of_a_shape_with_half_of_it():
    whole = np.ones((4, 4, 4))
    half = whole.copy()
    half[:2] = 0.0
    assert overlap(whole, half) == 0.5
    shape = ball(1.0)
    lattice = Lattice.around([shape], 32, 1.0)
    assert overlap(solid(shape, lattice), solid(TriangleMesh(shape.vertices, shape.faces), lattice)) == 1.0


def test_the_table_has_all_methods_and_says_what_is_missing(monkeypatch, capsys):
    found = {
        "outside": 0.0123,
        "detour": 1.234,
        "volumes": [1.0, 0.9, 0.5, 1.2, 1.0],
        "pieces": 3,
        "handles": 2,
        "smallest": 0.25,
        "arrival": 0.987,
        "cpu": 4.5,
    }
    monkeypatch.setattr(
        side_by_side, "measured", lambda *_, method, **__: {"missing": "needs more"} if method == "sdf" else found
    )
    side_by_side.main(32)
    printed = capsys.readouterr().out
    for title in side_by_side.TITLES.values():
        assert printed.count(title) == len(side_by_side.PAIRS)
    (line,) = {line for line in printed.splitlines() if line.startswith("Convwass")}
    assert line.split() == ["Convwass", "1.2", "%", "1.23", "-50.0", "%", "3", "25", "%", "2", "99", "%", "4.5"]
    assert "needs more" in printed
