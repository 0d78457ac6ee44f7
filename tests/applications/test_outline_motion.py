# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Flat shapes whose outlines are mapped onto each other: corners, symmetry, holes and lengths are kept."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import distance_transform_edt

from convwass_addon.applications.flat.flat_morph import flat_morph
from convwass_addon.applications.flat.flat_settings import FlatSettings
from convwass_addon.applications.flat.flat_shapes import FlatShape
from convwass_addon.applications.morphs.layouts import path_blends
from convwass_addon.applications.motions.guided_settings import GuidedSettings
from convwass_addon.applications.outlines.matched_outlines import MatchedOutlines, matched_outlines
from convwass_addon.applications.outlines.moved_sheets import MatchedShapes, moved_sheets
from convwass_addon.applications.outlines.outline_motion import outline_motion
from convwass_addon.applications.outlines.outline_pairs import KnownMatches, matched_shapes
from convwass_addon.applications.outlines.outlined_shape import OutlinedShape
from convwass_addon.applications.outlines.sliding_outlines import least_effort
from convwass_addon.geometry.plane.coverage import coverage, self_overlap
from convwass_addon.geometry.plane.curve_maps import even_map
from convwass_addon.geometry.plane.outlines import ring_area
from convwass_addon.geometry.plane.planar_fill import filled_boundary
from convwass_addon.geometry.plane.ring_nesting import boundary_rings
from convwass_addon.progress import UNINTERRUPTED
from tests.applications.maps import coarse_outlines
from tests.flat_shapes import ellipse, rectangle

TIMES = (0.2, 0.5, 0.8)
AROUND = np.linspace(0.0, 2.0 * np.pi, 96, endpoint=False)
HEART = np.stack([np.sin(AROUND) ** 3, (13 * np.cos(AROUND) - 5 * np.cos(2 * AROUND) - 2 * np.cos(3 * AROUND)) / 16], 1)


@pytest.fixture
def coarse():
    with coarse_outlines():
        yield


def star(count=5, inner=0.45):
    angles = np.pi / 2 + np.arange(2 * count) * np.pi / count
    radii = np.where(np.arange(2 * count) % 2, inner, 1.0)
    return np.stack([radii * np.cos(angles), radii * np.sin(angles)], axis=1)


def filled(*rings):
    return filled_boundary(list(rings), "even-odd")


def moved(first, second, *times):
    """Each of the times with both shapes at that moment of their motion, which is solved once for all of them."""
    motion = outline_motion([first, second], ["one", "other"], [(0, 1)], GuidedSettings(), UNINTERRUPTED)
    for time in times:
        shapes = motion.choice.motion.moved([1.0 - time, time])
        yield time, [sheet.moved(shape) for sheet, shape in zip(motion.sheets, shapes, strict=True)]


def halfway(first, second):
    """Both shapes in the middle of their motion."""
    ((_, shapes),) = moved(first, second, 0.5)
    return shapes


def overlap(one, other):
    """Intersection over union of two areas, on fine cells."""
    low = np.minimum(one.bounds[0], other.bounds[0]) - 0.05
    factor = 400 / float((np.maximum(one.bounds[1], other.bounds[1]) + 0.05 - low).max())
    cells = [coverage(own.moved(-low * factor, factor), (400, 400)) for own in (one, other)]
    return np.minimum(*cells).sum() / np.maximum(*cells).sum()


def mirrored(boundary, center=0.0):
    """A boundary reflected about a vertical line."""
    return filled_boundary(
        [(ring * (-1.0, 1.0) + (2.0 * center, 0.0))[::-1] for ring in boundary_rings(boundary)], "non-zero"
    )


@pytest.mark.parametrize(
    ("first", "second"),
    [(filled(HEART), filled(star())), (filled(star(8)), filled(star()))],
)
def test_both_shapes_coincide_and_stay_symmetric_all_along_the_way(first, second):
    for _, (one, other) in moved(first, second, *TIMES):
        assert overlap(one, other) > 0.99
        for own in (one, other):
            assert overlap(own, mirrored(own, own.center[0])) > 0.985


