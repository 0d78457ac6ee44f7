# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects of the scene as arrays, in every state in which a user may leave them."""

from __future__ import annotations

import math

import bpy
import numpy as np
import pytest
from mathutils import Euler, Matrix

from convwass_addon.bridge.objects import frozen_copy, transform_mesh, triangle_mesh, write_mesh
from convwass_addon.bridge.one_mesh.rest_mesh import rest_mesh
from convwass_addon.errors import InputError

VOLUME = 4.0 / 3.0


def test_octahedron_is_outward(octahedron):
    assert octahedron.volume == pytest.approx(VOLUME)


def test_world_space(make_object, depsgraph):
    obj = make_object("A")
    obj.location, obj.scale, obj.rotation_euler = (5, 0, 0), (2, 1, 1), (0, 0, math.pi / 2)
    mesh = triangle_mesh(obj, depsgraph)
    np.testing.assert_allclose(mesh.bounds, [[4, -2, -1], [6, 2, 1]], atol=1e-6)
    assert mesh.volume == pytest.approx(2 * VOLUME, rel=1e-6)


def test_modifiers_and_parents_count(make_object, depsgraph):
    obj, parent = make_object("A"), make_object("Parent")
    obj.parent, parent.location = parent, (0, 0, 3)
    array = obj.modifiers.new("Array", "ARRAY")
    array.count, array.use_relative_offset, array.use_constant_offset = 2, False, True
    array.constant_offset_displace = (4, 0, 0)
    np.testing.assert_allclose(triangle_mesh(obj, depsgraph).bounds, [[-1, -1, 2], [5, 1, 4]], atol=1e-6)


def test_polygons_become_triangles(make_object, depsgraph):
    obj = make_object("Quad", [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], faces=[(0, 1, 2, 3)])
    assert triangle_mesh(obj, depsgraph).faces.shape == (2, 3)


def test_mirrored_objects_are_oriented_outward(make_object, depsgraph):
    obj = make_object("A")
    obj.scale = (-2, 1, 1)
    assert triangle_mesh(obj, depsgraph).volume == pytest.approx(2 * VOLUME, rel=1e-6)
    obj.data = frozen_copy(obj, depsgraph)
    obj.scale = (1, 1, 1)
    assert triangle_mesh(obj, depsgraph).volume == pytest.approx(2 * VOLUME, rel=1e-6)


def hide_viewport(obj):
    obj.hide_viewport = True


def hide_with_eye(obj):
    obj.hide_set(True)


def hide_collection(obj):
    _move(obj).hide_viewport = True


def exclude_collection(obj):
    collection = _move(obj)
    bpy.context.view_layer.layer_collection.children[collection.name].exclude = True


def unlink(obj):
    bpy.context.scene.collection.objects.unlink(obj)


def _move(obj):
    collection = bpy.data.collections.new("Hidden")
    bpy.context.scene.collection.children.link(collection)
    collection.objects.link(obj)
    bpy.context.scene.collection.objects.unlink(obj)
    return collection


@pytest.mark.parametrize("hide", [hide_viewport, hide_with_eye, hide_collection, exclude_collection, unlink])
def test_hidden_objects_are_read_in_their_current_state(make_object, depsgraph, hide):
    obj = make_object("A")
    hide(obj)
    obj.location = (7, 0, 0)
    obj.modifiers.new("Subdivision", "SUBSURF").levels = 1
    homes = set(obj.users_collection)
    state = obj.hide_viewport, obj.hide_render, obj.visible_get()
    mesh = triangle_mesh(obj, depsgraph)
    assert mesh.bounds.mean(axis=0)[0] == pytest.approx(7)
    assert len(mesh.faces) > 8
    assert len(frozen_copy(obj, depsgraph).polygons) > 8
    assert set(obj.users_collection) == homes
    assert (obj.hide_viewport, obj.hide_render, obj.visible_get()) == state


def _property(obj):
    bpy.context.scene["shape"] = obj


def _constraint(obj):
    empty = bpy.data.objects.new("Follower", None)
    bpy.context.scene.collection.objects.link(empty)
    empty.constraints.new("COPY_LOCATION").target = obj


