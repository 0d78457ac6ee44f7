# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Instances of collections are read as renders show them."""

from __future__ import annotations

import bpy
import numpy as np
import pytest

from convwass_addon.bridge.element_values import element_values
from convwass_addon.bridge.joined_shapes import joined_shape, shown_live
from convwass_addon.bridge.nodes.node_math import joined, new_node
from convwass_addon.bridge.objects import triangle_mesh
from convwass_addon.bridge.sequence import frame_group
from convwass_addon.bridge.shape_sources import shape_source
from convwass_addon.errors import InputError
from convwass_addon.geometry.algebra.affine import transformed_points
from tests.scene import linked

OCTAHEDRON = 4 / 3


@pytest.fixture
def library():
    """An asset that is in no scene."""
    return bpy.data.collections.new("Asset")


@pytest.fixture
def shown(library):
    """An Empty that shows the asset."""
    return _instance("Shown", library)


def _instance(name, collection):
    empty = linked(name, None)
    empty.instance_type, empty.instance_collection = "COLLECTION", collection
    return empty


def _move(obj, collection):
    bpy.context.scene.collection.objects.unlink(obj)
    collection.objects.link(obj)
    return obj


def _joined(obj):
    """Provide the whole shape of an object."""
    bpy.context.view_layer.update()
    return joined_shape(shape_source(obj), bpy.context.evaluated_depsgraph_get())


def _volume(obj):
    with _joined(obj) as whole:
        return triangle_mesh(whole, bpy.context.evaluated_depsgraph_get()).volume


@pytest.fixture
def body(make_object, library):
    """An octahedron of the asset, of volume 4/3."""
    return _move(make_object("Body"), library)


def _disabled(obj):
    obj.hide_viewport = True


def _cutter(obj):
    obj.display_type = "WIRE"


def _not_rendered(obj):
    obj.hide_render = True


@pytest.mark.parametrize("hide", [_disabled, _cutter, _not_rendered])
def test_helpers_are_left_out_unless_there_is_nothing_else(make_object, library, body, shown, hide):
    helper = _move(make_object("Helper"), library)
    helper.scale = (2, 2, 2)
    hide(helper)
    assert _volume(shown) == pytest.approx(OCTAHEDRON)
    library.objects.unlink(body)
    assert _volume(shown) == pytest.approx(8 * OCTAHEDRON)


def test_disabled_collections_are_left_out(make_object, library, body, shown):
    spare = bpy.data.collections.new("Spare")
    library.children.link(spare)
    _move(make_object("Spare Wheel"), spare)
    assert _volume(shown) == pytest.approx(2 * OCTAHEDRON)
    spare.hide_viewport = True
    assert _volume(shown) == pytest.approx(OCTAHEDRON)


@pytest.fixture
def variants(library, body, shown):
    """Objects of the mesh of the body with materials of their own, one of them in an instance within the instance."""
    of_mesh, *others = (bpy.data.materials.new(name) for name in ("Of Mesh", "Of Twin", "Of Nested"))
    body.data.materials.append(of_mesh)
    twin, nested = (_move(linked(name, body.data), library) for name in ("Twin", "Nested"))
    _move_to_instance(nested, library, bpy.data.collections.new("Inner"))
    for obj, material, x in ((twin, others[0], 5), (nested, others[1], 10)):
        obj.location.x = x
        obj.material_slots[0].link, obj.material_slots[0].material = "OBJECT", material
    return body, twin, nested


def _materials(mesh):
    """Return the names of the materials of faces by their place."""
    return {round(face.center.x / 5): mesh.materials[face.material_index].name for face in mesh.polygons}


def test_objects_of_one_mesh_keep_their_own_materials(variants, shown):
    with _joined(shown) as whole:
        assert _materials(whole.data) == {0: "Of Mesh", 1: "Of Twin", 2: "Of Nested"}


