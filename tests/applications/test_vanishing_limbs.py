# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Limbs that only one of two flat shapes has retract along themselves, as wide as they are."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.flat.flat_morph import flat_morph
from convwass_addon.applications.flat.flat_settings import FlatSettings
from convwass_addon.applications.flat.flat_shapes import FlatShape
from convwass_addon.applications.morphs.layouts import path_blends
from convwass_addon.applications.motions.guided_settings import GuidedSettings
from convwass_addon.applications.motions.motion_request import MotionRequest
from convwass_addon.applications.outlines import vanishing_limbs
from convwass_addon.applications.outlines.agreeing_motion import AgreeingMotion
from convwass_addon.applications.outlines.attached_limbs import with_limb
from convwass_addon.applications.outlines.extruded_motion import extruded_motion
from convwass_addon.applications.outlines.limb_motion import LimbMotion, with_added_limbs
from convwass_addon.applications.outlines.outline_motion import outline_motion
from convwass_addon.applications.outlines.outline_pairs import KnownMatches
from convwass_addon.applications.outlines.outlined_shape import OutlinedShape
from convwass_addon.applications.outlines.vanishing_limbs import shape_bodies
from convwass_addon.errors import Cancelled
from convwass_addon.geometry.meshes.edges import topology, vertex_components
from convwass_addon.geometry.plane.closed_curves import ClosedCurve, boundary_of
from convwass_addon.geometry.plane.outline_limbs import outline_limbs, without_limb
from convwass_addon.geometry.plane.planar_fill import filled_boundary
from convwass_addon.geometry.remeshing.planar_mesh import planar_mesh
from convwass_addon.progress import UNINTERRUPTED, Control
from tests.applications.maps import coarse_outlines
from tests.flat_shapes import rectangle
from tests.shapes import extruded

LETTER_L = np.array([(0, 0), (4, 0), (4, 1), (1, 1), (1, 8), (0, 8)], float)
LETTER_I = rectangle((0, 0), (1, 8))
LETTER_T = np.array([(-0.5, 0), (0.5, 0), (0.5, 5), (3, 5), (3, 6), (-3, 6), (-3, 5), (-0.5, 5)], float)
LETTER_E = np.array(
    [(0, 0), (4, 0), (4, 1), (1, 1), (1, 3), (3.5, 3), (3.5, 4), (1, 4), (1, 6), (4, 6), (4, 7), (0, 7)], float
)
LETTER_F = np.array([(0, 0), (1, 0), (1, 3), (3.5, 3), (3.5, 4), (1, 4), (1, 6), (4, 6), (4, 7), (0, 7)], float)
# Without both halves of a stem, the bar is a limb.
LETTER_H = np.array(
    [(0, 0), (1, 0), (1, 3.5), (4, 3.5), (4, 0), (5, 0), (5, 8), (4, 8), (4, 4.5), (1, 4.5), (1, 8), (0, 8)], float
)
LETTER_A = np.array([(-2.5, 0), (-1.3, 0), (-0.9, 1.4), (0.9, 1.4), (1.3, 0), (2.5, 0), (0.7, 7), (-0.7, 7)], float)
HALF_X = np.array([(2.5, 0), (0.7, 3.5), (2.5, 7), (1.3, 7), (0, 4.6)], float)
LETTER_X = np.concatenate([HALF_X, HALF_X[-2::-1] * (-1, 1), [(-1.3, 0), (0, 2.4), (1.3, 0)]])
TIMES = (0.25, 0.5, 0.75)
BOTH_WAYS = [(0, 1)]


@pytest.fixture(scope="module", autouse=True)
def coarse():
    with coarse_outlines():
        yield


def filled(*rings):
    return filled_boundary(list(rings), "even-odd")


def beside(ring):
    return ring + np.array([6.0, 0.0])


def limb_counts(*rings, pairs=BOTH_WAYS):
    bodies = shape_bodies([OutlinedShape.of(filled(ring)) for ring in rings], pairs, KnownMatches(), UNINTERRUPTED)
    return [len(body.limbs) for body in bodies]


def motion_of(*rings, pairs=BOTH_WAYS, coherence=0.5):
    names = [f"shape {index}" for index in range(len(rings))]
    parts = [filled(ring) for ring in rings]
    return outline_motion(parts, names, pairs, GuidedSettings(coherence=coherence), UNINTERRUPTED)


def test_outlines_without_limbs_are_not_compared(monkeypatch):
    def unwanted(*_outlines):
        raise AssertionError("no match is needed")

    monkeypatch.setattr(vanishing_limbs, "rough_work", unwanted)
    assert limb_counts(LETTER_I, rectangle((0, 0), (3, 4))) == [0, 0]


