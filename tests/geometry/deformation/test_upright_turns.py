# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
import numpy as np
import pytest

from convwass_addon.geometry.algebra.rotation_fields import rotation_matrices
from convwass_addon.geometry.deformation.upright_turns import upright_turn, upright_turn_of_points
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from tests.shapes import ball, joined

# A body with a head at one end.
ANIMAL = joined(ball(1.0, points=300), ball(0.8, (1.5, 0.0, 0.0), 300), ball(0.5, (2.6, 0.0, 0.9), 300))


def about_z(degrees):
    return rotation_matrices(np.radians([[0.0, 0.0, degrees]]))[0]


@pytest.mark.parametrize("degrees", [90.0, 180.0, -120.0])
def test_the_turn_of_a_moved_and_scaled_copy_is_found(degrees):
    turned = TriangleMesh(3.0 * ANIMAL.vertices @ about_z(degrees).T + np.array((5.0, -2.0, 1.0)), ANIMAL.faces)
    assert np.allclose(upright_turn(ANIMAL, turned), about_z(degrees), atol=1e-12)
    assert np.allclose(upright_turn(turned, ANIMAL), about_z(-degrees), atol=1e-12)


@pytest.mark.parametrize("degrees", [0.0, 10.0])
def test_shapes_that_face_nearly_the_same_way_need_no_turn(degrees):
    assert upright_turn(ANIMAL, TriangleMesh(ANIMAL.vertices @ about_z(degrees).T, ANIMAL.faces)) is None


def test_a_shape_that_looks_alike_from_all_sides_needs_no_turn():
    assert upright_turn(ANIMAL, ball(1.0, points=400)) is None


HANDS_AND_NOSE = np.array([(0.9, 0.1, 0.4), (-0.9, 0.0, 0.4), (0.0, 0.4, 0.9)])


@pytest.mark.parametrize("degrees", [90.0, 180.0, -120.0])
def test_corresponding_points_tell_the_turn(degrees):
    """Also where limbs are in another pose: the turn is rounded to 30 degrees."""
    points, turned = HANDS_AND_NOSE[:2], HANDS_AND_NOSE @ about_z(degrees + 8.0).T + np.array((0.0, 0.0, 0.1))
    assert np.allclose(upright_turn_of_points(points, turned[:2]), about_z(degrees), atol=1e-12)
    assert np.allclose(upright_turn_of_points(HANDS_AND_NOSE, turned), about_z(degrees), atol=1e-12)


def test_points_that_tell_no_turn():
    """One point, points that are nearly in place, points above each other, and points of a mirror image."""
    assert upright_turn_of_points(HANDS_AND_NOSE[:1], HANDS_AND_NOSE[1:2]) is None
    assert upright_turn_of_points(HANDS_AND_NOSE, HANDS_AND_NOSE + 0.05) is None
    above = HANDS_AND_NOSE * (0.0, 0.0, 1.0)
    assert upright_turn_of_points(above, above[::-1]) is None
    around = np.array([(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (-1.0, 0.0, 0.0), (0.0, -1.0, 0.0)])
    assert upright_turn_of_points(around, around * (-1.0, 1.0, 1.0)) is None