def test_ends_that_stay_animated_show_what_is_read(make_object, library, variants, shown):
    """Mirrored, moved by the offset of the collection, and without a cutter."""
    _cutter(_move(make_object("Helper"), library))
    library.instance_offset, shown.scale = (0, 7, 0), (1, 1, -2)
    bpy.data.objects["Within"].scale.y = -1
    tree = frame_group("Live")
    new_node(tree, "NodeGroupOutput", {"Geometry": shown_live(tree, [shown])})
    live = linked("Live", bpy.data.meshes.new("Live"))
    live.modifiers.new("Live", "NODES").node_group = tree
    with _joined(shown) as whole:
        depsgraph = bpy.context.evaluated_depsgraph_get()
        read, seen = triangle_mesh(whole, depsgraph), triangle_mesh(live, depsgraph)
        assert _materials(live.evaluated_get(depsgraph).data) == _materials(whole.data)
        assert (seen.volume, read.volume) == pytest.approx((6 * OCTAHEDRON, 6 * OCTAHEDRON))
        np.testing.assert_allclose(seen.bounds, read.bounds, atol=1e-5)


def test_an_object_with_instances_keeps_its_own_materials(make_object):
    """Those of the instances are other ones."""
    of_mesh, own, other = (bpy.data.materials.new(name) for name in ("Of Mesh", "Own", "Other"))
    tree = frame_group("Scatter")
    lone = new_node(tree, "GeometryNodeMeshCube")
    cube = new_node(tree, "GeometryNodeSetMaterial", {"Geometry": lone.outputs["Mesh"], "Material": other})
    instance = new_node(tree, "GeometryNodeGeometryToInstance", {"Geometry": cube.outputs["Geometry"]})
    moved = new_node(tree, "GeometryNodeTransform", {0: instance.outputs["Instances"], "Translation": (5, 0, 0)})
    base = tree.nodes.new("NodeGroupInput").outputs["Geometry"]
    new_node(tree, "NodeGroupOutput", {"Geometry": joined(tree, [base, moved.outputs["Geometry"]])})
    obj = make_object("Base")
    obj.data.materials.append(of_mesh)
    obj.material_slots[0].link, obj.material_slots[0].material = "OBJECT", own
    obj.modifiers.new("Scatter", "NODES").node_group = tree
    with _joined(obj) as whole:
        assert _materials(whole.data) == {0: "Own", 1: "Other"}


def _move_to_instance(obj, outer, inner):
    outer.objects.unlink(obj)
    inner.objects.link(obj)
    _move(_instance("Within", inner), outer)


def test_custom_normals_are_those_of_an_uneven_instance(library, body, shown):
    points = element_values(body.data.vertices, "co", 3)
    body.data.normals_split_custom_set_from_vertices(points.tolist())
    shown.scale = (1, 0.3, -2)
    with _joined(shown) as whole:
        own = transformed_points(element_values(whole.data.vertices, "co", 3), np.array(shown.matrix_world.inverted()))
        corners = element_values(whole.data.loops, "vertex_index", kind=np.int32)
        expected = own[corners] / np.array([1, 0.3, -2])
        expected /= np.linalg.norm(expected, axis=1, keepdims=True)
        np.testing.assert_allclose(element_values(whole.data.corner_normals, "vector", 3), expected, atol=1e-3)


def test_the_broken_object_of_an_instance_is_named(body, shown, inventory):
    body.data.vertices[2].co.z = np.nan
    body.data.update()
    before = inventory()
    with pytest.raises(InputError, match="Body: 1 of 6 vertices"):
        _volume(shown)
    assert inventory() == before


def test_copies_at_vertices_are_shown_without_their_original(make_object, library, body, shown):
    copied = _move(make_object("Copied"), library)
    copied.parent, copied.scale = body, (0.1, 0.1, 0.1)
    body.instance_type = "VERTS"
    bpy.context.view_layer.update()
    instances = bpy.context.evaluated_depsgraph_get().object_instances
    assert sum(one.is_instance and one.object.original == copied for one in instances) == 6
    assert _volume(shown) == pytest.approx((1 + 6 / 1000) * OCTAHEDRON)