@pytest.mark.parametrize(
    ("one", "other", "counts"),
    [
        (LETTER_E, LETTER_F, [1, 0]),
        (LETTER_F, LETTER_E, [0, 1]),
        (LETTER_L, LETTER_I, [1, 0]),
        (LETTER_T, LETTER_I, [2, 0]),
        (LETTER_E, LETTER_I, [3, 0]),
        (LETTER_H, LETTER_I, [3, 0]),
        (LETTER_E, LETTER_E, [0, 0]),
        (LETTER_E, 2.0 * LETTER_E + 1.0, [0, 0]),
    ],
)
def test_which_limbs_vanish(one, other, counts):
    assert limb_counts(one, other) == counts


def test_a_symmetric_pair_stays_symmetric():
    """An X without one of its arms would match an A better."""
    assert limb_counts(LETTER_A, LETTER_X) == [0, 0]


def test_a_shape_that_turns_keeps_its_limbs():
    assert limb_counts(LETTER_L, np.array([4.0, 8.0]) - LETTER_L) == [0, 0]


def test_a_shape_that_would_turn_loses_its_limbs_if_the_rest_matches_better():
    """An L looks more like an inverted T than like an upright one."""
    assert limb_counts(LETTER_L, LETTER_T) == [1, 2]


def test_a_limb_that_the_next_shape_has_stays():
    """On a path from an E to an F to an E, and on one with two F, the limb vanishes; among E, E and F, it does not."""
    path = [(0, 1), (1, 2)]
    assert limb_counts(LETTER_E, LETTER_F, LETTER_E, pairs=path) == [1, 0, 1]
    assert limb_counts(LETTER_E, LETTER_E, LETTER_F, pairs=path) == [0, 0, 0]


def test_shapes_of_several_regions_lose_the_limbs_of_each():
    shapes = [OutlinedShape.of(filled(*own)) for own in ((LETTER_E, beside(LETTER_L)), (LETTER_F, beside(LETTER_I)))]
    bodies = shape_bodies(shapes, BOTH_WAYS, KnownMatches(), UNINTERRUPTED)
    assert [len(body.limbs) for body in bodies] == [2, 0]
    assert bodies[0].shape.filled.area == pytest.approx(shapes[0].filled.area - 6.0)


def test_shapes_of_different_numbers_of_regions_keep_their_limbs():
    shapes = [OutlinedShape.of(filled(*own)) for own in ((LETTER_E, beside(LETTER_L)), (LETTER_F,))]
    assert [body.limbs for body in shape_bodies(shapes, BOTH_WAYS, KnownMatches(), UNINTERRUPTED)] == [(), ()]


def test_regions_of_different_numbers_of_holes_keep_their_limbs():
    hole = rectangle((0.2, 0.2), (0.8, 0.8))
    shapes = [OutlinedShape.of(own) for own in (filled(LETTER_E), filled(LETTER_F, hole))]
    assert [body.limbs for body in shape_bodies(shapes, BOTH_WAYS, KnownMatches(), UNINTERRUPTED)] == [(), ()]
    shapes = [OutlinedShape.of(own) for own in (filled(LETTER_E, hole), filled(LETTER_F, hole))]
    assert [len(body.limbs) for body in shape_bodies(shapes, BOTH_WAYS, KnownMatches(), UNINTERRUPTED)] == [1, 0]


def test_the_search_stops_when_cancelled():
    control = Control()
    control.cancel()
    with pytest.raises(Cancelled):
        shape_bodies(
            [OutlinedShape.of(filled(ring)) for ring in (LETTER_E, LETTER_F)], BOTH_WAYS, KnownMatches(), control
        )


def test_a_limb_slides_back_onto_a_cut_that_bends():
    """A limb of length 3 on a body that turned by 90 degrees, twice as large, and whose side became an arc."""
    curve = ClosedCurve(LETTER_L)
    (limb,) = outline_limbs(curve, [], (0.1, 4.0))
    body = planar_mesh(boundary_of([without_limb(limb)]).divided(0.25), 0.25)
    whole, attached = with_limb(body, limb, 0.3, np.empty((0, 2)))
    assert whole.area == pytest.approx(11.0)
    assert topology(whole).open_edges > 0
    assert attached.along[[0, -1]] == pytest.approx([0.0, 1.0])
    places = whole.vertices[len(body.vertices) :, :2]
    assert attached.moved(body.vertices, 1.0, 1.0)[:, :2] == pytest.approx(places)
    bent = body.vertices.copy()
    inner = body.vertices[attached.root, 1]
    bent[attached.root, 0] += inner * (1.0 - inner)
    bent = np.column_stack([-2.0 * bent[:, 1], 2.0 * bent[:, 0], bent[:, 2]])
    found = attached.moved(bent, 0.5, 2.0)[:, :2]
    back = np.column_stack([found[:, 1], -found[:, 0]]) / 2.0
    on_root = np.interp(places[:, 1], np.sort(inner), np.sort(inner) * (1.0 - np.sort(inner)))
    assert back[:, 1] == pytest.approx(places[:, 1])
    assert back[:, 0] == pytest.approx(1.0 + on_root + np.maximum(places[:, 0] - 2.5, 0.0))