def test_a_square_that_grows_keeps_its_corners():
    for time, shapes in moved(filled(rectangle((-1, -1), (1, 1))), filled(rectangle((-3, -2), (3, 2))), *TIMES):
        sides = 2.0 + time * np.array([4.0, 2.0])
        for own in shapes:
            assert np.ptp(own.bounds, axis=0) == pytest.approx(sides, rel=0.01)
            assert own.area == pytest.approx(np.prod(sides), rel=0.015)


def test_a_square_that_becomes_a_bar_keeps_its_corners():
    """Its sides are more like the long ones of the bar than like the ends."""
    square, bar = filled(rectangle((-1, -1), (1, 1))), filled(rectangle((-8, -1), (8, 1)))
    for time, shapes in moved(square, bar, *TIMES):
        for own in shapes:
            width, height = np.ptp(own.bounds, axis=0)
            assert (width, height) == pytest.approx((2.0 + 14.0 * time, 2.0), rel=0.04)
            assert own.area == pytest.approx(width * height, rel=0.04)


def test_a_hole_of_one_shape_shrinks_to_a_point():
    # So small that opening it to the outside is not tried.
    ring, disc = filled(ellipse(), ellipse(radii=(0.3, 0.3))[::-1]), filled(ellipse())
    for time, shapes in moved(ring, disc, *TIMES):
        for own in shapes:
            assert np.sqrt(hole_of(own) / np.pi) == pytest.approx((1.0 - time) * 0.3, abs=0.01)


# A hook whose corner has room for a hole.
BRACKET = np.array([(0, 0), (3, 0), (3, 0.6), (1.4, 0.6), (1.4, 1.4), (0.4, 1.4), (0.4, 3), (0, 3)])
ROUND = ellipse((0.9, 0.75), (0.35, 0.35))


def hole_of(boundary):
    """The area of its only hole."""
    (hole,) = (-area for area in map(ring_area, boundary_rings(boundary)) if area < 0)
    return hole


def rotated(points, angle):
    cosine, sine = np.cos(angle), np.sin(angle)
    return points @ np.array([[cosine, sine], [-sine, cosine]])


def test_a_round_hole_turns_with_its_shape():
    """As it stands, it would match the other one without a turn, and shrink by a third or more on the way."""
    turned = filled(rotated(BRACKET, 1.0), rotated(ROUND, 1.0))
    for own in halfway(filled(BRACKET, ROUND), turned):
        assert hole_of(own) == pytest.approx(ring_area(ROUND), rel=0.02)


def test_a_hole_that_shrinks_to_a_point_turns_with_its_shape():
    ring, bracket = filled(BRACKET, ROUND), filled(rotated(BRACKET, 3.0))
    for own in (*halfway(ring, bracket), *halfway(bracket, ring)):
        assert hole_of(own) == pytest.approx(0.25 * ring_area(ROUND), rel=0.22)


def bent(angle):
    """A rod of two arms of the length 4, the second of which is turned by an angle about their joint."""
    middle = np.linspace(0.0, angle, 24)
    outer = np.stack([4.0 + 0.8 * np.sin(middle), 0.4 - 0.8 * np.cos(middle) + 0.4], axis=1)
    along, across = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    tip = outer[-1] + 4.0 * along
    inner = np.array([4.0, 0.8])
    return np.concatenate([[(0.0, 0.0)], outer, [tip, tip + 0.8 * across, inner], [(0.0, 0.8)]])


def test_a_limb_swings_without_losing_its_length():
    angles = 0.15, 1.9
    motion = outline_motion(
        [filled(bent(own)) for own in angles], ["down", "up"], [(0, 1)], GuidedSettings(), UNINTERRUPTED
    )
    for time in TIMES:
        moved_shapes = motion.choice.motion.moved([1.0 - time, time])
        for sheet, shape, angle in zip(motion.sheets, moved_shapes, angles, strict=True):
            # The joint and both ends of the inner side, which is not stretched.
            places = bent(angle)[[-2, -3, -1]]
            nearest = [int(np.square(sheet.mesh.vertices[:, :2] - place).sum(axis=1).argmin()) for place in places]
            joint, tip, root = shape.vertices[nearest, :2]
            assert np.linalg.norm([tip - joint, root - joint], axis=1) == pytest.approx([4.0, 4.0], rel=0.05)
            turn = np.arctan2(*(tip - joint)[::-1]) - np.arctan2(*(joint - root)[::-1])
            assert turn == pytest.approx(angles[0] + time * (angles[1] - angles[0]), abs=0.12)


