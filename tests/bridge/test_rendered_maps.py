# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials that name no UV map or color attribute show the same on a joined shape as on its parts."""

from __future__ import annotations

import bpy
import numpy as np
import pytest

from convwass_addon.applications.morphs.computation import Computation
from convwass_addon.applications.morphs.layouts import path_blends
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.bridge.element_values import corner_vertices, element_values
from convwass_addon.bridge.joined_shapes import joined_shape
from convwass_addon.bridge.morphs.inputs.frozen_inputs import frozen_inputs
from convwass_addon.bridge.morphs.job import MorphJob
from convwass_addon.bridge.morphs.players.dense_bake import bake_player
from convwass_addon.bridge.morphs.players.player import make_player
from convwass_addon.bridge.morphs.stored import frame_objects
from convwass_addon.bridge.nodes.node_math import new_node
from convwass_addon.bridge.nodes.node_trees import own_tree
from convwass_addon.bridge.rendered_maps import render_colors, render_uv_map
from convwass_addon.bridge.shape_sources import shape_source
from convwass_addon.progress import drained


@pytest.fixture
def add(make_object, bare_scene):
    """Give a function that adds an octahedron to a collection, at the next of several places, 5 apart."""
    asset = bpy.data.collections.new("Asset")
    bare_scene.collection.children.link(asset)

    def added(name):
        obj = make_object(name)
        bare_scene.collection.objects.unlink(obj)
        obj.location.x = 5.0 * len(asset.objects)
        asset.objects.link(obj)
        return obj

    return added


def with_uv_maps(obj, rendered, **values):
    """Add UV maps with one value each."""
    for name, value in values.items():
        layer = obj.data.uv_layers.new(name=name)
        layer.uv.foreach_set("vector", np.full(2 * len(obj.data.loops), value, np.float32))
    obj.data.uv_layers[rendered].active_render = True
    return obj


def with_colors(obj, rendered, kind, domain, **values):
    """Add color attributes with one gray each."""
    for name, value in values.items():
        data = obj.data.color_attributes.new(name, kind, domain).data
        data.foreach_set("color", np.full(4 * len(data), value, np.float32))
    obj.data.color_attributes.render_color_index = obj.data.color_attributes.find(rendered)
    return obj


def rendered(obj, read):
    """Return the values that renders use where none is named, by place of the part."""
    bpy.context.view_layer.update()
    with joined_shape(shape_source(obj, "COLLECTIONS"), bpy.context.evaluated_depsgraph_get()) as whole:
        of_corners = read(whole.data)
        vertices = element_values(whole.data.vertices, "co", 3)[corner_vertices(whole.data)]
        places = np.rint(vertices[:, 0] / 5.0)
        return [sorted(set(np.round(of_corners[places == place], 2).tolist())) for place in np.unique(places)]


def uvs(mesh):
    layer = render_uv_map(mesh)
    assert mesh.uv_layers.active == layer
    return element_values(layer.uv, "vector", 2)[:, 0]


def colors(mesh):
    attribute = render_colors(mesh)
    values = element_values(attribute.data, "color", 4)[:, 0]
    return values if attribute.domain == "CORNER" else values[corner_vertices(mesh)]


def test_parts_keep_their_rendered_uv_maps_of_any_name(add):
    add("A")
    body = with_uv_maps(add("B"), "UVMap", Lightmap=0.25, UVMap=0.5)
    with_uv_maps(add("C"), "map1", map1=0.75)
    assert rendered(body, uvs) == [[0.0], [0.5], [0.75]]


def test_uv_maps_that_materials_may_name_are_kept_where_their_roles_are_swapped(add):
    body = with_uv_maps(add("A"), "UVMap", UVMap=0.25, Detail=0.5)
    with_uv_maps(add("B"), "Detail", UVMap=0.75, Detail=1.0)
    assert rendered(body, uvs) == [[0.25], [1.0]]
    for name, expected in (("UVMap", [[0.25], [0.75]]), ("Detail", [[0.5], [1.0]])):
        assert rendered(body, lambda mesh, name=name: element_values(mesh.uv_layers[name].uv, "vector", 2)[:, 0]) == (
            expected
        )


