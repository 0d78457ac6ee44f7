# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Guides on symmetric shapes count on both sides, and tell which way the shapes face."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.registrations.carriers import carrier_of
from convwass_addon.applications.registrations.mirrored_guides import MirroredGuides, agreeing_sides
from convwass_addon.geometry.deformation.upright_turns import rotation_about_z
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.progress import UNINTERRUPTED
from tests.grids import figure, sheet
from tests.shapes import ball, box, joined

FIGURE, MIRROR = figure(10)
HAND, HEAD, FOOT = (
    int(np.argmax(FIGURE.vertices @ np.array(way))) for way in ((0.9, 0.1, 0.35), (0.0, 0.15, 1.0), (0.45, -0.1, -0.9))
)


def carried(mesh):
    return carrier_of(mesh, "shape", 1000, UNINTERRUPTED)


def turned(degrees):
    return carried(TriangleMesh(FIGURE.vertices @ rotation_about_z(np.radians(degrees)).T, FIGURE.faces))


def guides(one, other, *pairs):
    return MirroredGuides.of(one, other, np.array(pairs))


@pytest.mark.parametrize("degrees", [0.0, 90.0, -60.0, 180.0])
def test_one_hand_tells_where_the_other_one_is_and_which_way_a_figure_faces(degrees):
    found = guides(turned(0.0), turned(degrees), (HAND, HAND))
    np.testing.assert_array_equal(found.pairs, [(HAND, HAND), (MIRROR[HAND], MIRROR[HAND])])
    expected = rotation_about_z(np.radians(degrees))
    np.testing.assert_allclose(np.eye(3) if found.turn is None else found.turn, expected, atol=1e-9)
    assert found.are_askew == (degrees in (90.0, -60.0))


@pytest.mark.parametrize("degrees", [90.0, -60.0])
def test_both_hands_tell_as_much_as_one(degrees):
    given = [(HAND, HAND), (MIRROR[HAND], MIRROR[HAND])]
    found = guides(turned(0.0), turned(degrees), *given)
    np.testing.assert_array_equal(found.pairs, given)
    np.testing.assert_allclose(found.turn, rotation_about_z(np.radians(degrees)), atol=1e-9)
    assert found.are_askew


def test_a_hand_on_the_other_hand_turns_a_figure_around():
    found = guides(turned(0.0), turned(0.0), (HAND, MIRROR[HAND]))
    np.testing.assert_allclose(found.turn, rotation_about_z(np.pi), atol=1e-9)
    assert not found.are_askew


def test_guides_that_contradict_each_other_leave_doubt_about_the_turn():
    """A hand tells one side, a foot the other one."""
    found = guides(turned(0.0), turned(90.0), (HAND, HAND), (FOOT, MIRROR[FOOT]))
    assert len(found.pairs) == 4
    assert not found.are_askew


def test_guides_in_the_plane_tell_nothing():
    found = guides(turned(0.0), turned(90.0), (HEAD, HEAD))
    np.testing.assert_array_equal(found.pairs, [(HEAD, HEAD)])
    assert found.turn is None
    assert not found.are_askew


def test_where_there_is_a_guide_no_image_is_added():
    """The second hand goes to a foot, as the user wants it."""
    given = [(HAND, HAND), (MIRROR[HAND], FOOT)]
    np.testing.assert_array_equal(guides(turned(0.0), turned(0.0), *given).pairs, given)


def test_images_beside_a_shape_are_not_added():
    """A figure with a stick in one hand is still nearly symmetric."""
    stick = joined(FIGURE, box((0.1, 0.1, 1.0), (1.6, 0.1, 1.0)))
    tip = len(FIGURE.vertices) + int(stick.vertices[len(FIGURE.vertices) :, 2].argmax())
    holding = carried(stick)
    given = [(HAND, HAND), (tip, tip)]
    *kept, image = guides(holding, holding, *given).pairs
    np.testing.assert_array_equal(kept, given)
    np.testing.assert_allclose(holding.mesh.vertices[image[0]], FIGURE.vertices[MIRROR[HAND]], atol=0.2)


@pytest.mark.parametrize("degrees", [0.0, 90.0])
def test_of_several_planes_the_one_of_the_other_shape_counts(degrees):
    """A plank has two planes."""
    plank = carried(box((2.0, 0.7, 4.0)))
    corner = int(np.argmax(plank.mesh.vertices @ (1.0, 1.0, 1.0)))
    facing = turned(degrees)
    across = facing.mesh.vertices[HAND, :2]
    found = guides(plank, facing, (corner, HAND))
    ((_, image),) = (places for places in found.pairs.tolist() if places[0] != corner)
    assert image == MIRROR[HAND]
    shift = plank.mesh.vertices[found.pairs[1, 0]] - plank.mesh.vertices[corner]
    assert np.flatnonzero(np.abs(shift) > 1e-6).tolist() == [int(np.abs(across).argmax())]
    assert found.turn is None


def test_shapes_that_look_alike_from_all_sides_have_no_images():
    sphere = carried(ball())
    found = guides(turned(0.0), sphere, (HAND, 5))
    np.testing.assert_array_equal(found.pairs, [(HAND, 5)])


def test_flat_shapes_face_no_way():
    first, second = carried(sheet(31, 11, (3.0, 1.0))), carried(sheet(11, 31, (1.0, 3.0)))
    found = guides(first, second, (0, 0))
    assert found.pairs.tolist() == [[0, 0]]
    assert found.turn is None


def test_without_guides_there_are_none():
    nothing = np.empty((0, 2), np.int64)
    assert MirroredGuides.of(turned(0.0), turned(90.0), nothing).pairs.shape == (0, 2)


@pytest.mark.parametrize(
    ("pair", "agree"),
    [((HAND, HAND), True), ((HEAD, HEAD), True), ((HAND, MIRROR[HAND]), False), ((HEAD, HAND), False)],
    ids=["hands", "heads", "left and right", "head and hand"],
)
def test_sides_are_kept_unless_guides_contradict_them(pair, agree):
    one, other = turned(0.0), turned(0.0)
    assert (agreeing_sides(one, other, np.array([(FOOT, FOOT), pair])) is not None) == agree


def test_shapes_without_a_common_plane_have_no_sides():
    assert agreeing_sides(turned(0.0), turned(90.0), np.array([(HAND, HAND)])) is None
