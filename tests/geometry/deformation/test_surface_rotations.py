# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from convwass_addon.geometry.deformation.surface_rotations import surface_rotations
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from tests.shapes import ball, square, torus


def test_a_rigid_rotation_is_found_everywhere():
    turn = Rotation.from_rotvec((0.4, -2.0, 0.7)).as_matrix()
    for shape in (torus(segments=(16, 8)), square(), ball(points=80)):
        found = surface_rotations(shape.vertices, 1.7 * shape.vertices @ turn.T + 3.0, shape.faces)
        np.testing.assert_allclose(found, np.broadcast_to(turn, found.shape), atol=1e-7)


def test_rotations_vary_between_parts():
    tube = torus(segments=(32, 12))
    angles = np.arctan2(tube.vertices[:, 1], tube.vertices[:, 0])
    # Rolled about its own center line: every cross-section rotates in its plane by the same angle.
    line = np.stack([np.cos(angles), np.sin(angles), np.zeros_like(angles)], axis=1)
    axes = np.stack([-np.sin(angles), np.cos(angles), np.zeros_like(angles)], axis=1)
    rolls = Rotation.from_rotvec(0.5 * axes)
    moved = line + rolls.apply(tube.vertices - line)
    off = Rotation.from_matrix(surface_rotations(tube.vertices, moved, tube.faces)) * rolls.inv()
    assert off.magnitude().max() < 0.1


def test_vertices_without_area_have_no_rotation():
    mesh = TriangleMesh.from_arrays([(0, 0, 0), (1, 0, 0), (2, 0, 0), (5, 5, 5)], [(0, 1, 2)])
    found = surface_rotations(mesh.vertices, mesh.vertices[:, [1, 2, 0]], mesh.faces)
    np.testing.assert_allclose(found, np.broadcast_to(np.eye(3), found.shape), atol=1e-12)