def test_swapped_shapes_move_the_same_way_back():
    first, second = filled(HEART), filled(ellipse((0.5, 0.0), (1.5, 0.5), angle=0.6))
    ((_, there),), ((_, back),) = moved(first, second, 0.3), moved(second, first, 0.7)
    assert overlap(there[0], back[1]) > 0.97
    assert overlap(there[1], back[0]) > 0.97


def test_around_a_triangle_the_way_closes():
    shapes = [filled(HEART), filled(star()), filled(rectangle((-1, -1), (1, 1)))]
    motion = outline_motion(shapes, ["a", "b", "c"], [(0, 1), (0, 2), (1, 2)], GuidedSettings(), UNINTERRUPTED)
    for weights in ((0.3, 0.3, 0.4), (0.0, 0.5, 0.5), (1.0, 0.0, 0.0)):
        found = [
            sheet.moved(shape)
            for sheet, shape in zip(motion.sheets, motion.choice.motion.moved(weights), strict=True)
            if shape is not None
        ]
        for own in found[1:]:
            assert overlap(found[0], own) > 0.85
    assert overlap(found[0], shapes[0]) > 0.999


def test_holes_belong_to_the_region_around_them():
    boxes = [rectangle((0, 0), (4, 4)), rectangle((6, 0), (8, 2)), rectangle((0.5, 0.5), (3.5, 3.5))]
    shape = OutlinedShape.of(filled(*boxes, rectangle((1, 1), (3, 3)), rectangle((1.5, 1.5), (2, 2))))
    areas = np.round([ring_area(curve.points) for curve in shape.curves], 6)
    found = [(areas[region.outer], areas[list(region.holes)].tolist()) for region in shape.regions]
    assert sorted(found) == [(4.0, []), (4.0, [-0.25]), (16.0, [-9.0])]


def test_a_hole_belongs_to_the_region_around_it_if_another_one_touches_it_inside():
    rings = rectangle((-5, -5), (5, 5)), [(-3, 0), (0, -3), (3, 0), (-1, 3)], [(-3, 0), (-1, -0.5), (-1, 0.5)]
    shape = OutlinedShape.of(filled(*map(np.array, rings)))
    areas = np.round([ring_area(curve.points) for curve in shape.curves], 2)
    found = [(areas[region.outer], areas[list(region.holes)].tolist()) for region in shape.regions]
    assert sorted(found) == [(1.0, []), (100.0, [-18.0])]


def test_regions_of_similar_size_belong_together():
    """Rings and discs around one center are equally far from each other."""
    circles = [ellipse(radii=(radius, radius)) for radius in (3.0, 2.2, 1.4)]
    ovals = [ellipse(radii=(1.5 * radius, radius)) for radius in (1.2, 3.0, 2.4)]
    match = matched_shapes(OutlinedShape.of(filled(*circles)), OutlinedShape.of(filled(*ovals)))[0]
    for pair in match.pairs:
        areas = [
            ring_area(shape.curves[place].points)
            for shape, place in zip((match.first, match.second), (pair.first, pair.second), strict=True)
        ]
        assert areas[1] == pytest.approx(1.5 * areas[0], rel=0.4)


@pytest.mark.parametrize("order", [(0, 1, 2), (2, 0, 1), (1, 2, 0)])
def test_holes_that_are_near_each_other_belong_together(order):
    holes, bar = [ellipse((x, y), (0.3, 0.3)) for x, y in ((-2, 0.3), (0, -0.4), (2, 0.2))], rectangle((-3, -1), (3, 1))
    one, other = (
        OutlinedShape.of(filled_boundary([bar, *(holes[place] for place in own)], "even-odd"))
        for own in ((0, 1, 2), order)
    )
    (pair, *_) = matched_shapes(one, other)
    assert len(pair.pairs) == 4
    for own in pair.pairs:
        np.testing.assert_allclose(one.center(own.first), other.center(own.second), atol=0.01)


