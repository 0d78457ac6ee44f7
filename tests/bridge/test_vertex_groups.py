# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Vertex groups as arrays, in every mode in which a user may leave the object."""

from __future__ import annotations

import bpy
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings, strategies as st

from convwass_addon.bridge.vertex_groups import (
    as_weights,
    group_names,
    mesh_weights,
    read_group,
    read_groups,
    write_group,
)
from convwass_addon.errors import InputError
from tests.linked_objects import linked_to_new_file

WEIGHTS = np.array([0.0, 1.0, 0.25, 0.25, 0.123456789, 1e-6])


@pytest.fixture
def obj(make_object):
    obj = make_object("A")
    bpy.context.view_layer.objects.active = obj
    return obj


def slowly(obj, name):
    """Read a group by Blender's own way for single vertices."""
    index = obj.vertex_groups[name].index
    return [{own.group: own.weight for own in vertex.groups}.get(index, 0.0) for vertex in obj.data.vertices]


def test_written_groups_read_back(obj, inventory):
    before = inventory()
    group = write_group(obj, "Head", WEIGHTS)
    assert group.name == "Head"
    assert read_group(obj, "Head") == pytest.approx(WEIGHTS, rel=1e-6)
    assert slowly(obj, "Head") == pytest.approx(WEIGHTS, rel=1e-6)
    assert [len(vertex.groups) for vertex in obj.data.vertices] == [0, 1, 1, 1, 1, 1]
    assert inventory() == before


def test_other_groups_stay(obj):
    write_group(obj, "Before", WEIGHTS[::-1])
    for weights in (WEIGHTS, 1 - WEIGHTS, np.zeros(6)):
        write_group(obj, "Head", weights)
        write_group(obj, "After", WEIGHTS)
        assert group_names(obj) == ["Before", "Head", "After"]
        found = read_groups(obj, ["Head", "After", "Before"])
        np.testing.assert_allclose(found, [weights, WEIGHTS, WEIGHTS[::-1]], rtol=1e-6)


def test_the_active_group_stays_active(obj):
    obj.vertex_groups.new(name="First")
    obj.vertex_groups.new(name="Second")
    obj.vertex_groups.active_index = 0
    mark = obj.data.attributes.new("mark", "INT", "POINT")
    obj.data.attributes.active = mark
    names = obj.data.attributes.keys()
    write_group(obj, "Head", WEIGHTS)
    assert obj.vertex_groups.active.name == "First"
    assert obj.data.attributes.active.name == "mark"
    assert obj.data.attributes.keys() == names


@settings(max_examples=25, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(weights=st.lists(st.floats(0, 1, width=32), min_size=6, max_size=6), name=st.sampled_from(["New", "Old"]))
def test_any_weights(obj, weights, name):
    obj.vertex_groups.clear()
    write_group(obj, "Old", np.ones(6))
    write_group(obj, name, weights)
    assert read_group(obj, name).tolist() == weights
    assert slowly(obj, name) == weights


@pytest.mark.parametrize("name", ["position", "mark", 'Ünï "quote" [1]', ".hidden", "convwass written"])
def test_any_name(obj, name):
    obj.data.attributes.new("mark", "FLOAT", "POINT").data.foreach_set("value", np.full(6, 7, np.float32))
    write_group(obj, name, WEIGHTS)
    assert read_group(obj, name) == pytest.approx(WEIGHTS, rel=1e-6)
    assert group_names(obj) == [name]


def test_names_that_are_too_long(obj):
    with pytest.raises(InputError, match="is too long for the name of a vertex group"):
        write_group(obj, "x" * 100, WEIGHTS)
    assert group_names(obj) == []


@pytest.mark.parametrize("written", ["First", "Second"])
def test_particles_and_simulations_keep_their_groups(obj, bare_scene, written):
    twin = obj.copy()
    bare_scene.collection.objects.link(twin)
    used = []
    for place, name in enumerate(("First", "Second")):
        write_group(obj, name, WEIGHTS)
        for own in (obj, twin):
            own.modifiers.new(f"Hair {place}", "PARTICLE_SYSTEM")
            used.append((own.particle_systems[place], "vertex_group_density", name))
    cloth, soft = (obj.modifiers.new(kind, kind) for kind in ("CLOTH", "SOFT_BODY"))
    used += [(cloth.settings, "vertex_group_mass", "First"), (soft.settings, "vertex_group_goal", "Second")]
    used.append((cloth.collision_settings, "vertex_group_self_collisions", "First"))
    for owner, place, name in used:
        setattr(owner, place, name)
    write_group(obj, written, 1 - WEIGHTS)
    assert [getattr(owner, place) for owner, place, _ in used] == [name for *_, name in used]


def test_missing_groups_are_named(obj):
    with pytest.raises(InputError, match="A has no vertex group Head; it has: none"):
        read_group(obj, "Head")
    obj.vertex_groups.new(name="Tail")
    with pytest.raises(InputError, match="it has: Tail"):
        read_groups(obj, ["Tail", "Head"])


def test_a_locked_group_is_not_written(obj):
    write_group(obj, "Head", WEIGHTS).lock_weight = True
    with pytest.raises(InputError, match="The group Head is locked"):
        write_group(obj, "Head", 1 - WEIGHTS)
    assert read_group(obj, "Head") == pytest.approx(WEIGHTS, rel=1e-6)


def test_objects_that_are_no_meshes(bare_scene):
    lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "POINT"))
    with pytest.raises(InputError, match="Lamp is not a mesh but of type light"):
        read_group(lamp, "Head")
    with pytest.raises(InputError, match="Lamp is not a mesh"):
        write_group(lamp, "Head", WEIGHTS)