@pytest.mark.parametrize("refer", [_property, _constraint])
@pytest.mark.parametrize("hide", [hide_viewport, hide_collection, exclude_collection])
def test_hidden_objects_that_others_refer_to_are_read_with_their_modifiers(make_object, depsgraph, hide, refer):
    """Blender evaluates no more of them than a property or a constraint needs."""
    obj = make_object("A")
    obj.modifiers.new("Subdivision", "SUBSURF").levels = 1
    hide(obj)
    refer(obj)
    obj.location.x = 7.0
    bpy.context.view_layer.update()
    mesh = triangle_mesh(obj, bpy.context.evaluated_depsgraph_get())
    assert mesh.bounds.mean(axis=0)[0] == pytest.approx(7.0)
    assert len(mesh.faces) == 48


@pytest.mark.parametrize("carried", ["itself", "parent"])
@pytest.mark.parametrize("hide", [hide_viewport, hide_with_eye, hide_collection, exclude_collection, unlink])
def test_animated_objects_that_are_hidden_are_read_as_they_are_now(make_object, empty_scene, hide, carried):
    obj, other = make_object("A"), make_object("Other")
    moved = obj
    if carried == "parent":
        moved = obj.parent = make_object("Parent")
        hide(moved)
    key = (obj.shape_key_add(name="Basis"), obj.shape_key_add(name="Large"))[1]
    for point in key.data:
        point.co *= 2.0
    for frame, share in ((1, 0.0), (5, 1.0)):
        moved.location.x, key.value = 8.0 * share, share
        moved.keyframe_insert("location", frame=frame)
        key.keyframe_insert("value", frame=frame)
        other.keyframe_insert("location", frame=frame)
    bpy.context.scene.frame_set(1)
    hide(obj)
    bpy.context.view_layer.update()
    bpy.context.scene.frame_set(5)
    other.location.x = 3.0
    mesh = triangle_mesh(obj, bpy.context.evaluated_depsgraph_get())
    np.testing.assert_allclose(mesh.bounds, [[6.0, -2.0, -2.0], [10.0, 2.0, 2.0]], atol=1e-5)
    # What others have without keys is kept.
    assert other.location.x == 3.0


def by_keys(obj):
    obj.keyframe_insert("hide_viewport", frame=1)


def by_a_driver(obj):
    obj.driver_add("hide_viewport").driver.expression = "1"


@pytest.mark.parametrize("hide", [by_keys, by_a_driver])
def test_objects_whose_visibility_changes_are_read_while_they_are_hidden(make_object, hide):
    """Blender keeps them in the scene as they were when they were shown last."""
    obj = make_object("Cut")
    obj.hide_viewport = True
    hide(obj)
    bpy.context.view_layer.update()
    obj.modifiers.new("Subdivision", "SUBSURF").levels = 1
    obj.location.x = 5.0
    found = triangle_mesh(obj, bpy.context.evaluated_depsgraph_get())
    assert len(found.faces) == 48
    np.testing.assert_allclose(found.bounds.mean(axis=0), (5.0, 0.0, 0.0), atol=1e-6)
    assert obj.hide_viewport and not obj.users_collection[1:]
    bpy.context.scene.frame_set(2)
    assert obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).hide_viewport


def test_edit_mode_sees_unapplied_edits(make_object, depsgraph):
    import bmesh

    obj = make_object("A")
    bpy.context.view_layer.objects.active = obj
    bpy.ops.object.mode_set(mode="EDIT")
    edited = bmesh.from_edit_mesh(obj.data)
    for vertex in edited.verts:
        vertex.co.x *= 3
    assert triangle_mesh(obj, depsgraph).volume == pytest.approx(3 * VOLUME, rel=1e-6)
    assert obj.mode == "EDIT"


@pytest.mark.parametrize("read", [triangle_mesh, frozen_copy])
@pytest.mark.parametrize(
    ("vertices", "edges", "words"),
    [
        ([], [], "empty mesh"),
        ([(0, 0, 0), (1, 0, 0)], [(0, 1)], "thickness"),
        ([(0, 0, 0)], [], "points but no faces"),
    ],
)
def test_without_faces(make_object, depsgraph, inventory, read, vertices, edges, words):
    obj = make_object("Wire", vertices, edges)
    before = inventory()
    with pytest.raises(InputError, match=f"Wire .*{words}"):
        read(obj, depsgraph)
    assert inventory() == before