def test_a_region_with_fewer_matches_keeps_its_last_one():
    """The left one has one match here, and the right one two."""
    one, other = (
        OutlinedShape.of(filled_boundary(rings, "even-odd"))
        for rings in ([ellipse(), ellipse((9, 0))], [rectangle((-1, -1), (1, 1)), rectangle((8, -1), (10, 1))])
    )

    def matches(first, second):
        costs = (0.1,) if first.center[0] < 5.0 else (0.2, 0.3)
        return [MatchedOutlines(even_map(first.curve, second.curve), cost, 0.0, swings=False) for cost in costs]

    found = matched_shapes(one, other, KnownMatches(matches))
    assert [sorted(pair.cost for pair in own.pairs) for own in found] == [[0.1, 0.2], [0.1, 0.3]]


def test_a_round_hole_turns_with_what_is_around_it():
    """It keeps its size, although its outline matches that of the other hole as it stands."""
    hole, hook = ellipse((-0.3, 1.4), (0.15, 0.15)), np.array([[0, 0], [2, 0], [2, 0.5], [0.6, 0.5], [0.6, 3], [0, 3]])
    rings = [hook - (0.6, 1.2), hole[::-1]]
    cosine, sine = np.cos(2.0), np.sin(2.0)
    turned = [ring @ np.array([[cosine, sine], [-sine, cosine]]) for ring in rings]
    for _, shapes in moved(filled(*rings), filled(*turned), *TIMES):
        for own in shapes:
            assert hole_of(own) == pytest.approx(np.pi * 0.15**2, rel=0.05)


def test_the_match_that_distorts_the_inside_less_is_taken():
    """The arms of a figure that are raised swing; a plus does not bend to become a star."""
    swings = []
    for first, second in ((bent(0.15), bent(1.9)), (star(4, 0.3), star(5))):
        shapes = [OutlinedShape.of(filled(own)) for own in (first, second)]
        swings.append(least_effort(matched_shapes(*shapes), UNINTERRUPTED).swings)
    assert swings == [True, False]


def stroke(*pieces):
    """A line of the width 0.24."""
    line = np.concatenate(pieces)
    across = np.gradient(line, axis=0)[:, ::-1] * (-1.0, 1.0)
    across *= 0.12 / np.linalg.norm(across, axis=1, keepdims=True)
    return filled(np.concatenate([line - across, (line + across)[::-1]]))


def arc(center, radius, begin, end):
    angles = np.radians(np.linspace(begin, end, 40))
    return center + radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)


S_BOWS = arc((0, 0.5), 0.5, 30, 270), arc((0, -0.5), 0.5, 85, -150)


def test_limbs_do_not_swing_across_each_other():
    """The tail of a G would swing through its bowl to become that of an S; it unrolls around the outside."""
    tail = np.array([(0.87, -0.3), (0.87, -0.1), (0.85, 0.0), (0.7, 0.02), (0.5, 0.02), (0.3, 0.02)])
    g, s = stroke(arc((0, 0), 1, 50, 330), tail), stroke(*S_BOWS)
    shapes = [OutlinedShape.of(g), OutlinedShape.of(s)]
    match = least_effort([own for own in matched_shapes(*shapes) if own.unrolled == 0.0], UNINTERRUPTED)
    assert match.swings
    swung = MatchedShapes(shapes, {(0, 1): match})
    assert moved_sheets(swung, ["g", "s"], GuidedSettings(), UNINTERRUPTED).overlap < 0.001
    for _, shapes in moved(g, s, *TIMES):
        for own in shapes:
            cells = coverage(own.moved(-own.bounds[0] * 100, 100.0), (400, 400))
            assert cells.sum() / 100**2 == pytest.approx(own.area, rel=0.005)


def hook(height):
    """A U whose left arm has this height."""
    left, right = np.linspace((-0.5, height), (-0.5, 0.0), 20), np.linspace((0.5, 0.0), (0.5, 1.5), 20)
    return stroke(left[:-1], arc((0, 0), 0.5, 180, 360), right[1:])


def test_an_arm_that_grows_stays_upright():
    """A J becomes a U without leaning; as a stroke, all of it would turn."""
    for time, shapes in moved(hook(0.3), hook(1.5), *TIMES):
        expected = hook(0.3 + 1.2 * time)
        for own in shapes:
            assert overlap(own, expected.moved(own.center - expected.center)) > 0.93