def test_weight_paint_mode(obj):
    write_group(obj, "Head", WEIGHTS)
    bpy.ops.object.mode_set(mode="WEIGHT_PAINT")
    obj.vertex_groups["Head"].add([0], 0.5, "REPLACE")
    assert read_group(obj, "Head")[0] == 0.5
    write_group(obj, "Head", WEIGHTS[::-1])
    write_group(obj, "New", WEIGHTS)
    assert obj.mode == "WEIGHT_PAINT"
    np.testing.assert_allclose(read_groups(obj, ["Head", "New"]), [WEIGHTS[::-1], WEIGHTS], rtol=1e-6)


def test_edit_mode_is_read_but_not_written(obj):
    import bmesh

    write_group(obj, "Head", WEIGHTS)
    bpy.ops.object.mode_set(mode="EDIT")
    edited = bmesh.from_edit_mesh(obj.data)
    layer = edited.verts.layers.deform.verify()
    edited.verts.ensure_lookup_table()
    edited.verts[0][layer][0] = 0.75
    assert read_group(obj, "Head") == pytest.approx([0.75, *WEIGHTS[1:]], rel=1e-6)
    with pytest.raises(InputError, match="A is in Edit Mode; leave it with Tab"):
        write_group(obj, "Head", WEIGHTS)
    assert obj.mode == "EDIT"


def test_edit_mode_of_another_object_with_the_mesh(obj, bare_scene):
    write_group(obj, "Head", WEIGHTS)
    twin = obj.copy()
    bare_scene.collection.objects.link(twin)
    bpy.ops.object.mode_set(mode="EDIT")
    assert read_group(twin, "Head") == pytest.approx(WEIGHTS, rel=1e-6)
    with pytest.raises(InputError, match="is in Edit Mode"):
        write_group(twin, "Head", WEIGHTS)


@pytest.mark.parametrize("where", ["hidden", "excluded", "nowhere", "not selected"])
def test_objects_out_of_sight(obj, bare_scene, where):
    if where == "hidden":
        obj.hide_viewport = True
    if where == "excluded":
        home = bpy.data.collections.new("Home")
        bare_scene.collection.children.link(home)
        home.objects.link(obj)
        bare_scene.collection.objects.unlink(obj)
        bpy.context.view_layer.layer_collection.children["Home"].exclude = True
    if where == "nowhere":
        bare_scene.collection.objects.unlink(obj)
    bpy.context.view_layer.objects.active = None
    write_group(obj, "Head", WEIGHTS)
    write_group(obj, "After", WEIGHTS)
    write_group(obj, "Head", WEIGHTS[::-1])
    assert read_group(obj, "Head") == pytest.approx(WEIGHTS[::-1], rel=1e-6)
    assert group_names(obj) == ["Head", "After"]
    assert obj.hide_viewport == (where == "hidden")


def test_shape_keys_and_modifiers_do_not_matter(obj):
    for name in ("Basis", "Smile"):
        obj.shape_key_add(name=name)
    obj.modifiers.new("Subdivision", "SUBSURF")
    obj.modifiers.new("Mask", "MASK").vertex_group = "Head"
    write_group(obj, "Head", WEIGHTS)
    assert read_group(obj, "Head") == pytest.approx(WEIGHTS, rel=1e-6)
    assert len(obj.data.shape_keys.key_blocks) == 2


def test_linked_objects_are_read_and_not_written(obj, tmp_path, inventory):
    write_group(obj, "Head", WEIGHTS)
    linked = linked_to_new_file("A", tmp_path)
    before = inventory()
    assert read_group(linked, "Head") == pytest.approx(WEIGHTS, rel=1e-6)
    with pytest.raises(InputError, match="A is linked from another file"):
        write_group(linked, "Head", WEIGHTS)
    assert inventory() == before


@pytest.mark.parametrize("weights", [np.ones(5), np.full(6, 1.5), np.full(6, -0.1), np.full(6, np.nan)])
def test_weights_that_do_not_fit(obj, weights):
    with pytest.raises(ValueError, match="weights"):
        write_group(obj, "Head", weights)
    assert group_names(obj) == []


def test_densities_as_weights():
    np.testing.assert_array_equal(as_weights([[0, 4], [-1, 2]]), [[0, 1], [0, 0.5]])
    np.testing.assert_array_equal(as_weights([0, 0]), [0, 0])


def test_groups_of_a_mesh_are_those_of_its_vertices_whatever_their_names(obj, inventory):
    names = ["Head", "position", "material_index", "id", "sharp_face", ".corner_vert", "radius", "UVMap", "Tail"]
    names += ["sharp_edge", ".edge_verts", ".corner_edge", "crease_vert", "crease_edge", "bevel_weight_vert"]
    names += [".select_vert", ".hide_vert", ".own", "velocity", "normal", "custom_normal", "shade_smooth"]
    rng = np.random.default_rng(3)
    for name in names:
        group = obj.vertex_groups.new(name=name)
        for vertex in range(len(obj.data.vertices)):
            if rng.random() < 0.6:
                group.add([vertex], rng.random(), "REPLACE")
    obj.data.uv_layers.new(name="UVMap")
    obj.data.attributes.new("Tail", "FLOAT", "FACE")
    assert group_names(obj) == names
    before = inventory()
    found = mesh_weights(obj.data, names, range(len(names)))
    np.testing.assert_array_equal(found, [np.float32(slowly(obj, name)) for name in names])
    np.testing.assert_array_equal(read_groups(obj, names[::-1]), found[::-1])
    assert inventory() == before