@pytest.mark.parametrize("read", [triangle_mesh, frozen_copy])
@pytest.mark.parametrize("scale", [(1, 0, 1), (0, 0, 0), (1, 1, 1e-9)])
def test_zero_scale(make_object, depsgraph, read, scale):
    obj = make_object("Flat")
    obj.scale = scale
    obj.rotation_euler = (0.3, 0.4, 0.5)
    with pytest.raises(InputError, match="Flat has a scale of zero"):
        read(obj, depsgraph)


@pytest.mark.parametrize("read", [triangle_mesh, frozen_copy])
def test_infinite_scale(make_object, depsgraph, read):
    """Blender stores the largest number instead."""
    obj = make_object("Long")
    obj.scale.x = math.inf
    with pytest.raises(InputError, match=r"Long has 3\.4e\+38 times as large a scale along one axis"):
        read(obj, depsgraph)


@pytest.mark.parametrize("read", [triangle_mesh, frozen_copy])
def test_instances_only(make_object, depsgraph, inventory, read):
    obj = make_object("Crowd")
    tree = bpy.data.node_groups.new("Instances", "GeometryNodeTree")
    for kind in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=kind, socket_type="NodeSocketGeometry")
    given, made, placed = map(tree.nodes.new, ("NodeGroupInput", "NodeGroupOutput", "GeometryNodeInstanceOnPoints"))
    for end in ("Points", "Instance"):
        tree.links.new(given.outputs[0], placed.inputs[end])
    tree.links.new(placed.outputs[0], made.inputs[0])
    obj.modifiers.new("Instances", "NODES").node_group = tree
    before = inventory()
    with pytest.raises(InputError, match=r"Crowd shows instances only .* Realize Instances"):
        read(obj, depsgraph)
    assert inventory() == before


def test_small_scale_is_fine(make_object, depsgraph):
    obj = make_object("Small")
    obj.scale = (1e-4, 1e-4, 1e-7)
    assert triangle_mesh(obj, depsgraph).volume == pytest.approx(1e-15 * VOLUME, rel=1e-5)


def test_coordinates_that_are_no_numbers(make_object, depsgraph):
    obj = make_object("Broken")
    obj.data.vertices[2].co.x = math.nan
    with pytest.raises(InputError, match="Broken: 1 of 6 vertices"):
        triangle_mesh(obj, depsgraph)


def test_location_that_is_no_number(make_object, depsgraph):
    obj = make_object("Lost")
    obj.location.x = math.nan
    with pytest.raises(InputError, match="Lost: its location"):
        triangle_mesh(obj, depsgraph)


@pytest.mark.parametrize("kind", ["CURVE", "FONT", "SURFACE", "META"])
def test_other_kinds_are_to_be_converted(bare_scene, depsgraph, kind):
    make = {
        "FONT": lambda: bpy.data.curves.new("Thing", "FONT"),
        "CURVE": lambda: bpy.data.curves.new("Thing", "CURVE"),
        "SURFACE": lambda: bpy.data.curves.new("Thing", "SURFACE"),
        "META": lambda: bpy.data.metaballs.new("Thing"),
    }[kind]
    obj = bpy.data.objects.new("Thing", make())
    bare_scene.collection.objects.link(obj)
    with pytest.raises(InputError, match=r"Thing is not a mesh .* Object > Convert > Mesh"):
        triangle_mesh(obj, depsgraph)


def test_kinds_without_a_surface_cannot_be_converted(bare_scene, depsgraph):
    obj = bpy.data.objects.new("Thing", bpy.data.armatures.new("Thing"))
    bare_scene.collection.objects.link(obj)
    with pytest.raises(InputError, match="Thing is not a mesh but of type armature, which cannot become one; choose"):
        triangle_mesh(obj, depsgraph)


