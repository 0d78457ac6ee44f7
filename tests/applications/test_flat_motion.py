# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Motions of flat shapes: a rotated shape rotates, and letters of words move one by one."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.flat.flat_colors import carried_colors
from convwass_addon.applications.flat.flat_morph import flat_morph
from convwass_addon.applications.flat.flat_motion import chosen_flat_motion
from convwass_addon.applications.flat.flat_problem import pieces_of
from convwass_addon.applications.flat.flat_settings import FlatSettings
from convwass_addon.applications.flat.flat_shapes import FlatImage, FlatShape
from convwass_addon.applications.morphs.layouts import Blend, path_blends
from convwass_addon.applications.motions.motion import MovedShape
from convwass_addon.applications.outlines.sheets import Sheet
from convwass_addon.errors import InputError
from convwass_addon.geometry.plane.closed_curves import ClosedCurve
from convwass_addon.geometry.plane.coverage import coverage
from convwass_addon.geometry.plane.planar_fill import filled_boundary
from convwass_addon.geometry.plane.ring_nesting import boundary_rings
from convwass_addon.progress import UNINTERRUPTED, drained
from tests.applications.maps import coarse_maps, coarse_outlines
from tests.flat_shapes import ellipse, rectangle

# A hook without symmetry; its areas are known.
HOOK = np.array([[0, 0], [2, 0], [2, 0.5], [0.4, 0.5], [0.4, 3], [0, 3]], dtype=np.float64) - [0.6, 1.2]
TURN = np.radians(80.0)
TILT = 24.0
SHIFT = np.array([5.0, 1.0])
RED, BLUE = (1.0, 0.0, 0.0, 1.0), (0.0, 0.0, 1.0, 1.0)


@pytest.fixture(scope="module", autouse=True)
def coarse():
    with coarse_outlines():
        yield


def turned(points, angle, shift=(0.0, 0.0)):
    c, s = np.cos(angle), np.sin(angle)
    return np.asarray(points) @ np.array([[c, s], [-s, c]]) + np.asarray(shift)


def overlap(rings, other):
    """Intersection over union of two shapes, on fine cells."""
    low = np.concatenate([*rings, *other]).min(axis=0) - 0.05
    factor = 500 / float((np.concatenate([*rings, *other]).max(axis=0) + 0.05 - low).max())
    one, two = (
        coverage(filled_boundary(own, "non-zero").moved(-low * factor, factor), (500, 500)) for own in (rings, other)
    )
    return np.minimum(one, two).sum() / np.maximum(one, two).sum()


@pytest.fixture(scope="module")
def hooks():
    return [
        FlatShape((HOOK,), colors=np.array([RED])),
        FlatShape((turned(HOOK, TURN, SHIFT),), colors=np.array([BLUE])),
    ]


@pytest.fixture(scope="module")
def frames(hooks):
    settings = FlatSettings(resolution=96, motion="guided")
    with coarse_maps():
        made = [step.payload for step in flat_morph(hooks, ["down", "up"], path_blends(2, 3), settings)]
    return [frame for frame in made if frame is not None]


def test_a_turned_shape_turns_at_every_time(frames):
    assert [frame.outline is None for frame in frames] == [True, False, False, True]
    center = filled_boundary([HOOK], "non-zero").center
    for frame in frames[1:-1]:
        t = frame.blend.weights[1]
        expected = turned(HOOK - center, t * TURN) + (1 - t) * center + t * (turned(center, TURN) + SHIFT)
        # The position of a rotating shape on the way is a free choice: it moves as little as possible.
        away = filled_boundary([expected], "non-zero").center - filled_boundary(frame.outline.rings, "non-zero").center
        assert np.linalg.norm(away) < 0.02 * np.ptp(HOOK)
        assert overlap([ring + away for ring in frame.outline.rings], [expected]) > 0.95
        assert frame.record["motion"]["kind"] == "guided"
        assert frame.outline.area == pytest.approx(frame.record["area_wanted"], rel=1e-3)


def test_blends_of_moved_shapes_that_differ_much_have_the_area_between():
    around = np.linspace(0.0, 2.0 * np.pi, 100, endpoint=False)
    circle = np.stack([np.cos(around), np.sin(around)], axis=1)
    shapes = [FlatShape((circle, 0.7 * circle[::-1])), FlatShape((rectangle((-0.3, -1.3), (0.3, 1.3)),))]
    settings = FlatSettings(resolution=256, motion="warp")
    with coarse_maps():
        made = [step.payload for step in flat_morph(shapes, ["ring", "bar"], path_blends(2, 4), settings)]
    for frame in made:
        if frame is not None and frame.outline is not None:
            assert frame.outline.area == pytest.approx(frame.record["area_wanted"], rel=1e-3)


