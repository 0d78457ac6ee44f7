# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces vertex by vertex, whatever modifiers and modes do."""

from __future__ import annotations

import math

import bpy
import numpy as np
import pytest

from convwass_addon.bridge.surfaces import read_surface, surface_mesh
from convwass_addon.errors import InputError
from tests.bridge.test_objects import by_a_driver, by_keys

AREA = 4 * math.sqrt(3)
"""Of the octahedron."""


@pytest.fixture
def obj(make_object):
    obj = make_object("A")
    bpy.context.view_layer.objects.active = obj
    return obj


def nodes(obj, name, build):
    """Add a modifier whose nodes are made by `build(tree, geometry)`."""
    tree = bpy.data.node_groups.new(name, "GeometryNodeTree")
    for way in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=way, socket_type="NodeSocketGeometry")
    made = build(tree, tree.nodes.new("NodeGroupInput").outputs["Geometry"])
    tree.links.new(made, tree.nodes.new("NodeGroupOutput").inputs["Geometry"])
    obj.modifiers.new(name, "NODES").node_group = tree


def lift(tree, geometry):
    node = tree.nodes.new("GeometryNodeSetPosition")
    node.inputs["Offset"].default_value = (0, 0, 3)
    tree.links.new(geometry, node.inputs["Geometry"])
    return node.outputs["Geometry"]


def subdivide(tree, geometry):
    node = tree.nodes.new("GeometryNodeSubdivideMesh")
    tree.links.new(geometry, node.inputs["Mesh"])
    return node.outputs["Mesh"]


def test_world_units(obj, depsgraph):
    obj.location, obj.scale, obj.rotation_euler = (5, 0, 0), (2, 2, 2), (0, 0, math.pi / 2)
    mesh = surface_mesh(obj, depsgraph)
    assert mesh.area == pytest.approx(4 * AREA, rel=1e-6)
    np.testing.assert_allclose(mesh.vertices[0], (5, 2, 0), atol=1e-6)


def test_mirrored_surfaces_are_oriented_outward(obj, depsgraph):
    obj.scale = (-1, 1, 1)
    assert surface_mesh(obj, depsgraph).volume == pytest.approx(4 / 3, rel=1e-6)


def test_a_flat_object_is_a_surface(make_object, depsgraph):
    obj = make_object("Quad", [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (9, 9, 9)], faces=[(0, 1, 2, 3)])
    obj.scale = (1, 1, 0)
    mesh = surface_mesh(obj, depsgraph)
    assert mesh.faces.shape == (2, 3)
    assert mesh.area == pytest.approx(1)
    # The loose vertex keeps its number.
    assert len(mesh.vertices) == 5
    assert mesh.faces.max() == 3


@pytest.mark.parametrize("factor", [0.0, 0.5, 1.0])
def test_current_values_of_shape_keys_count(obj, depsgraph, factor):
    for name in ("Basis", "Tall"):
        obj.shape_key_add(name=name, from_mix=False)
    tall = obj.data.shape_keys.key_blocks["Tall"]
    tall.data[4].co.z, tall.value = 3, factor
    assert surface_mesh(obj, depsgraph).vertices[4, 2] == pytest.approx(1 + 2 * factor)


def test_modifiers_that_move_vertices_are_heeded(obj, depsgraph):
    obj.modifiers.new("Stretch", "SIMPLE_DEFORM").deform_method = "STRETCH"
    reading = read_surface(obj, depsgraph)
    assert reading.ignored == ()
    evaluated = obj.evaluated_get(depsgraph).data
    np.testing.assert_allclose(reading.mesh.vertices, [vertex.co for vertex in evaluated.vertices])
    assert not np.allclose(reading.mesh.vertices, [vertex.co for vertex in obj.data.vertices])


def test_modifiers_that_make_vertices_are_ignored(obj, depsgraph, inventory):
    nodes(obj, "Lift", lift)
    obj.modifiers.new("Subdivision", "SUBSURF")
    nodes(obj, "Finer", subdivide)
    nodes(obj, "Lift again", lift)
    obj.modifiers.new("Array", "ARRAY").show_viewport = False
    before = inventory()
    reading = read_surface(obj, depsgraph)
    assert reading.ignored == ("Subdivision", "Finer")
    np.testing.assert_allclose(
        reading.mesh.vertices, [(*vertex.co[:2], vertex.co[2] + 6) for vertex in obj.data.vertices]
    )
    assert inventory() == before
    assert [modifier.show_viewport for modifier in obj.modifiers] == [True] * 4 + [False]


