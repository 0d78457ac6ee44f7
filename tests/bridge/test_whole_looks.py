# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames show the inputs' materials with all nodes and textures, mapped as on the inputs."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.morphs.computation import Computation
from convwass_addon.applications.morphs.layouts import path_blends
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.bridge.handles import Handle
from convwass_addon.bridge.morphs.disk.exports import export_frames
from convwass_addon.bridge.morphs.job import MorphJob
from convwass_addon.bridge.morphs.looks.look_groups import DISPLACEMENT, SURFACE, CarriedNames, LookGroups
from convwass_addon.bridge.morphs.looks.materials import is_carrying, principled_of
from convwass_addon.bridge.morphs.looks.mixed_materials import MixedMaterials, WholeLooks, emission_node
from convwass_addon.bridge.morphs.players.player import make_player
from convwass_addon.bridge.morphs.removal import remove_bake
from convwass_addon.bridge.morphs.stored import INDEX_KEY, frame_objects, stored_diagnostics
from convwass_addon.bridge.nodes.node_math import new_node
from convwass_addon.bridge.nodes.node_trees import own_tree
from convwass_addon.bridge.object_values import ObjectValues
from tests.shapes import ball

SIZE = 24


def bake(inputs, steps=2, wanted=(), **options):
    import bpy

    bpy.context.view_layer.update()
    job = MorphJob(
        inputs,
        [path_blends(2, steps)[number] for number in wanted or range(steps + 1)],
        MorphSettings(32, motion="transport"),
        options,
        1,
    )
    for step in job.steps(computation=Computation(workers=1)):
        job.write(step)
    return job.finish(hide_inputs=True)


def material(name):
    """Return a material that only glows: its pictures do not depend on light."""
    import bpy

    made = bpy.data.materials.new(name)
    nodes, links = own_tree(made).nodes, made.node_tree.links
    nodes.remove(nodes["Principled BSDF"])
    glow = nodes.new("ShaderNodeEmission")
    glow.name = "Glow"
    links.new(glow.outputs[0], nodes["Material Output"].inputs["Surface"])
    return made


def shown(made, kind, output="Color", **properties):
    """Let a material show a new node."""
    node = made.node_tree.nodes.new(kind)
    for name, value in properties.items():
        setattr(node, name, value)
    made.node_tree.links.new(node.outputs[output], made.node_tree.nodes["Glow"].inputs["Color"])
    return node


def checkered(name="Checkered", squares=8):
    import bpy

    i, j = np.mgrid[0:64, 0:64] * squares // 64
    pixels = np.ones((64, 64, 4), np.float32)
    pixels[..., :3] = ((i + j) % 2)[..., None]
    image = bpy.data.images.new(name, 64, 64)
    image.pixels.foreach_set(pixels.ravel())
    made = material(name)
    shown(made, "ShaderNodeTexImage", image=image, interpolation="Closest", extension="EXTEND")
    return made


def add_ball(make_object, name, made, with_uvs=True, points=900):
    mesh = ball(points=points)
    obj = make_object(name, mesh.vertices, (), mesh.faces)
    obj.data.materials.append(made)
    if with_uvs:
        layer = obj.data.uv_layers.new(name="From Above")
        layer.uv.foreach_set("vector", from_above(obj.data))
    return obj


def from_above(mesh):
    loops = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", loops)
    points = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", points)
    return (points.reshape(-1, 3)[loops, :2] / 2 + 0.5).astype(np.float32).ravel()


def picture(scene, tmp_path, obj):
    """Render an object alone from above, (h, w, 3)."""
    import bpy

    for other in scene.objects:
        other.hide_render = other != obj
    if INDEX_KEY in obj:  # shown in its own frame only
        scene.frame_set(obj[INDEX_KEY] + 1)
    if scene.camera is None:
        camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
        camera.data.type, camera.data.ortho_scale, camera.location.z = "ORTHO", 1.2, 10
        scene.collection.objects.link(camera)
        scene.camera = camera
    scene.render.engine, scene.cycles.device, scene.cycles.samples = "CYCLES", "CPU", 4
    scene.cycles.use_denoising = False
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    scene.render.resolution_percentage = 100
    scene.view_settings.view_transform = "Raw"
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.filepath = str(tmp_path / "picture.exr")
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath, check_existing=False)
    pixels = np.array(image.pixels).reshape(SIZE, SIZE, 4)[..., :3]
    bpy.data.images.remove(image)
    return pixels