def test_origins_follow_the_rotation(frames, hooks):
    center = filled_boundary([HOOK], "non-zero").center
    inner = np.array([[1.0, 0.25], [0.2, 1.5], [0.2, 2.8]]) - [0.6, 1.2]
    frame = frames[1]
    t = frame.blend.weights[1]
    places = turned(inner - center, t * TURN) + (1 - t) * center + t * (turned(center, TURN) + SHIFT)
    found = frame.origins.at(places)
    assert found[0] == pytest.approx(inner, abs=0.15)
    assert found[1] == pytest.approx(turned(inner, TURN, SHIFT), abs=0.15)
    mixed = (1 - t) * np.array(RED) + t * np.array(BLUE)
    assert carried_colors(places, frame, hooks) == pytest.approx(np.tile(mixed, (3, 1)))


def direction(curve):
    """Return the angle of the longest axis of a closed curve in degrees, from 0 to 180."""
    points = curve.at(np.linspace(0.0, curve.length, 2000, endpoint=False))
    along = np.linalg.eigh(np.cov(points.T))[1][:, -1]
    return np.degrees(np.arctan2(along[1], along[0])) % 180.0


def chosen(shapes, **settings):
    names = [f"shape {index}" for index in range(len(shapes))]
    own = FlatSettings(resolution=128, **settings)
    pieces = pieces_of(shapes, names, own)
    blends = [Blend((0.5, 0.5))]
    return drained(chosen_flat_motion(pieces, names, blends, own, np.zeros((2, 2)), UNINTERRUPTED))


AROUND = np.linspace(0.0, 2.0 * np.pi, 96, endpoint=False)
# A bolt of lightning, pointed below, and a drop, pointed above.
BOLT = np.array([(-0.2, 1), (0.5, 1), (0.15, 0.25), (0.55, 0.25), (-0.35, -1), (-0.1, -0.1), (-0.5, -0.1)])
DROP = np.stack([0.6 * np.sin(AROUND) * np.sin(AROUND / 2) ** 1.5, np.cos(AROUND)], axis=1)
# A crescent, open to the right, and a heart, with its notch above.
ARC = np.linspace(0.5, 2.0 * np.pi - 0.5, 60)
CRESCENT = np.stack(
    [np.append(np.cos(ARC), 0.32 + 0.66 * np.cos(ARC[::-1])), np.append(np.sin(ARC), 0.74 * np.sin(ARC[::-1]))], axis=1
)
HEART = np.stack([np.sin(AROUND) ** 3, (13 * np.cos(AROUND) - 5 * np.cos(2 * AROUND) - 2 * np.cos(3 * AROUND)) / 16], 1)


@pytest.mark.parametrize(("first", "second"), [(BOLT, DROP), (CRESCENT, HEART)])
def test_flat_shapes_are_turned_only_if_nothing_else_maps(first, second):
    # After a turn, both pairs have a better score; the first one has a good one as they stand, the second one never.
    choice = chosen([FlatShape((first,)), FlatShape((second,))])
    assert choice.record["kind"] == "guided"
    assert choice.record.get("turned") is None


# Half of a w with straight strokes, and an m with round ones.
STRAIGHT = [(0, 0.08), (0.13, -0.23), (0.16, -0.23), (0.36, 0.23), (0.26, 0.23), (0.15, -0.04), (0.03, 0.23)]
STROKES = [(-0.33, 0.22), (-0.33, -0.23), (-0.24, -0.23), (-0.24, 0.1), (-0.18, 0.14), (-0.13, 0.15), (-0.08, 0.14)]
STROKES += [(-0.05, 0.08), (-0.04, -0.23), (0.04, -0.23), (0.04, 0.1), (0.1, 0.14), (0.14, 0.15), (0.2, 0.14)]
STROKES += [(0.23, 0.08), (0.24, -0.23), (0.33, -0.23), (0.32, 0.09), (0.3, 0.16), (0.26, 0.21), (0.2, 0.23)]
STROKES += [
    (0.14, 0.22),
    (0.08, 0.2),
    (0.03, 0.15),
    (-0.01, 0.2),
    (-0.07, 0.23),
    (-0.15, 0.22),
    (-0.24, 0.16),
    (-0.24, 0.22),
]


def test_letters_that_are_clearly_alike_upside_down_turn_around():
    w = np.array([*STRAIGHT, *((-x, y) for x, y in STRAIGHT[::-1] if x)])
    choice = chosen([FlatShape((w,)), FlatShape((np.array(STROKES),))])
    assert choice.record["turned"] == pytest.approx(180, abs=2)