def test_an_o_opens_without_spurs_at_its_ends():
    """Its ends swing apart to become those of a C; nothing is wider on the way than in one of the letters."""
    outer, inner = (np.degrees(np.arccos(0.55 / radius)) for radius in (1.0, 0.8))
    ends = [arc((0, 0), 1.0, outer, 360 - outer), arc((0, 0), 0.8, 360 - inner, inner)]
    o, c = filled(ellipse(), ellipse(radii=(0.8, 0.8))[::-1]), filled(np.concatenate(ends) * (1.15, 1.0))
    for own in halfway(o, c):
        cells = coverage(own.moved(-own.bounds[0] * 200.0 + 5.0, 200.0), (420, 420)) > 0.5
        assert distance_transform_edt(cells).max() / 200.0 < 0.115


def test_a_letter_stands_where_its_hole_opens():
    """A g becomes a U without a pinhole, and its tail does not swing through half of a circle."""
    g = filled(
        [(0, 0.6), (1, 0.6), (1, 0.2), (0, 0.2), (0, 0), (1.2, 0), (1.2, 2), (0, 2)],
        [(0.2, 0.8), (0.2, 1.8), (1, 1.8), (1, 0.8)],
    )
    u = filled([(0, 0), (1.2, 0), (1.2, 2), (1, 2), (1, 0.2), (0.2, 0.2), (0.2, 2), (0, 2)])
    for _, shapes in moved(g, u, *TIMES):
        for own in shapes:
            assert len(boundary_rings(own)) == 1
            np.testing.assert_allclose(np.ptp(own.bounds, axis=0), (1.2, 2.0), atol=0.4)


def test_a_corner_beside_an_axis_of_symmetry_is_matched():
    """The notch of this arrow has two corners, one of which is so near the axis that it is taken for its end."""
    arrow = [(-154, -143), (-88, -143), (-2, 102), (2, 102), (89, -143), (154, -143), (34, 185), (-34, 185)]
    bar = rectangle((-180, -28), (180, 28))
    curves = [OutlinedShape.of(filled(own)).curve(0) for own in (1.1 * np.array(arrow, np.float64), bar)]
    for match in matched_outlines(*curves):
        assert (np.diff(match.map.places) > 0.0).all()
        assert (np.diff(match.map.images) > 0.0).all()


@pytest.mark.usefixtures("coarse")
def test_an_s_unrolls_to_become_its_mirror_image():
    """Halfway, it is straight; as long and as wide as ever."""
    s = stroke(*S_BOWS)
    length = sum(np.radians(angle) * 0.5 for angle in (240.0, 235.0))
    straight = rectangle((-0.12, -0.5 * length), (0.12, 0.5 * length))
    for own in halfway(s, mirrored(s)):
        assert overlap(own, filled(straight + own.center)) > 0.9


@pytest.mark.usefixtures("coarse")
def test_a_stroke_unrolls_in_the_same_way_back():
    """Most of a Z turns by more than half of a circle to become an S."""
    top = np.stack([np.linspace(-0.8, 0.6, 40), np.ones(40)], axis=1), arc((0.6, 0.8), 0.2, 90, -50)
    s, z = stroke(*S_BOWS), stroke(*top, *(-piece[::-1] for piece in top[::-1]))
    ((_, (there, _)),), ((_, (_, back)),) = moved(s, z, 0.3), moved(z, s, 0.7)
    assert overlap(there, back) > 0.9


@pytest.mark.usefixtures("coarse")
def test_a_spiral_unrolls_to_a_straight_line():
    """Halfway, every piece has turned by half of its angle, and the middle of a spiral by more than a full turn."""
    angles = np.linspace(np.pi, 6.0 * np.pi, 200)
    coils = 0.06 * (angles * np.stack([np.cos(angles), np.sin(angles)])).T
    steps = np.diff(coils, axis=0)
    lengths, turns = np.linalg.norm(steps, axis=1), np.unwrap(np.arctan2(steps[:, 1], steps[:, 0]))
    end = np.arange(0.0, lengths.sum(), 0.05)
    bar = np.stack([end, 0.0 * end], axis=1)

    def line(share):
        pieces = lengths[:, None] * np.stack([np.cos(share * turns), np.sin(share * turns)], axis=1)
        return np.concatenate([np.zeros((1, 2)), np.cumsum(pieces, axis=0)])

    expected = stroke(line(0.5))
    for own in halfway(stroke(coils), stroke(bar)):
        best = max(
            overlap(own, filled(rotated(own_ring - expected.center, angle) + own.center))
            for own_ring in boundary_rings(expected)
            for angle in np.radians(np.arange(0.0, 360.0, 3.0))
        )
        assert best > 0.8