def test_an_armature_below_a_subdivision(obj, depsgraph, bare_scene):
    rig = bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig"))
    bare_scene.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    rig.data.edit_bones.new("Bone").tail = (0, 0, 1)
    bpy.ops.object.mode_set(mode="OBJECT")
    obj.vertex_groups.new(name="Bone").add(range(6), 1.0, "REPLACE")
    obj.modifiers.new("Armature", "ARMATURE").object = rig
    obj.modifiers.new("Subdivision", "SUBSURF")
    rig.pose.bones["Bone"].location.y = 2
    reading = read_surface(obj, depsgraph)
    assert reading.ignored == ("Subdivision",)
    np.testing.assert_allclose(reading.mesh.vertices[:, 2], [2, 2, 2, 2, 3, 1], atol=1e-6)


def test_masks_and_hidden_faces_do_not_matter(obj, depsgraph):
    obj.vertex_groups.new(name="Shown").add([0], 1.0, "REPLACE")
    obj.modifiers.new("Mask", "MASK").vertex_group = "Shown"
    for face in list(obj.data.polygons)[:3]:
        face.hide = True
    reading = read_surface(obj, depsgraph)
    assert reading.ignored == ("Mask",)
    assert reading.mesh.area == pytest.approx(AREA, rel=1e-6)


@pytest.mark.parametrize("with_modifiers", [False, True])
def test_edit_mode(obj, depsgraph, with_modifiers):
    import bmesh

    if with_modifiers:
        obj.modifiers.new("Subdivision", "SUBSURF")
    bpy.ops.object.mode_set(mode="EDIT")
    edited = bmesh.from_edit_mesh(obj.data)
    for vertex in edited.verts:
        vertex.co *= 3
    mesh = surface_mesh(obj, depsgraph)
    assert len(mesh.vertices) == 6
    assert mesh.area == pytest.approx(9 * AREA, rel=1e-6)
    assert obj.mode == "EDIT"


@pytest.mark.parametrize("with_modifiers", [False, True])
def test_objects_out_of_sight(obj, depsgraph, bare_scene, with_modifiers):
    if with_modifiers:
        nodes(obj, "Lift", lift)
        obj.modifiers.new("Subdivision", "SUBSURF")
    obj.hide_viewport = True
    bare_scene.collection.objects.unlink(obj)
    obj.location.x = 7
    mesh = surface_mesh(obj, depsgraph)
    np.testing.assert_allclose(mesh.vertices.mean(axis=0), (7, 0, 3 * with_modifiers), atol=1e-6)
    assert obj.hide_viewport
    assert obj.users_scene == ()


@pytest.mark.parametrize("hide", [by_keys, by_a_driver])
@pytest.mark.parametrize("with_subdivision", [False, True])
def test_objects_whose_visibility_changes_are_read_while_they_are_hidden(obj, bare_scene, hide, with_subdivision):
    """Blender keeps them in the scene as they were when they were shown last."""
    obj.hide_viewport = True
    hide(obj)
    bpy.context.view_layer.update()
    nodes(obj, "Lift", lift)
    if with_subdivision:
        obj.modifiers.new("Subdivision", "SUBSURF")
    obj.location.x = 7
    depsgraph = bpy.context.evaluated_depsgraph_get()
    reading = read_surface(obj, depsgraph)
    assert reading.ignored == ("Subdivision",) * with_subdivision
    np.testing.assert_allclose(reading.mesh.vertices.mean(axis=0), (7, 0, 3), atol=1e-6)
    assert obj.hide_viewport
    assert list(bare_scene.collection.objects) == [obj]
    bare_scene.frame_set(2)
    assert obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).hide_viewport


def test_parents_and_parts(obj, make_object, depsgraph):
    parent = make_object("Parent", [(0, 0, 0)])
    parent.location.z, obj.parent = 4, parent
    obj.modifiers.new("Subdivision", "SUBSURF")
    assert surface_mesh(obj, depsgraph).vertices[:, 2].mean() == pytest.approx(4)


@pytest.mark.parametrize(
    ("vertices", "faces", "words"),
    [
        ([], [], "Odd has no faces"),
        ([(0, 0, 0), (1, 0, 0)], [], "Odd has no faces"),
        ([(0, 0, 0), (1, 0, 0), (2, 0, 0)], [(0, 1, 2)], "The surface of Odd has no area"),
        ([(0, 0, 0), (1, 0, math.nan), (2, 1, 0)], [(0, 1, 2)], "Odd: 1 of 3 vertices have coordinates"),
    ],
)
def test_no_surface(make_object, depsgraph, vertices, faces, words):
    with pytest.raises(InputError, match=words):
        surface_mesh(make_object("Odd", vertices, faces=faces), depsgraph)


def test_a_place_that_is_no_number(obj, depsgraph):
    obj.location.x = math.nan
    with pytest.raises(InputError, match="A: its location, rotation or scale"):
        surface_mesh(obj, depsgraph)


def test_other_kinds_of_objects(bare_scene, depsgraph):
    curve = bpy.data.objects.new("Path", bpy.data.curves.new("Path", "CURVE"))
    bare_scene.collection.objects.link(curve)
    with pytest.raises(InputError, match="Path is not a mesh but of type curve"):
        surface_mesh(curve, depsgraph)