def test_written_mesh_reads_back(make_object, depsgraph, octahedron):
    obj = make_object("A", [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], faces=[(0, 1, 2, 3)])
    write_mesh(obj.data, octahedron)
    back = triangle_mesh(obj, depsgraph)
    np.testing.assert_array_equal(back.vertices, octahedron.vertices)
    np.testing.assert_array_equal(back.faces, octahedron.faces)
    assert len(obj.data.edges) == 12
    assert all(polygon.use_smooth for polygon in obj.data.polygons)
    assert not obj.data.validate()


def test_frozen_copy_keeps_materials_and_polygons(make_object, depsgraph):
    obj = make_object("A", [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], faces=[(0, 1, 2, 3)])
    materials = [bpy.data.materials.new(name) for name in ("Red", "Green")]
    for material in materials:
        obj.data.materials.append(material)
    obj.data.polygons[0].material_index = 1
    obj.data.uv_layers.new(name="UV")
    obj.location = (0, 0, 2)
    copy = frozen_copy(obj, depsgraph)
    assert list(copy.materials) == materials
    assert copy.polygons[0].material_index == 1
    assert len(copy.polygons[0].vertices) == 4
    assert copy.uv_layers.keys() == ["UV"]
    assert {vertex.co.z for vertex in copy.vertices} == {2.0}
    assert copy.users == 0
    assert copy is not obj.data


def test_frozen_copy_has_the_material_of_the_object(make_object, depsgraph):
    obj = make_object("A")
    obj.data.materials.append(bpy.data.materials.new("Of the mesh"))
    material = bpy.data.materials.new("Of the object")
    obj.material_slots[0].link = "OBJECT"
    obj.material_slots[0].material = material
    assert list(frozen_copy(obj, depsgraph).materials) == [material]


@pytest.mark.parametrize("scale", [(1.0, 1.0, 1.0), (-2.0, 2.0, 2.0), (1.0, 2.0, -0.5), (-1.0, 2.0, -0.5)])
@pytest.mark.parametrize("keys", [False, True])
def test_custom_normals_are_those_of_the_object(make_object, depsgraph, scale, keys):
    """Normals turn with the inverse transposed matrix, and stay at their vertex and face."""
    obj = make_object("Gem")
    obj.data.shade_smooth()
    given = np.random.default_rng(3).normal(size=(len(obj.data.vertices), 3)) * 0.2
    given += [vertex.co for vertex in obj.data.vertices]
    obj.data.normals_split_custom_set_from_vertices((given / np.linalg.norm(given, axis=1, keepdims=True)).tolist())
    if keys:
        obj.shape_key_add(name="Basis")
    obj.matrix_world = Matrix.LocRotScale((1.0, 2.0, 3.0), Euler((0.3, 0.4, 0.5)), scale)
    bpy.context.view_layer.update()
    expected = {
        (polygon.index, obj.data.loops[loop].vertex_index): obj.data.corner_normals[loop].vector
        for polygon in obj.data.polygons
        for loop in polygon.loop_indices
    }
    mesh = rest_mesh(obj, depsgraph).mesh if keys else frozen_copy(obj, depsgraph)
    inverse = np.linalg.inv(np.array(obj.matrix_world)[:3, :3])
    for polygon in mesh.polygons:
        for loop in polygon.loop_indices:
            normal = np.array(expected[polygon.index, mesh.loops[loop].vertex_index]) @ inverse
            found = np.array(mesh.corner_normals[loop].vector)
            assert found @ normal / np.linalg.norm(normal) == pytest.approx(1.0, abs=1e-6)
    assert not any(edge.use_edge_sharp for edge in mesh.edges)


def test_a_mesh_with_custom_normals_is_flattened(make_object):
    mesh = make_object("Gem").data
    mesh.normals_split_custom_set_from_vertices([(0.0, 0.0, 1.0)] * len(mesh.vertices))
    transform_mesh(mesh, Matrix.Diagonal((2.0, 1.0, 0.0, 1.0)))
    assert [max(abs(vertex.co[axis]) for vertex in mesh.vertices) for axis in range(3)] == [2.0, 1.0, 0.0]
