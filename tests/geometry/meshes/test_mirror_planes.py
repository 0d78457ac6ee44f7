# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
import numpy as np
import pytest

from convwass_addon.geometry.deformation.upright_turns import rotation_about_z
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.meshes.mirror_planes import MirrorPlane, common_mirror_planes, mirror_planes
from tests.grids import figure
from tests.shapes import ball, box, joined, torus

FIGURE = figure(10)[0]


def turned(mesh, degrees, scale=1.0, offset=(0.0, 0.0, 0.0)):
    return TriangleMesh(scale * mesh.vertices @ rotation_about_z(np.radians(degrees)).T + offset, mesh.faces)


def test_a_plane_mirrors_points():
    plane = MirrorPlane(np.array([1.0, 0.0, 0.0]), np.array([1.0, 0.0, 0.0]))
    points = np.array([(3.0, 1.0, 2.0), (1.0, 5.0, 5.0)])
    np.testing.assert_array_equal(plane.heights(points), [2.0, 0.0])
    np.testing.assert_array_equal(plane.mirrored(points), [(-1.0, 1.0, 2.0), (1.0, 5.0, 5.0)])


@pytest.mark.parametrize("degrees", [0.0, 45.0, 90.0, -30.0])
def test_the_plane_of_two_figures_that_face_the_same_way_or_opposite_ways(degrees):
    """It turns with them, whatever their sizes and places."""
    one, other = turned(FIGURE, degrees), turned(FIGURE, degrees + 180.0, 3.0, (5.0, 1.0, 2.0))
    first, second = common_mirror_planes(one, other)
    across = rotation_about_z(np.radians(degrees))[:, 0]
    for plane, mesh in ((first, one), (second, other)):
        assert abs(plane.normal @ across) == pytest.approx(1.0)
        assert np.abs(plane.heights(mesh.vertices).max() + plane.heights(mesh.vertices).min()) < 0.02 * mesh.area**0.5
    np.testing.assert_array_equal(first.normal, second.normal)


def test_shapes_whose_planes_cross_have_no_common_one():
    assert common_mirror_planes(FIGURE, turned(FIGURE, 90.0)) is None


def test_shapes_without_a_plane_have_no_common_one():
    raised = joined(FIGURE, box((0.3, 0.3, 3.0), (1.0, 0.0, 1.5)))
    assert common_mirror_planes(FIGURE, raised) is None


@pytest.mark.parametrize("shape", [ball(), torus()])
def test_shapes_that_look_alike_from_all_sides_tell_nothing(shape):
    assert common_mirror_planes(FIGURE, shape) is None


def test_of_several_planes_the_one_that_the_other_shape_has_counts():
    plank = box((0.5, 2.0, 4.0))
    for degrees in (0.0, 90.0):
        plane, _ = common_mirror_planes(plank, turned(FIGURE, degrees))
        assert abs(plane.normal @ rotation_about_z(np.radians(degrees))[:, 0]) == pytest.approx(1.0)


@pytest.mark.parametrize("degrees", [0.0, 45.0, -97.5])
def test_a_figure_has_one_plane(degrees):
    (plane,) = mirror_planes(turned(FIGURE, degrees, 2.0, (3.0, 0.0, 1.0)))
    assert abs(plane.normal @ rotation_about_z(np.radians(degrees))[:, 0]) == pytest.approx(1.0)


def test_a_plank_has_two_planes_and_a_ball_none():
    first, second = mirror_planes(turned(box((0.5, 2.0, 4.0)), 30.0))
    assert first.normal @ second.normal == pytest.approx(0.0, abs=1e-9)
    assert mirror_planes(ball()) == []


def test_a_figure_that_is_not_clearly_symmetric_has_no_plane():
    """It is symmetric enough for a common plane."""
    holding = joined(FIGURE, box((0.3, 0.3, 1.2), (1.0, 0.0, 0.6)))
    assert mirror_planes(holding) == []
    assert common_mirror_planes(FIGURE, holding) is not None
