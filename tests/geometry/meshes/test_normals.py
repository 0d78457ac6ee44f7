# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np

from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.meshes.normals import (
    area_normals,
    triangle_areas,
    triangle_normals,
    unit_vectors,
    vertex_normals,
)
from tests.shapes import ball, box

# A roof of two perpendicular triangles with areas 1 and 3, a triangle without area, and an unused vertex.
VERTICES = np.array([(0, 0, 0), (0, 2, 0), (1, 0, 0), (0, 0, 3), (0, 4, 0), (5, 5, 5)], dtype=float)
FACES = np.array([(0, 2, 1), (0, 1, 3), (0, 1, 4)])


def test_vectors_are_normalized():
    np.testing.assert_array_equal(unit_vectors(np.array([(3.0, 4.0), (0.0, 0.0)])), [(0.6, 0.8), (0, 0)])


def test_normals_of_triangles():
    np.testing.assert_array_equal(triangle_normals(VERTICES[FACES]), [(0, 0, 1), (1, 0, 0), (0, 0, 0)])


def test_areas_of_triangles():
    np.testing.assert_array_equal(triangle_areas(VERTICES[FACES]), [1, 3, 0])


def test_normals_of_vertices_are_weighted_by_area():
    thirds = area_normals(VERTICES, FACES)
    np.testing.assert_allclose(thirds[[0, 1]], [(1, 0, 1 / 3)] * 2)
    np.testing.assert_allclose(thirds[2:], [(0, 0, 1 / 3), (1, 0, 0), (0, 0, 0), (0, 0, 0)])
    np.testing.assert_allclose(vertex_normals(VERTICES, FACES)[[0, 5]], [(0.9**0.5, 0, 0.1**0.5), (0, 0, 0)])


def test_normals_of_closed_meshes_cancel_out():
    for mesh in (box((1, 2, 3)), ball()):
        np.testing.assert_allclose(area_normals(mesh.vertices, mesh.faces).sum(axis=0), 0.0, atol=1e-12)


def test_flipped_faces_flip_normals():
    mesh = ball()
    turned = TriangleMesh(mesh.vertices, mesh.flipped().faces)
    own, other = (vertex_normals(one.vertices, one.faces) for one in (mesh, turned))
    np.testing.assert_allclose(own, -other, atol=1e-12)
