# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.remeshing.angle_smoothing import with_wider_angles
from convwass_addon.geometry.remeshing.subdivision import with_short_edges
from convwass_addon.geometry.remeshing.triangle_angles import smallest_angles
from tests.shapes import ball, box


def shaken_box():
    """A cube of side 2 with vertices displaced within its faces and along its edges."""
    cube = with_short_edges(box((2.0, 2.0, 2.0)), 0.3, 10_000).mesh
    shifts = np.random.default_rng(1).uniform(-0.06, 0.06, cube.vertices.shape)
    on_wall = np.isclose(np.abs(cube.vertices), 1.0)
    return TriangleMesh(np.where(on_wall, cube.vertices, cube.vertices + shifts), cube.faces), on_wall


def test_angles_of_known_triangles():
    corners = np.array([[[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 0, 0], [2, 0, 0], [1, np.sqrt(3), 0]]], float)
    assert np.degrees(smallest_angles(corners)) == pytest.approx([45, 60])


def test_narrow_angles_of_a_cube_widen_and_its_edges_stay():
    cube, on_wall = shaken_box()
    wider = with_wider_angles(cube, 0.01)
    np.testing.assert_array_equal(wider.faces, cube.faces)
    # Vertices on faces, edges and corners are still on them.
    np.testing.assert_allclose(wider.vertices[on_wall], cube.vertices[on_wall], atol=1e-12)
    before, after = (np.degrees(smallest_angles(mesh.corners)) for mesh in (cube, wider))
    assert after.min() >= before.min()
    assert np.percentile(after, 2) > np.percentile(before, 2) + 4
    assert wider.volume == pytest.approx(8.0)


def test_the_distance_from_a_round_surface_is_limited():
    round_one = ball(points=2000)
    moved = with_wider_angles(round_one, 1e-3)
    assert np.abs(np.linalg.norm(moved.vertices, axis=1) - 1.0).max() < 2e-3
    angles = [smallest_angles(mesh.corners).min() for mesh in (round_one, moved)]
    assert angles[1] >= angles[0]


def test_the_scale_of_a_mesh_does_not_matter():
    cube, _ = shaken_box()
    # A power of two, so that everything scales exactly.
    scale = 2.0**14
    large = with_wider_angles(TriangleMesh(scale * cube.vertices, cube.faces), 0.01 * scale)
    np.testing.assert_array_equal(large.vertices, scale * with_wider_angles(cube, 0.01).vertices)