@pytest.mark.parametrize("faces", ["TRIANGLES", "QUADS"])
def test_frames_carry_the_uv_maps_of_their_inputs(make_object, faces):
    inputs = [add_ball(make_object, name, checkered(name)) for name in "AB"]
    mesh = frame_objects(bake(inputs, faces=faces))[1].data
    assert [layer.name for layer in mesh.uv_layers] == ["uv_1_From Above", "uv_2_From Above"]
    assert mesh.uv_layers.active.name == "uv_1_From Above"
    truth = from_above(mesh)
    for layer in mesh.uv_layers:
        uvs = np.empty_like(truth)
        layer.uv.foreach_get("vector", uvs)
        np.testing.assert_allclose(uvs, truth, atol=0.02)


def squares(pixels):
    """Return the share of pixels that are black or white."""
    gray = pixels.mean(axis=2)
    return float(((gray < 0.1) | (gray > 0.9)).mean())


def test_a_texture_is_as_sharp_as_on_the_input(bare_scene, make_object, tmp_path):
    inputs = [add_ball(make_object, name, checkered("Checkered")) for name in "AB"]
    frames = frame_objects(bake(inputs, steps=4))
    for obj in inputs:
        obj.hide_set(False)
    expected = picture(bare_scene, tmp_path, inputs[0])
    for frame in frames[1:-1]:
        found = picture(bare_scene, tmp_path, frame)
        assert squares(found) > 0.98 * squares(expected)
        assert np.abs(found - expected).mean() < 0.03


def procedural(name):
    """Return a material that shows positions in the own space of its object, in a nested group."""
    import bpy

    group = bpy.data.node_groups.new("Nested", "ShaderNodeTree")
    group.interface.new_socket("Color", in_out="OUTPUT", socket_type="NodeSocketColor")
    place = group.nodes.new("ShaderNodeTexCoord")
    fraction = group.nodes.new("ShaderNodeVectorMath")
    fraction.operation = "FRACTION"
    group.links.new(place.outputs["Object"], fraction.inputs[0])
    group.links.new(fraction.outputs[0], group.nodes.new("NodeGroupOutput").inputs[0])
    made = material(name)
    node = made.node_tree.nodes.new("ShaderNodeGroup")
    node.node_tree = group
    made.node_tree.links.new(node.outputs[0], made.node_tree.nodes["Glow"].inputs["Color"])
    return made


def generated(name):
    """Return a material with a texture that has no coordinates linked."""
    made = material(name)
    shown(made, "ShaderNodeTexMagic").inputs["Scale"].default_value = 3.0
    return made


def normals(name):
    made = material(name)
    shown(made, "ShaderNodeTexCoord", output="Normal")
    return made


def painted(name):
    made = material(name)
    shown(made, "ShaderNodeAttribute", attribute_name="Heat")
    return made


@pytest.mark.parametrize("make", [procedural, generated, normals, painted])
def test_frames_start_with_the_look_of_an_object_that_was_turned_and_scaled(bare_scene, make_object, tmp_path, make):
    inputs = [add_ball(make_object, name, make(name), with_uvs=False, points=3000) for name in "AB"]
    for obj in inputs:
        obj.rotation_euler, obj.scale, obj.location.x = (0.5, 0.3, 1.0), (1.3, 1.1, 1.2), 0.1
        heat = obj.data.attributes.new("Heat", "FLOAT", "POINT")
        heat.data.foreach_set("value", np.array([vertex.co.x for vertex in obj.data.vertices], np.float32))
        for polygon in obj.data.polygons:
            polygon.use_smooth = True
    frames = frame_objects(bake(inputs, steps=24, wanted=[0, 1, -1]))
    expected = picture(bare_scene, tmp_path, inputs[0])
    assert expected.std() > 0.05
    for frame in frames[:2]:
        assert np.abs(picture(bare_scene, tmp_path, frame) - expected).mean() < 0.02