@pytest.mark.usefixtures("coarse")
def test_a_stroke_does_not_unroll_into_its_neighbors():
    neighbor = rectangle((-0.5, 1.3), (0.5, 1.6))
    one = filled(*boundary_rings(stroke(*S_BOWS)), neighbor)
    for own in halfway(one, mirrored(one)):
        assert np.ptp(own.bounds, axis=0)[1] == pytest.approx(np.ptp(one.bounds, axis=0)[1], rel=0.1)


def checkered(pitch):
    """Five unit squares; at a pitch of 1 they touch at their corners."""
    corners = pitch * np.array([(0, 0), (2, 0), (1, 1), (0, 2), (2, 2)], dtype=np.float64)
    return filled(*(rectangle(corner, corner + 1.0) for corner in corners))


def test_regions_that_touch_at_corners_come_apart():
    for time, shapes in moved(checkered(1.0), checkered(1.5), *TIMES):
        for own in shapes:
            assert [ring_area(ring) for ring in boundary_rings(own)] == pytest.approx([1.0] * 5, rel=0.03)
            assert overlap(own, checkered(1.0 + 0.5 * time)) > 0.97


def clasp(gap):
    """A ring that is open below by a gap; without one, its tips touch."""
    half = [(0.5 * gap, -1.0), (1, -1.5), (2, 0), (0, 2)], [(0, 1), (1, 0), (1, -0.5)]
    (outer, inner), sign = (np.array(own) for own in half), (-1.0, 1.0)
    return filled(np.concatenate([outer, sign * outer[2::-1], sign * inner[:0:-1], inner]))


def test_tips_that_touch_come_apart():
    for own in halfway(clasp(0.0), clasp(0.5)):
        assert overlap(own, clasp(0.25)) > 0.98
        tips = own.starts[np.abs(own.starts[:, 1] + 1.0) < 0.2, 0]
        assert (tips[tips < 0].max(), tips[tips > 0].min()) == pytest.approx((-0.125, 0.125), abs=0.01)


@pytest.mark.filterwarnings("error")
def test_noisy_outlines_are_matched():
    around = np.linspace(0.0, 2.0 * np.pi, 1000, endpoint=False)
    radii = 0.8 + 0.15 * np.sin(3 * around) + np.random.default_rng(0).normal(0.0, 0.02, len(around))
    noisy = filled(radii[:, None] * np.stack([np.cos(around), np.sin(around)], axis=1))
    assert overlap(*halfway(noisy, filled(HEART))) > 0.9


@pytest.mark.parametrize(("first", "second", "turn"), [(0.0, 0.0, 0.0), (0.0, 2.0, 2.0), (1.0, -0.8, -1.8)])
def test_unsymmetric_shapes_are_turned_where_only_that_matches(first, second, turn):
    hook = np.array([[0, 0], [2, 0], [2, 0.5], [0.4, 0.5], [0.4, 3], [0, 3]])
    turned = [rotated(hook, angle) for angle in (first, second)]
    one, other = (OutlinedShape.of(filled(own)).curve(0) for own in turned)
    found = matched_outlines(one, other)[0]
    assert found.turn == pytest.approx(turn, abs=0.02)
    assert other.curve.at(found.map(one.curve.nearest(turned[0])[0])) == pytest.approx(turned[1], abs=0.02)


def test_a_swapped_match_turns_the_other_way():
    shapes = [OutlinedShape.of(filled(rotated(BRACKET, angle), rotated(ROUND, angle))) for angle in (0.0, 2.0)]
    for match in (matched_shapes(*shapes)[0].swapped(), matched_shapes(*shapes[::-1])[0]):
        around, hole = match.pairs
        assert around.turn == pytest.approx(-2.0, abs=0.02)
        assert hole.turn == 0.0


