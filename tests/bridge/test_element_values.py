# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Values of all elements of a mesh, read at once, are those of the single elements."""

from __future__ import annotations

import bpy
import numpy as np
import pytest

from convwass_addon.bridge.element_values import (
    MeshTriangles,
    corner_vertices,
    triangle_corners,
    triangle_materials,
    triangle_polygons,
    vertex_positions,
)


def polygons(sides):
    """A mesh of faces with these numbers of sides, not all convex, in turns with two materials."""
    rng, points = np.random.default_rng(len(sides)), []
    for place, count in enumerate(sides):
        angles = np.arange(count) * 2.0 * np.pi / count
        radii = 1.0 - 0.9 * (rng.random(count) < 0.3)
        points += zip(radii * np.cos(angles) + 3 * place, radii * np.sin(angles), 0.1 * rng.random(count), strict=True)
    ends = np.cumsum(sides).tolist()
    mesh = bpy.data.meshes.new("Polygons")
    mesh.from_pydata(points, [], [range(end - count, end) for end, count in zip(ends, sides, strict=True)])
    for place, polygon in enumerate(mesh.polygons):
        polygon.material_index = place % 2
    mesh.update()
    return mesh


@pytest.mark.parametrize("is_edited", [False, True])
@pytest.mark.parametrize("sides", [(3, 3, 3), (4, 4, 4, 4, 4), (3, 4, 5, 3, 9, 12)])
def test_values_read_at_once_are_those_of_the_elements(sides, is_edited):
    mesh = polygons(sides)
    obj = bpy.data.objects.new("Polygons", mesh)
    bpy.context.scene.collection.objects.link(obj)
    bpy.context.view_layer.objects.active = obj
    if is_edited:
        bpy.ops.object.mode_set(mode="EDIT")
    triangles = MeshTriangles.of(mesh)
    mesh.calc_loop_triangles()
    slowly = list(mesh.loop_triangles)
    assert len(slowly) == sum(sides) - 2 * len(sides)
    np.testing.assert_array_equal(triangles.vertices, [one.vertices for one in slowly])
    np.testing.assert_array_equal(triangles.loops, [one.loops for one in slowly])
    np.testing.assert_array_equal(triangle_corners(mesh, "vertices"), triangles.vertices)
    np.testing.assert_array_equal(triangle_corners(mesh, "loops"), triangles.loops)
    np.testing.assert_array_equal(triangle_polygons(mesh), [one.polygon_index for one in slowly])
    np.testing.assert_array_equal(triangle_materials(mesh), [one.material_index for one in slowly])
    np.testing.assert_array_equal(corner_vertices(mesh), [one.vertex_index for one in mesh.loops])
    np.testing.assert_array_equal(vertex_positions(mesh), [one.co for one in mesh.vertices])


def test_faces_without_stored_materials_have_the_first_one(make_object):
    mesh = make_object("A").data
    assert "material_index" not in mesh.attributes
    assert set(triangle_materials(mesh)) == {0}