def test_parts_keep_their_rendered_colors_of_any_kind(add):
    add("A")
    body = with_colors(add("B"), "Col", "FLOAT_COLOR", "CORNER", Mask=0.25, Col=0.5)
    with_colors(add("C"), "COLOR_0", "FLOAT_COLOR", "POINT", COLOR_0=0.75)
    assert rendered(body, colors) == [[0.0], [0.5], [0.75]]


def test_a_mirrored_object_keeps_its_rendered_maps(add):
    body = with_uv_maps(with_colors(add("A"), "Col", "FLOAT_COLOR", "POINT", Mask=0.25, Col=0.5), "UV", Other=0, UV=1)
    body.scale.x = -1
    assert (rendered(body, colors), rendered(body, uvs)) == ([[0.5]], [[1.0]])


def player_of(inputs, steps):
    bpy.context.view_layer.update()
    job = MorphJob(inputs, path_blends(2, steps), MorphSettings(16, motion="transport"), {}, 1)
    for step in job.steps(computation=Computation(workers=1)):
        job.write(step)
    return make_player(job.finish(hide_inputs=True))


def ends_in_a_player(inputs):
    """The meshes that a player shows at both ends."""
    player = player_of(inputs, 2)
    for frame in (1, 3):
        bpy.context.scene.frame_set(frame)
        mesh = player.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
        assert len(mesh.polygons) == 8
        yield mesh


@pytest.mark.skipif(bpy.app.version < (5, 0), reason="nodes sort UV maps by name")
def test_ends_in_a_player_show_the_rendered_uv_maps_of_their_shapes(add):
    """Blender's own rendering uses the first UV map of what nodes join."""
    inputs = [with_uv_maps(add(name), "UV", Other=0.25, UV=0.5) for name in "AB"]
    for mesh in ends_in_a_player(inputs):
        np.testing.assert_allclose(element_values(render_uv_map(mesh).uv, "vector", 2), 0.5)


def test_ends_in_a_player_show_the_rendered_colors_of_their_shapes(add):
    """Blender's own rendering uses no colors of what nodes join."""
    inputs = [with_colors(add(name), "Col", "FLOAT_COLOR", "CORNER", Mask=0.25, Col=0.5) for name in "AB"]
    for mesh in ends_in_a_player(inputs):
        np.testing.assert_allclose(colors(mesh), 0.5)


def test_an_end_keeps_its_uv_maps(add):
    """The one that renders use comes first; the active one and the values stay."""
    inputs = [with_uv_maps(add("A"), "UV", Other=0.25, UV=0.5), add("B")]
    inputs[0].data.uv_layers.active = inputs[0].data.uv_layers["Other"]
    bpy.context.view_layer.update()
    (mesh, _) = (own.mesh.find() for own in frozen_inputs([shape_source(obj) for obj in inputs], [None, None]))
    assert {layer.name: float(layer.uv[0].vector[0]) for layer in mesh.uv_layers} == {"UV": 0.5, "Other": 0.25}
    assert [layer.name for layer in mesh.uv_layers] == ["UV", "Other"]
    assert (mesh.uv_layers.active.name, render_uv_map(mesh).name) == ("Other", "UV")


def test_frames_baked_of_a_player_have_the_active_uv_map_of_the_nearest_shape(add):
    """Exporters write that one."""
    inputs = [with_uv_maps(add(name), "UV", UV=0.5) for name in "AB"]
    textured = bpy.data.materials.new("Textured")
    tree = own_tree(textured)
    image = new_node(tree, "ShaderNodeTexImage")
    image.image = bpy.data.images.new("Image", 8, 8)
    tree.links.new(image.outputs["Color"], tree.nodes["Principled BSDF"].inputs["Base Color"])
    for obj in inputs:
        obj.data.materials.append(textured)
    frames = frame_objects(drained(bake_player(player_of(inputs, 3), range(1, 5), 1)))
    assert [obj.data.uv_layers.active.name for obj in frames] == ["UV", "uv_1_UV", "uv_2_UV", "UV"]
    assert all(obj.data.uv_layers.active == render_uv_map(obj.data) for obj in frames)