@pytest.mark.parametrize("shape", [star(4, 0.5), star(6, 0.8), rectangle((-1, -1), (1, 1))])
def test_symmetric_shapes_turn_if_they_are_alike_then(shape):
    """They would match about a vertical axis as they stand, too, but distorted."""
    period = 2.0 * np.pi / (len(shape) // 2 if len(shape) > 4 else 4)
    for own in halfway(filled(shape), filled(rotated(shape, 0.5 * period))):
        expected = (filled(rotated(shape, sign * 0.25 * period)) for sign in (-1, 1))
        assert max(overlap(own, each) for each in expected) > 0.985


def test_equal_regions_do_not_turn_because_of_their_neighbors():
    """A square looks the same from four sides, and the other square is near only one of them."""
    one = filled(rectangle((0, 0), (1, 1)), rectangle((1.05, 1.05), (2.05, 2.05)))
    other = filled(rectangle((-1, -1), (0, 0)), rectangle((2, 2), (3, 3)))
    match = matched_shapes(OutlinedShape.of(one), OutlinedShape.of(other))[0]
    assert [pair.turn for pair in match.pairs] == [0.0, 0.0]


def test_pieces_turn_where_they_are():
    """Two of three pieces turn upside down; the row that they are part of does not, and the third one unrolls."""
    bracket, straight = 0.6 * (BRACKET - filled(BRACKET).center), np.linspace((-1.2, -0.5), (1.2, -0.5), 40)
    row, turned = (
        filled(piece - (2, 0), *boundary_rings(stroke(*line)), np.add(piece, (2, 0)))
        for piece, line in ((bracket, S_BOWS), (-bracket, [straight]))
    )
    for own in halfway(row, turned):
        pieces = sorted(map(filled, boundary_rings(own)), key=lambda piece: piece.center[0])
        for piece, place in ((pieces[0], -2.0), (pieces[2], 2.0)):
            assert piece.center == pytest.approx((place, 0.0), abs=0.15)
            assert piece.area == pytest.approx(filled(bracket).area, rel=0.02)


@pytest.mark.parametrize(
    "others",
    [
        (ellipse(radii=(1.2, 1.2)), ellipse(radii=(1.05, 1.05))),
        # Less than a hundredth of the area would overlap.
        (
            ellipse(radii=(1.6, 1.6)),
            ellipse(radii=(1.4, 1.4)),
            *(ellipse((x, 0.35), (0.15, 0.15)) for x in (-0.25, 0.25)),
        ),
    ],
)
def test_a_piece_that_would_turn_into_another_one_bends_instead(others):
    """The mouth of a face would turn upside down, and its ends would sweep across the ring around it, or an eye."""
    smile = stroke(arc((0, 0.6), 1.2, 225, 315))
    frown = stroke(arc((0, -1.4), 1.2, 45, 135)[::-1])
    faces = (filled(*others, *boundary_rings(mouth)) for mouth in (smile, frown))
    for _, shapes in moved(*faces, *TIMES):
        for own in shapes:
            mouth = min(boundary_rings(own), key=lambda ring: abs(ring_area(ring) - smile.area))
            assert np.ptp(mouth[:, 0]) > 1.6
            assert self_overlap(own, 300) < 0.001


def test_frames_have_the_area_between_and_nothing_left_to_transport():
    shapes = [FlatShape((star(),)), FlatShape((rectangle((-1, -1), (1, 1)),))]
    made = [step.payload for step in flat_morph(shapes, ["a", "b"], path_blends(2, 4), FlatSettings(resolution=128))]
    frames = [frame for frame in made if frame is not None and frame.outline is not None]
    for frame in frames:
        assert frame.record["motion"] == {"kind": "guided", "reason": "OUTLINES"}
        assert "iterations" not in frame.record
        assert frame.outline.area == pytest.approx(frame.record["area_wanted"], rel=1e-3)
        assert (len(frame.outline.regions), frame.outline.holes) == (1, 0)


def test_traced_outlines_with_many_corners_are_matched():
    rough = ellipse(corners=900) * (1.0 + 0.01 * np.random.default_rng(0).random((900, 1)))
    one, other = halfway(filled(rough), filled(star()))
    assert overlap(one, other) > 0.97
    assert sum(map(ring_area, boundary_rings(one))) == pytest.approx(one.area)
