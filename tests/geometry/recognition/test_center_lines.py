# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tubes have a center line; other solids have none."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from convwass_addon.errors import Cancelled
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.plane.polylines import along_polyline
from convwass_addon.geometry.recognition import center_lines
from convwass_addon.geometry.recognition.center_lines import sliced_tube
from convwass_addon.geometry.remeshing.subdivision import with_short_edges
from convwass_addon.progress import Control
from tests.applications.maps import arm
from tests.grids import figure
from tests.line_tubes import helix, straight, tube
from tests.shapes import ball, box, capsules, joined, torus


@pytest.mark.parametrize(
    "line", [straight(), helix(0.5, 0.5, 3.0), helix(1.0, 0.0, 0.8)], ids=["straight", "spring", "arc"]
)
@pytest.mark.parametrize("size", [1.0, 1e-3, 1e4])
def test_the_line_is_in_the_middle(line, size):
    found = sliced_tube(tube(size * line, 0.1 * size))
    away, _ = cKDTree(size * line).query(found.points)
    spacing = np.linalg.norm(np.diff(line, axis=0), axis=1).max()
    assert away.max() < (0.5 * spacing + 0.01) * size
    steps = np.linalg.norm(np.diff(found.points, axis=0), axis=1)
    assert steps == pytest.approx(steps.mean(), rel=0.01)
    length = np.linalg.norm(np.diff(line, axis=0), axis=1).sum()
    assert steps.sum() / size == pytest.approx(length, rel=0.01)
    assert found.radii / size == pytest.approx(0.1, rel=0.06)


def test_radii_follow_a_taper():
    line = straight(6.0, 80)
    radii = np.linspace(0.3, 0.1, 80)
    found = sliced_tube(tube(line, radii))
    # Those of the ends are as wide as the slices next to them.
    inner = slice(12, -12)
    assert found.radii[inner] == pytest.approx(np.interp(found.points[inner, 2], line[:, 2], radii), rel=0.05)


@pytest.mark.parametrize("rings", [(12, 30), (24, 60)])
def test_the_line_of_a_straight_arm_is_straight(rings):
    points = sliced_tube(arm(0.0, *rings)[0]).points
    along = np.diff(points, axis=0) / np.linalg.norm(np.diff(points, axis=0), axis=1, keepdims=True)
    turns = np.arccos(np.clip((along[1:] * along[:-1]).sum(axis=1), -1.0, 1.0))
    assert np.degrees(turns.sum()) < 8.0


def test_the_line_does_not_depend_on_rounding():
    """Although several vertices of an end are equally far away."""
    rod = tube(helix(0.5, 0.5, 3.0))
    expected = sliced_tube(rod).points
    for seed in range(4):
        turn = Rotation.random(rng=np.random.default_rng(seed))
        found = sliced_tube(TriangleMesh(turn.apply(rod.vertices), rod.faces)).points
        np.testing.assert_allclose(found, turn.apply(expected), atol=1e-6)


@pytest.mark.parametrize("longer", [1.0 - 1e-13, 1.0, 1.0 + 1e-13])
def test_of_two_ends_that_are_equally_far_the_same_one_is_the_first(longer):
    """Whichever of them rounding makes the farther one from the first vertex."""
    rod = tube(straight(4.0, 41))
    half = 20 * 12
    vertices = np.roll(rod.vertices, -half, axis=0) - [0.0, 0.0, 2.0]
    vertices[vertices[:, 2] > 0.0] *= longer
    found = sliced_tube(TriangleMesh(vertices, (rod.faces - half) % len(vertices)))
    assert found.points[0, 2] > 1.9


def test_vertices_without_triangles_do_not_matter():
    rod = tube(helix(1.0, 0.0, 0.8))
    expected, found = sliced_tube(rod), sliced_tube(joined(TriangleMesh([[9.0, 9.0, 9.0]], np.empty((0, 3), int)), rod))
    np.testing.assert_array_equal(found.points, expected.points)
    np.testing.assert_array_equal(found.divided.parents, expected.divided.parents)


def test_the_search_can_be_cancelled():
    control = Control()
    control.cancel()
    with pytest.raises(Cancelled):
        sliced_tube(tube(straight()), control)


def test_vertices_are_beside_their_points():
    found = sliced_tube(tube(helix(0.5, 0.5, 3.0)))
    points = along_polyline(found.places, np.arange(len(found.points)), found.points)
    inner = np.abs(found.places / (len(found.points) - 1.0) - 0.5) < 0.48
    away = np.linalg.norm(found.divided.mesh.vertices - points, axis=1)[inner]
    assert away == pytest.approx(0.1, rel=0.1)


@pytest.mark.parametrize(
    "solid",
    [ball(), torus(1.0, 0.1), figure(40)[0], joined(tube(straight()), tube(np.add(straight(), 1.0)))],
    ids=["ball", "ring", "figure", "two tubes"],
)
def test_what_is_round_closed_branching_or_apart_is_no_tube(solid):
    assert sliced_tube(solid) is None


@pytest.mark.parametrize(
    "solid",
    [
        tube(straight(20.0, 401), np.where(np.abs(np.linspace(-10.0, 10.0, 401)) < 0.06, 2.0, 0.1)),
        with_short_edges(box((0.02, 0.5, 8.0)), 0.2, 20_000).mesh,
        capsules(
            [((0, 0, 0), (0, 0, 4), 0.2), ((0, 0, 1), (0, 1.5, 2.5), 0.2)], (-0.4, -0.4, -0.4), (0.4, 2, 4.4), 0.1
        ),
    ],
    ids=["with a disc", "flat", "forked"],
)
def test_what_is_long_but_no_tube_is_none(solid):
    assert sliced_tube(solid) is None


def test_a_pot_with_a_spout_and_a_handle_that_ends_freely_is_no_tube():
    """At every length along the surface from the end of the handle, it is in one piece."""
    angles = np.linspace(-1.4, 1.2, 12)
    hook = np.stack([0.6 + 0.45 * np.cos(angles), 0.0 * angles, 0.05 + 0.36 * np.sin(angles)], axis=1)
    handle = [(start, end, 0.065) for start, end in pairwise([(0.45, 0.0, -0.2), *hook[1:]])]
    spout = [((-0.5, 0.0, -0.15), (-0.9, 0.0, 0.2), 0.12), ((-0.9, 0.0, 0.2), (-1.1, 0.0, 0.45), 0.08)]
    pot = capsules([((0, 0, -0.02), (0, 0, 0.02), 0.6), *spout, *handle], (-1.4, -0.8, -0.8), (1.3, 0.8, 0.9), 0.05)
    assert sliced_tube(pot) is None


@pytest.mark.parametrize("width", [1e-5, 1e-9])
def test_a_ribbon_as_thin_as_a_hair_is_no_tube(width):
    corners = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, width, 0.0], [0.0, width, 0.0]]
    assert sliced_tube(TriangleMesh.from_arrays(corners, [[0, 1, 2], [0, 2, 3]])) is None


def test_what_has_too_few_vertices_along_it_is_no_tube(monkeypatch):
    monkeypatch.setattr(center_lines, "_MOST_VERTICES", 0)
    assert sliced_tube(tube(straight(4.0, 2))) is None