@pytest.mark.parametrize("rings", [(LETTER_L, LETTER_I), (LETTER_I, LETTER_L)], ids=["retracting", "growing"])
def test_the_foot_of_an_l(rings):
    """It is one unit high up to its end, in both shapes."""
    moved = with_added_limbs(motion_of(*rings), BOTH_WAYS)
    for time in TIMES:
        shapes = moved.choice.motion.moved([time if ring is LETTER_L else 1.0 - time for ring in rings])
        for sheet, shape in zip(moved.sheets, shapes, strict=True):
            found = sheet.moved(shape)
            assert found.area == pytest.approx(8.0 + 3.0 * time, rel=1e-3)
            assert np.ptp(found.bounds, axis=0) == pytest.approx([1.0 + 3.0 * time, 8.0], rel=1e-3)
            tip = found.bounds[0] + np.array([(0.9 + 3.0 * time, height) for height in (0.05, 0.95, 1.05)])
            assert found.resolved().contains(tip).tolist() == [True, True, False]


def test_the_bar_of_an_h_takes_its_stem_along():
    """Halfway, the bar is half as long, and both halves of the stem at its end are, too."""
    moved = with_added_limbs(motion_of(LETTER_H, LETTER_I), BOTH_WAYS)
    for sheet, shape in zip(moved.sheets, moved.choice.motion.moved([0.5, 0.5]), strict=True):
        found = sheet.moved(shape)
        assert found.area == pytest.approx(8.0 + 2.0 + 3.5, rel=1e-3)
        assert np.ptp(found.bounds, axis=0) == pytest.approx([3.0, 8.0], rel=1e-3)


def test_a_path_back_to_the_same_shape():
    moved = with_added_limbs(motion_of(LETTER_E, LETTER_F, LETTER_E, pairs=[(0, 1), (1, 2)]), [(0, 1), (1, 2)])
    for weights in ((0.5, 0.5, 0.0), (0.0, 0.5, 0.5)):
        shapes = moved.choice.motion.moved(weights)
        areas = [sheet.moved(own).area for sheet, own in zip(moved.sheets, shapes, strict=True) if own is not None]
        assert areas == pytest.approx([14.0] * 2, rel=1e-3)


def test_limbs_that_would_collide_stay(monkeypatch):
    monkeypatch.setattr("convwass_addon.applications.outlines.limb_motion.largest_overlap", lambda *_: 0.002)
    assert isinstance(motion_of(LETTER_L, LETTER_I).choice.motion, AgreeingMotion)


def test_records_tell_how_many_limbs_retract():
    assert motion_of(LETTER_T, LETTER_I).choice.record()["limbs"] == 2
    assert "limbs" not in motion_of(LETTER_I, LETTER_I).choice.record()


def test_shapes_that_come_half_of_the_way_lend_nothing():
    moved = motion_of(LETTER_L, LETTER_I, coherence=0.25)
    assert isinstance(moved.choice.motion, LimbMotion)
    assert with_added_limbs(moved, BOTH_WAYS) is moved
    one, other = moved.choice.motion.moved([0.5, 0.5])
    assert moved.sheets[0].moved(one).area == pytest.approx(8.0 + 3.0 * 0.75, rel=1e-2)
    assert moved.sheets[1].moved(other).area == pytest.approx(8.0, rel=1e-2)


def test_frames_have_no_wedges():
    """An E that becomes an F has right angles all the way; corners are rounded within a cell."""
    shapes = [FlatShape((ring,), "even-odd") for ring in (LETTER_E, LETTER_F)]
    settings = FlatSettings(resolution=96)
    frames = [step.payload for step in flat_morph(shapes, ["E", "F"], path_blends(2, 4), settings) if step.payload]
    for frame in frames[1:-1]:
        (ring,) = frame.outline.rings
        edges = np.roll(ring, -1, axis=0) - ring
        slanted = np.abs(edges).min(axis=1) > 0.05 * np.abs(edges).max(axis=1)
        assert np.linalg.norm(edges[slanted], axis=1).sum() < 0.15 * np.linalg.norm(edges, axis=1).sum()


def test_solid_letters():
    """Both solids are closed, in one piece without walls inside, and have the volume between both."""
    request = MotionRequest([extruded(LETTER_L), extruded(LETTER_I)], ["L", "I"], BOTH_WAYS, "automatic", 0.5)
    motion = extruded_motion(request, UNINTERRUPTED).motion
    depth = request.shapes[1].volume / 8.0
    for time in TIMES:
        for own in motion.moved([time, 1.0 - time]):
            assert own.mesh.volume == pytest.approx(depth * (8.0 + 3.0 * time), rel=2e-3)
            assert topology(own.mesh).closed
    owner = motion.moved([0.5, 0.5])[0]
    assert vertex_components(owner.mesh).max() == 0