@pytest.mark.parametrize("words", ["letters", "mass"])
def test_letters_of_words_move_one_by_one(words):
    word = FlatShape(tuple(HOOK + np.array([4.0 * index, 0.0]) for index in range(2)))
    other = FlatShape(tuple(turned(HOOK, np.radians(TILT)) + np.array([4.0 * index, 0.0]) for index in range(2)))
    choice = chosen([word, other], words=words)
    assert choice.record == {"kind": "guided", "reason": "OUTLINES", "turned": TILT}
    rest = direction(ClosedCurve(HOOK))
    for part in choice.motion.moved([0.5, 0.5]):
        for own in part:
            curves = [ClosedCurve(ring) for ring in boundary_rings(own.boundary)]
            assert len(curves) == (2 if words == "mass" else 1)
            assert [direction(curve) for curve in curves] == pytest.approx([rest + 0.5 * TILT] * len(curves), abs=2.0)


def test_the_letter_that_turns_most_is_on_record():
    shift = np.array([4.0, 0.0])
    pair = [FlatShape((HOOK, HOOK + shift)), FlatShape((HOOK, turned(HOOK, np.radians(TILT)) + shift))]
    assert chosen(pair, words="letters").record == {"kind": "guided", "reason": "OUTLINES", "turned": TILT}


def test_shapes_of_very_many_regions_are_transported():
    dots = [ellipse((3.0 * place, 0.0), corners=32) for place in range(33)]
    pair = [FlatShape(tuple(dots)), FlatShape(tuple(dots[:2]))]
    assert chosen(pair).record == {"kind": "transport", "reason": "REGIONS"}
    with pytest.raises(InputError, match="separate areas"):
        chosen(pair, motion="guided")


def test_shapes_that_would_crumple_are_transported():
    """Unless the user chose to guide them."""
    angles = np.linspace(0.25 * np.pi, 0.75 * np.pi, 40)
    around = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    waves = [
        ellipse(radii=(0.35, 0.35)),
        *(np.concatenate([(r + 0.2) * around, (r - 0.2) * around[::-1]]) for r in (1, 2)),
    ]
    bars = [rectangle((place, 0.0), (place + 0.7, 0.8 * (place + 1))) for place in range(3)]
    lines = [FlatShape(tuple(own)) for own in (waves, bars)]
    assert chosen(lines).record == {"kind": "transport", "reason": "DISTORTED"}
    assert chosen(lines, motion="guided").record["reason"] == "ASKED"


def test_parts_that_cannot_move_do_not_keep_others_from_moving():
    second = HOOK + np.array([5.0, 0.0])
    dots = tuple(ellipse((5.0 + 0.1 * place, 3.0), (0.04, 0.04), corners=32) for place in range(33))
    word = FlatShape((HOOK, second), letters=(0, 1))
    dotted = FlatShape((HOOK, second, *dots), letters=(0, 1, *([1] * 33)))
    choice = chosen([word, dotted], words="letters")
    assert choice.record["reason"] == "REGIONS"
    assert [own.motion is None for own in choice.motion.choices] == [False, True]


def test_a_motion_that_fails_does_not_lose_the_bake(monkeypatch):
    def failing(*_):
        raise ValueError("no triangles")

    monkeypatch.setattr("convwass_addon.applications.flat.flat_motion.outline_motion", failing)
    pair = [FlatShape((HOOK,)), FlatShape((turned(HOOK, 0.4),))]
    assert chosen(pair).record == {"kind": "transport", "reason": "FAILED", "failure": "no triangles"}
    with pytest.raises(ValueError, match="no triangles"):
        chosen(pair, motion="guided")


@pytest.mark.parametrize("motion", ["guided", "warp"])
def test_images_cannot_be_asked_to_move(motion):
    with pytest.raises(InputError, match="no outline"):
        chosen([FlatImage(np.ones((8, 8))), FlatShape((HOOK,))], motion=motion)
    assert chosen([FlatImage(np.ones((8, 8))), FlatShape((HOOK,))]).record["reason"] == "ASKED"


def test_a_sheet_carries_its_boundary_along():
    boundary = filled_boundary([ellipse((1, 2), (2, 1)), ellipse((1, 2), (1, 0.5))[::-1]], "non-zero")
    sheet = Sheet.of(boundary)
    assert sheet.mesh.area == pytest.approx(boundary.area, rel=1e-3)
    moved = turned(sheet.mesh.vertices[:, :2], 0.7, SHIFT)
    carried = sheet.moved(MovedShape(sheet.mesh, np.column_stack([moved, np.zeros(len(moved))])))
    assert carried.starts == pytest.approx(turned(sheet.boundary.starts, 0.7, SHIFT))
    assert carried.area == pytest.approx(boundary.area)