def tinted(name):
    made = material(name)
    shown(made, "ShaderNodeObjectInfo")
    return made


def test_all_frames_have_the_colors_of_the_objects(bare_scene, make_object, tmp_path):
    inputs = [add_ball(make_object, name, tinted(name), points=200) for name in "AB"]
    inputs[0].color, inputs[1].color = (0.1, 0.6, 0.3, 1.0), (0.9, 0.2, 0.7, 1.0)
    frames = frame_objects(bake(inputs))
    for frame, color in zip(frames, [(0.1, 0.6, 0.3), (0.5, 0.4, 0.5), (0.9, 0.2, 0.7)], strict=True):
        seen = picture(bare_scene, tmp_path, frame)[SIZE // 2, SIZE // 2]
        np.testing.assert_allclose(seen, color, atol=0.02)


def write_mask(obj, kind, domain):
    """Give an object an attribute or a vertex group that is large on one side and small on the other one."""
    points = np.array([vertex.co for vertex in obj.data.vertices])
    places = {
        "POINT": points,
        "EDGE": np.array([points[list(edge.vertices)].mean(axis=0) for edge in obj.data.edges]),
        "FACE": np.array([polygon.center for polygon in obj.data.polygons]),
    }[domain]
    sides = np.clip(places / 2 + 0.5, 0, 1)
    if kind == "GROUP":
        group = obj.vertex_groups.new(name="Mask")
        for index, weight in enumerate(sides[:, 0]):
            group.add([index], weight, "REPLACE")
        return
    data = obj.data.attributes.new("Mask", kind, domain).data
    if kind == "FLOAT2":
        data.foreach_set("vector", sides[:, :2].astype(np.float32).ravel())
    elif kind == "QUATERNION":
        data.foreach_set("value", np.column_stack([sides, np.ones(len(sides))]).astype(np.float32).ravel())
    elif kind == "FLOAT":
        data.foreach_set("value", sides[:, 0].astype(np.float32))
    else:
        data.foreach_set("value", (places[:, 0] > 0).astype(bool if kind == "BOOLEAN" else np.int32))


@pytest.mark.parametrize("name", ["Gone", "Mask", "Other", "Color", ""])
def test_frames_show_uv_map_nodes_of_all_names(bare_scene, make_object, tmp_path, name):
    """Of a map that does not exist, a vertex group, one of the other shape, an attribute of frames, and the default."""
    inputs = [add_ball(make_object, own, material(own), points=3000) for own in "AB"]
    shown(inputs[0].data.materials[0], "ShaderNodeUVMap", output="UV", uv_map=name)
    shown(inputs[1].data.materials[0], "ShaderNodeUVMap", output="UV")
    write_mask(inputs[0], "GROUP", "POINT")
    inputs[1].data.uv_layers[0].name = "Gone"
    write_mask(inputs[1], "GROUP", "POINT")
    inputs[1].vertex_groups["Mask"].name = "Other"
    expected = picture(bare_scene, tmp_path, inputs[0])
    frame = frame_objects(bake(inputs, steps=24, wanted=[0, 1, -1]))[1]
    assert (expected.max() > 0.5) == (name in ("Mask", ""))
    assert np.abs(picture(bare_scene, tmp_path, frame) - expected).mean() < 0.05


def test_frames_carry_uv_maps_whose_names_have_few_letters_of_many_bytes(bare_scene, make_object, tmp_path):
    inputs = [add_ball(make_object, own, material(own), points=3000) for own in "AB"]
    for obj in inputs:
        obj.data.uv_layers[0].name = "あ" * 20
        shown(obj.data.materials[0], "ShaderNodeUVMap", output="UV", uv_map="あ" * 20)
    expected = picture(bare_scene, tmp_path, inputs[0])
    assert expected.std() > 0.05
    assert np.abs(picture(bare_scene, tmp_path, frame_objects(bake(inputs))[1]) - expected).mean() < 0.02


def test_frames_tell_attributes_with_the_same_long_beginning_apart(bare_scene, make_object, tmp_path):
    """An empty attribute is read after the one that is shown."""
    long = "m" * 60
    inputs = [add_ball(make_object, own, material(own), with_uvs=False, points=3000) for own in "AB"]
    for obj in inputs:
        obj.data.attributes.new(long + "A", "FLOAT", "POINT")
        write_mask(obj, "FLOAT", "POINT")
        obj.data.attributes["Mask"].name = long + "B"
        shown(obj.data.materials[0], "ShaderNodeAttribute", attribute_name=long + "B")
        new_node(obj.data.materials[0].node_tree, "ShaderNodeAttribute", attribute_name=long + "A")
    expected = picture(bare_scene, tmp_path, inputs[0])
    assert expected.std() > 0.05
    assert np.abs(picture(bare_scene, tmp_path, frame_objects(bake(inputs))[1]) - expected).mean() < 0.01


def test_names_on_frames_are_cut_between_letters_and_are_not_taken():
    long = "あ" * 20
    uv_maps, attributes = [long, long + "A", "Short"], [long + "B", long + "C"]
    names = CarriedNames(1, uv_maps, attributes, "", "", ObjectValues())
    uvs, values = [names.uv(own) for own in [*uv_maps, long + "Gone"]], [names.value(own) for own in attributes]
    assert uvs == [f"uv_1_{'あ' * 19}", f"uv_1_{'あ' * 18}.001", "uv_1_Short", f"uv_1_{'あ' * 18}.002"]
    assert values == [f"carried_1_{'あ' * 17}", f"carried_1_{'あ' * 16}.001"]
    assert [names.value(own) for own in uv_maps] == uvs[:3]
    assert list(names.uvs.items()) == list(zip(uvs, uv_maps, strict=False))
    assert names.values == dict(zip(values, attributes, strict=True))


@pytest.mark.parametrize("output", ["Color", "Fac"])
@pytest.mark.parametrize(
    ("kind", "domain"),
    [
        ("GROUP", "POINT"),
        ("FLOAT2", "POINT"),
        ("QUATERNION", "POINT"),
        ("INT8", "FACE"),
        ("FLOAT", "EDGE"),
        ("INT", "EDGE"),
        ("BOOLEAN", "EDGE"),
    ],
)
def test_frames_carry_masks_of_all_kinds(bare_scene, make_object, tmp_path, kind, domain, output):
    """The other shape has one of the same name, which nothing reads."""
    inputs = [add_ball(make_object, name, material(name), with_uvs=False, points=3000) for name in "AB"]
    shown(inputs[0].data.materials[0], "ShaderNodeAttribute", output=output, attribute_name="Mask")
    inputs[1].data.materials[0].node_tree.nodes["Glow"].inputs["Color"].default_value = (0, 0, 0, 1)
    for obj in inputs:
        write_mask(obj, kind, domain)
    inputs[1].rotation_euler.z = np.pi
    expected = picture(bare_scene, tmp_path, inputs[0])
    frames = frame_objects(bake(inputs, steps=2))
    assert expected.std() > 0.05
    assert np.abs(picture(bare_scene, tmp_path, frames[0]) - expected).mean() < 0.005
    assert np.abs(picture(bare_scene, tmp_path, frames[1]) - expected / 2).mean() < 0.02


def with_two_outputs(name, target, linked):
    """Return a material that glows green in Cycles, and red in other engines."""
    made = material(name)
    nodes, links = made.node_tree.nodes, made.node_tree.links
    nodes["Material Output"].target = target
    nodes["Glow"].inputs["Color"].default_value = (1, 0, 0, 1)
    output, glow = nodes.new("ShaderNodeOutputMaterial"), nodes.new("ShaderNodeEmission")
    output.target, glow.name = "CYCLES", "Glow in Cycles"
    glow.inputs["Color"].default_value = (0, 1, 0, 1)
    if linked:
        color = nodes.new("ShaderNodeRGB")
        color.outputs[0].default_value = (0, 1, 0, 1)
        links.new(color.outputs[0], glow.inputs["Color"])
    links.new(glow.outputs[0], output.inputs["Surface"])
    nodes["Material Output"].is_active_output = True
    return made


@pytest.mark.parametrize("linked", [False, True])
@pytest.mark.parametrize("target", ["EEVEE", "ALL"])
def test_frames_show_the_output_for_cycles_if_that_renders(bare_scene, make_object, tmp_path, target, linked):
    bare_scene.render.engine = "CYCLES"
    inputs = [add_ball(make_object, name, with_two_outputs(name, target, linked), points=200) for name in "AB"]
    for frame in frame_objects(bake(inputs)):
        seen = picture(bare_scene, tmp_path, frame)[SIZE // 2, SIZE // 2]
        np.testing.assert_allclose(seen, (0, 1, 0), atol=0.02)


@pytest.mark.parametrize("target", ["EEVEE", "ALL"])
def test_other_engines_show_the_other_output(bare_scene, target):
    made = with_two_outputs("Glowing", target, linked=False)
    bare_scene.render.engine = "BLENDER_WORKBENCH"
    assert emission_node(made).name == "Glow"
    bare_scene.render.engine = "CYCLES"
    assert emission_node(made).name == "Glow in Cycles"


def test_the_shader_of_the_shown_output_counts(bare_scene):
    """Not the first one in the list of nodes."""
    import bpy

    made = bpy.data.materials.new("Two Shaders")
    nodes, links = own_tree(made).nodes, made.node_tree.links
    output, shader = nodes.new("ShaderNodeOutputMaterial"), nodes.new("ShaderNodeBsdfPrincipled")
    output.target = "CYCLES"
    links.new(shader.outputs[0], output.inputs["Surface"])
    bare_scene.render.engine = "CYCLES"
    assert principled_of(made) == shader
    bare_scene.render.engine = "BLENDER_WORKBENCH"
    assert principled_of(made) == nodes["Principled BSDF"]


@pytest.mark.parametrize(
    "output", ["Random", "Object Index", "Material Index", "Location", "Alpha", "OBJECT", "INSTANCER"]
)
def test_frames_show_what_materials_read_of_their_objects(bare_scene, make_object, tmp_path, output):
    inputs = [add_ball(make_object, name, material(name), points=200) for name in "AB"]
    for obj, number in zip(inputs, (1, 3), strict=True):
        made = obj.data.materials[0]
        obj.pass_index = made.pass_index = number
        obj.location, obj["Tint"], obj.color[3] = (0.1, 0.1 * number, 0.2), (0.2 * number, -0.5, 0.5), 0.2 * number
        if output in ("OBJECT", "INSTANCER"):
            shown(made, "ShaderNodeAttribute", attribute_type=output, attribute_name="Tint")
        else:
            shown(made, "ShaderNodeObjectInfo", output)
    start, end = (picture(bare_scene, tmp_path, obj)[SIZE // 2, SIZE // 2] for obj in inputs)
    frames = frame_objects(bake(inputs))
    assert np.abs(end - start).max() > 0.05
    for frame, expected in zip(frames, (start, (start + end) / 2, end), strict=True):
        np.testing.assert_allclose(picture(bare_scene, tmp_path, frame)[SIZE // 2, SIZE // 2], expected, atol=0.02)


def test_materials_that_share_a_group_keep_their_own_index(bare_scene):
    import bpy

    nested = bpy.data.node_groups.new("Index", "ShaderNodeTree")
    nested.interface.new_socket("Value", in_out="OUTPUT", socket_type="NodeSocketFloat")
    index = nested.nodes.new("ShaderNodeObjectInfo").outputs["Material Index"]
    nested.links.new(index, nested.nodes.new("NodeGroupOutput").inputs[0])
    groups = LookGroups(CarriedNames(1, (), (), "", "", ObjectValues()))
    found = []
    for number in (4, 7):
        made = material(f"Number {number}")
        made.pass_index = number
        made.node_tree.nodes.new("ShaderNodeGroup").node_tree = nested
        copy = next(node.node_tree for node in groups.of(made).nodes if node.type == "GROUP")
        found += [node.outputs[0].default_value for node in copy.nodes if node.type == "VALUE"]
    assert found == [4, 7]


def test_the_parts_of_a_shape_keep_their_own_spaces(make_object):
    """Two balls form a shape; each is its own unit ball around the origin."""
    inputs = []
    for name in "AB":
        ball_, child = (add_ball(make_object, name + part, procedural(name), with_uvs=False) for part in "12")
        child.parent, child.location.x = ball_, 2.5
        inputs.append(ball_)
    mesh = frame_objects(bake(inputs, grouping="PARENTS"))[1].data
    positions = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.attributes["rest_position_1"].data.foreach_get("vector", positions)
    np.testing.assert_allclose(np.linalg.norm(positions.reshape(-1, 3), axis=1), 1.0, atol=0.05)


@pytest.mark.parametrize("how", ["FRONT", "PATCHES"])
def test_a_front_and_patches_have_sharp_edges_and_their_share_of_the_surface(bare_scene, make_object, tmp_path, how):
    inputs = [add_ball(make_object, name, material(name), with_uvs=False) for name in "AB"]
    for obj, color in zip(inputs, [(1, 0, 0, 1), (0, 1, 0, 1)], strict=True):
        obj.data.materials[0].node_tree.nodes["Glow"].inputs["Color"].default_value = color
        obj.rotation_euler.x = np.pi / 2  # seen from the side
    frames = frame_objects(bake(inputs, steps=4, looks=how))
    greens = [picture(bare_scene, tmp_path, frame)[..., 1] for frame in frames]
    assert greens[0].max() < 0.01
    assert greens[-1].min() > 0.99
    shares = [float(green.mean()) for green in greens]
    assert shares == sorted(shares)
    middle = greens[2]
    if how == "PATCHES":
        assert 0.2 < shares[2] < 0.8
        assert ((middle < 0.05) | (middle > 0.95)).mean() > 0.6


def test_a_player_shows_the_nearest_blend_with_its_whole_materials(bare_scene, make_object, tmp_path):
    inputs = [add_ball(make_object, name, checkered(name, squares)) for name, squares in (("A", 8), ("B", 5))]
    for obj in inputs:
        obj.rotation_euler.x = np.pi / 2
    collection = bake(inputs, looks="FRONT")
    expected = picture(bare_scene, tmp_path, frame_objects(collection)[1])
    player = make_player(collection)
    bare_scene.frame_set(2)
    found = picture(bare_scene, tmp_path, player)
    assert expected.std() > 0.1
    assert np.abs(found - expected).mean() < 0.01


def test_an_interpolating_player_shows_whole_materials_between_blends(bare_scene, make_object, tmp_path):
    inputs = [add_ball(make_object, name, checkered(name)) for name in "AB"]
    collection = bake(inputs, steps=4)
    expected = picture(bare_scene, tmp_path, frame_objects(collection)[2])
    player = make_player(collection, between="INTERPOLATED")
    for frame, subframe in ((3, 0.0), (3, 0.4)):
        bare_scene.frame_set(frame, subframe=subframe)
        found = picture(bare_scene, tmp_path, player)
        assert squares(found) > 0.98 * squares(expected)
        assert np.abs(found - expected).mean() < 0.06


def test_plain_materials_are_mixed_as_one_shader(make_object):
    """Without textures, values are enough; frames stay small."""
    import bpy

    inputs = []
    for name in "AB":
        made = bpy.data.materials.new(name)
        own_tree(made)
        inputs.append(add_ball(make_object, name, made))
    mesh = frame_objects(bake(inputs))[1].data
    assert not mesh.uv_layers
    assert not [tree for tree in bpy.data.node_groups if is_carrying(tree)]


def keyed(tree):
    strength = tree.nodes["Glow"].inputs["Strength"]
    for frame, value in ((1, 0.0), (11, 1.0)):
        strength.default_value = value
        strength.keyframe_insert("default_value", frame=frame)


def driven(tree):
    tree.nodes["Glow"].inputs["Strength"].driver_add("default_value").driver.expression = "min(frame - 1, 10) / 10"


@pytest.mark.parametrize("animate", [keyed, driven])
def test_frames_glow_as_their_animated_materials(bare_scene, make_object, tmp_path, animate):
    inputs = [add_ball(make_object, name, material(name), with_uvs=False) for name in "AB"]
    for obj in inputs:
        obj.data.materials[0].node_tree.nodes["Glow"].inputs["Color"].default_value = (1, 1, 1, 1)
        animate(obj.data.materials[0].node_tree)
    bare_scene.frame_set(1)
    collection = bake(inputs, steps=6)
    assert not [note for note in stored_diagnostics(collection) if note.kind.startswith("LOOK")]
    frame = frame_objects(collection)[5]
    np.testing.assert_allclose(picture(bare_scene, tmp_path, frame)[SIZE // 2, SIZE // 2], 0.5, atol=0.02)


def test_nla_strips_are_reported(make_object):
    inputs = [add_ball(make_object, name, material(name), points=200) for name in "AB"]
    tree = inputs[0].data.materials[0].node_tree
    keyed(tree)
    data = tree.animation_data
    data.nla_tracks.new().strips.new("Glow", 1, data.action)
    data.action = None
    notes = stored_diagnostics(bake(inputs))
    assert [note.values["materials"] for note in notes if note.kind == "LOOK_ANIMATED"] == ["A"]


@pytest.mark.parametrize("method", ["RANDOM_WALK", "RANDOM_WALK_SKIN"])
def test_beside_a_texture_a_material_without_a_group_shows_its_values(method):
    """So do those whose nodes cannot be copied, such as groups with repeat zones."""
    import bpy

    plain = bpy.data.materials.new("Plain")
    shader = own_tree(plain).nodes["Principled BSDF"]
    shader.subsurface_method = method
    shader.inputs["Coat Weight"].default_value = 0.375
    group = bpy.data.node_groups.new("Look", "ShaderNodeTree")
    group.interface.new_socket(SURFACE, in_out="OUTPUT", socket_type="NodeSocketShader")
    group.interface.new_socket(DISPLACEMENT, in_out="OUTPUT", socket_type="NodeSocketVector")
    group.nodes.new("NodeGroupOutput")
    looks = WholeLooks([[None], [Handle.of("node_groups", group)]], "FADE")
    made = MixedMaterials("Mixed", [[plain], [checkered()]], looks).of([0, 0])
    shaders = [node for node in made.node_tree.nodes if node.type == "BSDF_PRINCIPLED"]
    coats = [shader.inputs["Coat Weight"] for shader in shaders]
    assert [coat.default_value for coat in coats if not coat.is_linked] == [0.375]


def displaced(name, method="DISPLACEMENT"):
    """Return a material that moves the surface outwards by 0.2."""
    made = material(name)
    made.displacement_method = method
    node = made.node_tree.nodes.new("ShaderNodeDisplacement")
    for socket, value in (("Height", 1.0), ("Midlevel", 0.0), ("Scale", 0.2)):
        node.inputs[socket].default_value = value
    made.node_tree.links.new(node.outputs[0], made.node_tree.nodes["Material Output"].inputs["Displacement"])
    return made


@pytest.mark.parametrize(
    ("others", "expected"),
    [
        ([], "DISPLACEMENT"),
        ([None], "DISPLACEMENT"),
        (["plain"], "DISPLACEMENT"),
        (["DISPLACEMENT", "plain"], "DISPLACEMENT"),
        (["BUMP"], "BUMP"),
    ],
)
def test_only_displaced_materials_decide_how_frames_are_displaced(others, expected):
    made = {None: None, "plain": material("Plain")}
    slots = [displaced("First"), *(made[own] if own in made else displaced("Other", own) for own in others)]
    looks = WholeLooks([[None] for _ in slots], "FADE")
    assert MixedMaterials("Mixed", [[own] for own in slots], looks).of([0] * len(slots)).displacement_method == expected


def test_displacement_of_one_shape_fades(bare_scene, make_object, tmp_path):
    import bpy

    inputs = [add_ball(make_object, "A", displaced("A")), add_ball(make_object, "B", material("B"))]
    for obj in inputs:
        obj.scale = (0.4, 0.4, 0.4)
    bare_scene.world = bpy.data.worlds.new("Dark")
    frames = frame_objects(bake(inputs))
    seen = [int((picture(bare_scene, tmp_path, frame).mean(axis=2) > 0.5).sum()) for frame in frames]
    assert seen[0] > seen[1] + 5 > seen[2] + 10


def test_whole_materials_are_not_reported_as_dropped_and_removed_with_the_morph(make_object):
    import bpy

    inputs = [add_ball(make_object, "A", checkered()), add_ball(make_object, "B", procedural("B"))]
    groups = set(bpy.data.node_groups)
    collection = bake(inputs)
    assert [note.kind for note in stored_diagnostics(collection) if note.kind.startswith("LOOK")] == []
    assert [tree for tree in bpy.data.node_groups if is_carrying(tree)]
    remove_bake(collection)
    assert set(bpy.data.node_groups) == groups


@pytest.mark.parametrize("looks", ["FADE", "COLORS", "FRONT"])
def test_outputs_of_passes_are_reported(make_object, looks):
    """They alone are no reason to mix whole materials, which have none either."""
    import bpy

    made = material("Masked")
    made.node_tree.nodes.new("ShaderNodeOutputAOV").aov_name = "Mask"
    inputs = [add_ball(make_object, "A", made, points=200), add_ball(make_object, "B", material("B"), points=200)]
    notes = stored_diagnostics(bake(inputs, looks=looks))
    kinds = [(note.kind, note.values["materials"]) for note in notes if note.kind.startswith("LOOK")]
    assert kinds == [("LOOK_AOV", "Masked")]
    assert any(map(is_carrying, bpy.data.node_groups)) == (looks == "FRONT")


def test_volumes_and_normal_maps_of_other_spaces_are_reported(make_object):
    foggy, bumpy = checkered("Foggy"), checkered("Bumpy")
    volume = foggy.node_tree.nodes.new("ShaderNodeVolumePrincipled")
    foggy.node_tree.links.new(volume.outputs[0], foggy.node_tree.nodes["Material Output"].inputs["Volume"])
    bumpy.node_tree.nodes.new("ShaderNodeNormalMap").space = "OBJECT"
    notes = stored_diagnostics(bake([add_ball(make_object, "A", foggy), add_ball(make_object, "B", bumpy)]))
    kinds = [(note.kind, note.values["materials"]) for note in notes if note.kind.startswith("LOOK")]
    assert kinds == [("LOOK_VOLUME", "Foggy"), ("LOOK_SPACE", "Bumpy")]


@pytest.mark.parametrize("ending", ["glb", "usdc", "abc"])
def test_exports_keep_the_uv_maps(make_object, tmp_path, ending):
    """The UVs are those from above in every frame, of a ball that stays where it is."""
    import bpy

    collection = bake([add_ball(make_object, name, checkered(name), points=300) for name in "AB"])
    kind = {"glb": "gltf", "usdc": "usd", "abc": "alembic"}[ending]
    (file,) = export_frames(collection, tmp_path / f"morph.{ending}", kind)
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    if ending == "glb":
        bpy.ops.import_scene.gltf(filepath=str(file))
        meshes = [mesh for mesh in bpy.data.meshes if len(mesh.polygons) > 100]
        assert len(meshes) == 3
    else:
        if ending == "usdc":
            bpy.ops.wm.usd_import(filepath=str(file))
        else:
            bpy.ops.wm.alembic_import(filepath=str(file), as_background_job=False)
        obj = next(own for own in bpy.data.objects if own.type == "MESH")
        bpy.context.scene.frame_set(1)
        meshes = [obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data]
    for mesh in meshes:
        uvs, truth = np.empty(2 * len(mesh.loops), np.float32), from_above(mesh)
        mesh.uv_layers[0].uv.foreach_get("vector", uvs)
        np.testing.assert_allclose(uvs, truth, atol=0.03)
