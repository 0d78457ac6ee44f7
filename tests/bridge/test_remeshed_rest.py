# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""New meshes that get shape keys instead of the first shape's own."""

from __future__ import annotations

import bpy
import numpy as np
import pytest

from convwass_addon.applications.one_mesh.key_paths import KeyPath
from convwass_addon.bridge.color_attributes import read_colors
from convwass_addon.bridge.objects import triangle_mesh
from convwass_addon.bridge.one_mesh.remeshed_rest import remeshed_shape
from convwass_addon.bridge.one_mesh.rest_mesh import armature_last
from convwass_addon.bridge.one_mesh.shape_keys import object_with_keys
from convwass_addon.bridge.uv_maps import read_uvs
from convwass_addon.bridge.vertex_groups import read_group
from convwass_addon.errors import InputError
from convwass_addon.geometry.meshes.closest_points import ClosestPointFinder
from convwass_addon.geometry.meshes.edges import topology
from tests.rigs import bend_by_two_bones
from tests.scene import select_only, world

pytestmark = pytest.mark.usefixtures("empty_scene")

CELLS = 32


@pytest.fixture
def capsule():
    """A ball of radius 1 at z = 3, whose lower half has another material."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, location=(0.0, 0.0, 3.0))
    obj = bpy.context.object
    for name in ("Top", "Bottom"):
        obj.data.materials.append(bpy.data.materials.new(name))
    for polygon in obj.data.polygons:
        polygon.material_index = int(polygon.center.z < 0.0)
    return obj


@pytest.mark.parametrize("kind", ["EVEN", "ADAPTIVE", "QUADS"])
def test_a_new_mesh_lies_on_the_shape_and_has_its_materials(capsule, kind, inventory):
    before = inventory()
    found = remeshed_shape(capsule, bpy.context.evaluated_depsgraph_get(), kind, CELLS)
    mesh = found.rest.mesh
    assert topology(found.shape).closed
    np.testing.assert_allclose(np.linalg.norm(found.shape.vertices - [0, 0, 3], axis=1), 1.0, atol=0.01)
    assert found.shape.volume == pytest.approx(4.0 / 3.0 * np.pi, rel=0.02)
    written = np.array([vertex.co for vertex in mesh.vertices])
    np.testing.assert_allclose(written, found.shape.vertices, atol=1e-4)
    for polygon in mesh.polygons:
        if abs(polygon.center.z - 3.0) > 0.1:
            assert mesh.materials[polygon.material_index].name == ("Bottom" if polygon.center.z < 3.0 else "Top")
    sides = {len(polygon.vertices) for polygon in mesh.polygons}
    assert max(sides) == (4 if kind == "QUADS" else 3)
    bpy.data.meshes.remove(mesh)
    assert inventory() == before


@pytest.mark.parametrize("kind", ["ADAPTIVE", "QUADS"])
def test_a_new_mesh_has_uvs_weights_and_colors_of_the_old_one(capsule, kind):
    """They are linear in space, or longitude and latitude; no face extends from one end of the texture to the other."""
    heights = np.array([vertex.co.z for vertex in capsule.data.vertices])
    group = capsule.vertex_groups.new(name="High")
    for index, height in enumerate(heights):
        group.add([index], 0.5 + 0.5 * height, "REPLACE")
    color = capsule.data.color_attributes.new("Tint", "FLOAT_COLOR", "POINT")
    color.data.foreach_set("color", np.stack([heights**0, heights, 0 * heights, heights**0], axis=1).ravel())
    capsule.data.uv_layers.new(name="Other")
    mesh = remeshed_shape(capsule, bpy.context.evaluated_depsgraph_get(), kind, CELLS).rest.mesh
    assert [layer.name for layer in mesh.uv_layers] == ["UVMap", "Other"]
    assert mesh.uv_layers["UVMap"].active_render
    obj = bpy.data.objects.new("New", mesh)
    points = np.array([vertex.co for vertex in mesh.vertices]) - [0.0, 0.0, 3.0]
    np.testing.assert_allclose(read_group(obj, "High"), 0.5 + 0.5 * points[:, 2], atol=0.01)
    np.testing.assert_allclose(read_colors(obj, "Tint")[:, 1], points[:, 2], atol=0.01)
    corners = np.array([loop.vertex_index for loop in mesh.loops])
    uvs = read_uvs(obj, "UVMap")
    latitude = np.arcsin(np.clip(points[corners, 2], -1.0, 1.0)) / np.pi + 0.5
    np.testing.assert_allclose(uvs[:, 1], latitude, atol=0.03)
    longitude = np.arctan2(points[corners, 1], points[corners, 0]) / (2.0 * np.pi) + 0.5
    turned = uvs[:, 0] - longitude
    away = np.hypot(*points[corners, :2].T) > 0.3
    offset = np.angle(np.exp(2j * np.pi * turned[away]).sum()) / (2.0 * np.pi)
    error = np.abs((turned[away] - offset + 0.5) % 1.0 - 0.5)
    # Corners beyond the seam stay at its border.
    assert np.quantile(error, 0.95) < 0.005 and error.max() < 0.06
    spans = [np.ptp(uvs[list(own.loop_indices), 0]) for own in mesh.polygons if abs(own.center.z - 3.0) < 0.9]
    assert max(spans) < 0.1


def test_a_new_mesh_keeps_the_armature(rigged_bar):
    """It shows the pose that it was made in, and the rest pose when the armature returns to it."""
    bar, rig = rigged_bar
    with armature_last(bar):
        found = remeshed_shape(bar, bpy.context.evaluated_depsgraph_get(), "EVEN", CELLS)
    up = found.shape.vertices + np.array([0.0, 0.0, 0.5])
    path = KeyPath("Up", (1.0,), found.rest.key_coordinates(up[None]), 0.9, 0.0, 0.0, 0.0, 0)
    obj = object_with_keys(bar, found.rest.mesh, [path], bpy.context.scene, found.rest.modifiers)
    assert [modifier.name for modifier in obj.modifiers] == ["Rig"]
    np.testing.assert_allclose(world(obj), found.shape.vertices, atol=1e-4)
    obj["Up"] = 1.0
    obj.update_tag()
    np.testing.assert_allclose(world(obj), up, atol=1e-4)
    obj["Up"] = 0.0
    rig.pose.bones["Upper"].rotation_euler = (0.0, 0.0, 0.0)
    obj.update_tag()
    bpy.context.view_layer.update()
    straight = triangle_mesh(bar, bpy.context.evaluated_depsgraph_get())
    distances = ClosestPointFinder(straight.vertices[straight.faces]).find(world(obj)).distances
    assert np.quantile(distances, 0.95) < 0.02 and distances.max() < 0.1


@pytest.fixture
def rigged_bar():
    """A bar along X with smooth weights on two bones, bent by 40 degrees; it stands turned in the scene."""
    bpy.ops.mesh.primitive_cube_add(size=2.0)
    bar = bpy.context.object
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.subdivide(number_cuts=9)
    bpy.ops.object.mode_set(mode="OBJECT")
    bar.scale, bar.rotation_euler, bar.location = (2.0, 0.5, 0.5), (0.1, 0.2, 0.3), (0.5, 0.2, 0.1)
    rig = bend_by_two_bones(bar, 2)
    bone = rig.pose.bones["Upper"]
    bone.rotation_mode, bone.rotation_euler = "XYZ", (0.0, 0.0, 0.7)
    bpy.context.view_layer.update()
    return bar, rig


def test_a_plane_cannot_be_remeshed(inventory):
    bpy.ops.mesh.primitive_plane_add()
    before = inventory()
    with pytest.raises(InputError, match="encloses no volume"):
        remeshed_shape(bpy.context.object, bpy.context.evaluated_depsgraph_get(), "EVEN", CELLS)
    assert inventory() == before


def test_shape_keys_that_a_new_mesh_lacks_are_mentioned(capsule):
    capsule.shape_key_add(name="Basis")
    capsule.shape_key_add(name="Smile")
    (notice,) = remeshed_shape(capsule, bpy.context.evaluated_depsgraph_get(), "EVEN", CELLS).rest.notices
    assert str(notice) == "The new mesh has the current form of Sphere, without its shape keys."


@pytest.mark.parametrize("thin", [False, True])
def test_thin_parts_that_a_new_mesh_lacks_are_mentioned(capsule, thin):
    """But not what is inside it, such as the other end of a rod."""
    radius = 0.01 if thin else 0.2
    bpy.ops.mesh.primitive_cylinder_add(radius=radius, depth=1.0, location=(1.2, 0, 3), rotation=(0, np.pi / 2, 0))
    select_only(bpy.context.object, capsule)
    bpy.context.view_layer.objects.active = capsule
    bpy.ops.object.join()
    notices = remeshed_shape(capsule, bpy.context.evaluated_depsgraph_get(), "EVEN", CELLS).rest.notices
    # The longest side is 2.7 units long, and the rod reaches 0.7 beyond the ball.
    assert list(map(str, notices)) == (
        ["The new mesh lacks thin parts of Sphere that are up to 8 cells long; raise the resolution."] if thin else []
    )
