# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Images of the looks of several shapes, baked for one mesh."""

from __future__ import annotations

import json
import struct

import bpy
import numpy as np
import pytest
from mathutils import Color, Euler, Matrix

from convwass_addon.applications.one_mesh.key_paths import KeyPath
from convwass_addon.applications.one_mesh.texture_settings import TextureSettings
from convwass_addon.applications.palettes.lab_colors import linear_of_srgb
from convwass_addon.bridge.files.image_files import ImageFormat, drawn_image, pixel_values, write_image
from convwass_addon.bridge.keyframes import curves_of
from convwass_addon.bridge.nodes.node_math import new_node
from convwass_addon.bridge.nodes.node_trees import own_tree
from convwass_addon.bridge.object_values import ObjectValues
from convwass_addon.bridge.objects import triangle_mesh
from convwass_addon.bridge.one_mesh.key_files import export_shape_keys
from convwass_addon.bridge.one_mesh.shape_keys import animate_sliders, object_with_keys
from convwass_addon.bridge.one_mesh.texture_job import TextureJob
from convwass_addon.bridge.one_mesh.texture_looks import remember_shape
from convwass_addon.bridge.scene_values import SceneValues
from convwass_addon.errors import InputError
from convwass_addon.progress import drained
from tests.reroutes import with_reroutes
from tests.scene import linked

pytestmark = pytest.mark.usefixtures("empty_scene")

SIZE = 64
QUICK = {"texture_size": SIZE, "texture_samples": 1}
RED, BLUE = (1.0, 0.0, 0.0), (0.0, 0.0, 0.5)


def plain_material(name, color, **values):
    material = bpy.data.materials.new(name)
    shader = next(node for node in own_tree(material).nodes if node.type == "BSDF_PRINCIPLED")
    shader.inputs["Base Color"].default_value = (*color, 1.0)
    for own, value in values.items():
        shader.inputs[own].default_value = value
    return material


def sphere(name, segments, material, scale=1.0):
    bpy.ops.mesh.primitive_uv_sphere_add(segments=segments, ring_count=segments // 2, radius=scale)
    obj = bpy.context.object
    obj.name = name
    obj.data.materials.append(material)
    return obj


@pytest.fixture
def ball():
    """A ball of radius 1 that grows to another one of radius 2, of other vertices, which stands aside."""
    source = sphere("Ball", 32, plain_material("Red", RED, Metallic=1.0))
    target = sphere("Large", 48, plain_material("Blue", BLUE, Metallic=1.0), 2.0)
    target.location.x = 10.0
    bpy.context.view_layer.update()
    rest = triangle_mesh(source, bpy.context.evaluated_depsgraph_get()).vertices
    path = KeyPath("Large", (1.0,), 2.0 * rest[None], 0.9, 0.0, 0.0, 0.003, 0)
    obj = object_with_keys(source, source.data.copy(), [path], bpy.context.scene)
    placement = np.eye(4)
    placement[0, 3] = -10.0
    remember_shape(obj, "Large", target, placement)
    return obj


def job(obj, **settings):
    return TextureJob(obj, TextureSettings(**{**QUICK, **settings}))


def baked(obj, **settings):
    made = job(obj, **settings)
    drained(made.steps())
    found = made.finish()
    assert not made.notices
    return found


def pixels(image):
    return pixel_values(image)[..., :3]


def principled(material):
    return next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")


def test_plain_looks_become_two_images_and_what_is_alike_a_value(ball, inventory):
    before = inventory()
    found = baked(ball)
    start, end = found.images
    np.testing.assert_allclose(pixels(start), np.broadcast_to(RED, (SIZE, SIZE, 3)), atol=0.01)
    # 0.5 is 0.735 in sRGB.
    np.testing.assert_allclose(pixels(end), np.broadcast_to((0.0, 0.0, 0.735), (SIZE, SIZE, 3)), atol=0.01)
    assert all(image.packed_file is not None for image in found.images)
    assert principled(found.material).inputs["Metallic"].default_value == 1.0
    assert [polygon.material_index for polygon in ball.data.polygons] == [1] * len(ball.data.polygons)
    bpy.data.batch_remove([*found.images, found.material])
    assert inventory() == before


@pytest.mark.skipif(bpy.app.version < (5, 0), reason="the linear color space is always Rec.709")
def test_images_have_the_colors_of_materials_in_another_linear_color_space(ball):
    bpy.ops.wm.set_working_color_space(working_space="ACEScg")
    color = (0.5, 0.3, 0.2)
    principled(ball.data.materials[0]).inputs["Base Color"].default_value = (*color, 1.0)
    start = baked(ball).images[0]
    seen = Color(pixels(start)[SIZE // 2, SIZE // 2]).from_srgb_to_scene_linear()
    np.testing.assert_allclose(seen, color, atol=0.01)


@pytest.mark.parametrize(("value", "group"), [(0.5, ""), (1.0, "Half")])
def test_looks_are_found_while_other_shape_keys_are_on(value, group):
    """A ball of radius 1, which a key of its own has inflated to 1.5, grows to 2."""
    source = sphere("Ball", 32, plain_material("Red", RED))
    target = sphere("Large", 48, plain_material("Blue", BLUE), 2.0)
    rest = triangle_mesh(source, bpy.context.evaluated_depsgraph_get()).vertices
    source.vertex_groups.new(name="Half").add(range(len(rest)), 0.5, "REPLACE")
    source.shape_key_add(name="Basis")
    own = source.shape_key_add(name="Inflated")
    own.data.foreach_set("co", 2.0 * rest.astype(np.float32).ravel())
    own.value, own.vertex_group = value, group
    path = KeyPath("Large", (1.0,), 1.5 * rest[None], 0.9, 0.0, 0.0, 0.003, 0)
    obj = object_with_keys(source, source.data.copy(), [path], bpy.context.scene)
    remember_shape(obj, "Large", target, np.eye(4))
    bpy.context.view_layer.update()
    found = baked(obj, texture_looks="END")
    np.testing.assert_allclose(principled(found.material).inputs["Base Color"].default_value[:3], BLUE, atol=0.01)
    assert not found.notices


def test_the_material_mixes_the_looks_by_the_slider(ball):
    """Emitted light in a render is the mixture of the colors."""
    found = baked(ball)
    tree = found.material.node_tree
    shown = principled(found.material).inputs["Base Color"].links[0].from_socket
    emission = tree.nodes.new("ShaderNodeEmission")
    tree.links.new(shown, emission.inputs["Color"])
    tree.links.new(emission.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
    scene = bpy.context.scene
    scene.render.engine, scene.cycles.samples = "CYCLES", 1
    scene.render.resolution_x = scene.render.resolution_y = 8
    scene.view_settings.view_transform = "Raw"
    scene.camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.camera.location.z = 3.0
    scene.collection.objects.link(scene.camera)
    ball["Large"] = 0.25
    ball.update_tag()
    assert np.allclose(rendered_center(scene), 0.75 * np.array(RED) + 0.25 * np.array(BLUE), atol=0.02)


def read_of_object(material, kind):
    """Let a material have the color of a pass index, of a custom property or of the object."""
    tree = material.node_tree
    if kind == "color":
        source = tree.nodes.new("ShaderNodeObjectInfo").outputs["Color"]
    elif kind == "index":
        index = tree.nodes.new("ShaderNodeObjectInfo").outputs["Object Index"]
        source = new_node(tree, "ShaderNodeMath", {0: index, 1: 0.5}, operation="MULTIPLY").outputs[0]
    else:
        node = new_node(tree, "ShaderNodeAttribute", attribute_type=kind.upper(), attribute_name="tint")
        source = node.outputs["Color"]
    tree.links.new(source, principled(material).inputs["Base Color"])


@pytest.mark.parametrize(
    ("kind", "color"),
    [
        ("color", (0.25, 0.5, 0.25)),
        ("index", (0.5, 0.5, 0.5)),
        ("object", (0.5, 0.25, 0.0)),
        ("instancer", (0.5, 0.25, 0.0)),
    ],
)
def test_images_show_what_materials_read_of_their_object(ball, kind, color):
    shape = bpy.data.objects["Large"]
    shape.color, shape.pass_index, shape["tint"] = (0.25, 0.5, 0.25, 1.0), 1, (0.5, 0.25)
    read_of_object(shape.data.materials[0], kind)
    found = baked(ball)
    seen = pixels(found.images[1]).reshape(-1, 3).mean(axis=0)
    # Images are in sRGB.
    np.testing.assert_allclose(linear_of_srgb(seen), color, atol=0.02)


def test_properties_are_read_as_blender_shows_them(make_object):
    """Arrays of truth values, of more than four numbers and texts are not shown."""
    obj = make_object("A")
    given = {
        "number": 2,
        "pair": (0.1, 0.2),
        "color": (0.1, 0.2, 0.3, 0.4),
        "five": (1.0,) * 5,
        "text": "red",
        "switches": (True, False),
    }
    for name, value in given.items():
        obj[name] = value
    obj.data["both"], obj["both"], obj.data["data"], obj.location = 1.0, 2.0, 3.0, (4, 5, 6)
    names = [*given, "both", "data", "location", "none"]
    material = plain_material("Reading", RED)
    for name in names:
        new_node(material.node_tree, "ShaderNodeAttribute", attribute_type="OBJECT", attribute_name=name)
    found = ObjectValues.of(obj, [None, material]).properties
    nothing = (0, 0, 0, 0)
    expected = [(2, 2, 2, 1), (0.1, 0.2, 0, 1), (0.1, 0.2, 0.3, 0.4), nothing, nothing, nothing]
    expected += [(2, 2, 2, 1), (3, 3, 3, 1), (4, 5, 6, 1), nothing]
    np.testing.assert_allclose([found[name] for name in names], expected, atol=1e-6)


def test_longer_names_than_properties_can_have_are_left_out(make_object):
    obj, copy = make_object("A"), make_object("B")
    material = plain_material("Reading", RED)
    for length in (63, 64):
        name = "x" * length
        new_node(material.node_tree, "ShaderNodeAttribute", attribute_type="OBJECT", attribute_name=name)
    ObjectValues.of(obj, [material]).write_to(copy)
    assert list(copy.keys()) == ["x" * 63]


def keyed(tree, tmp_path):
    """Return a value that is keyed to be a hundredth of the frame."""
    value = tree.nodes.new("ShaderNodeValue").outputs[0]
    for frame in (1, 101):
        value.default_value = frame / 100
        value.keyframe_insert("default_value", frame=frame)
    for key in curves_of(tree)[0].keyframe_points:
        key.interpolation = "LINEAR"
    return value


def keyed_in_group(tree, tmp_path):
    group = bpy.data.node_groups.new("Keyed", "ShaderNodeTree")
    group.interface.new_socket("Value", in_out="OUTPUT", socket_type="NodeSocketFloat")
    group.links.new(keyed(group, tmp_path), group.nodes.new("NodeGroupOutput").inputs[0])
    return new_node(tree, "ShaderNodeGroup", node_tree=group).outputs[0]


def driven(tree, tmp_path):
    value = tree.nodes.new("ShaderNodeValue").outputs[0]
    value.driver_add("default_value").driver.expression = "frame / 100"
    return value


def sequence(tree, tmp_path):
    """Return an image sequence; the image of frame 42 has the value 0.425, and that of others 0."""
    for frame in range(40, 45):
        value = 0.425 if frame == 42 else 0.0
        with drawn_image(np.full((4, 4, 4), value, np.float32), "Non-Color") as image:
            write_image(image, tmp_path / f"{frame:03d}.exr", ImageFormat("OPEN_EXR", "RGB", "32"))
    image = bpy.data.images.load(str(tmp_path / "040.exr"))
    image.source = "SEQUENCE"
    node = new_node(tree, "ShaderNodeTexImage", image=image)
    node.image_user.frame_duration, node.image_user.frame_offset = 50, 0
    return node.outputs["Color"]


@pytest.mark.parametrize("make", [keyed, keyed_in_group, driven, sequence])
def test_images_show_materials_at_the_time_when_the_baking_began(ball, tmp_path, make):
    tree = bpy.data.objects["Large"].data.materials[0].node_tree
    tree.links.new(make(tree, tmp_path), tree.nodes["Principled BSDF"].inputs["Roughness"])
    scene = bpy.context.scene
    scene.frame_set(42, subframe=0.5)
    made = job(ball, texture_looks="END")
    work = made.steps()
    next(work)
    scene.frame_set(7)
    drained(work)
    found = principled(made.finish().material).inputs["Roughness"]
    assert not found.is_linked and found.default_value == pytest.approx(0.425, abs=0.005)
    assert scene.frame_current == 7


@pytest.mark.parametrize("holder", ["view layer", "scene", "world"])
def test_images_show_what_materials_read_of_the_scene(ball, holder):
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("World")
    {"view layer": scene.view_layers[0], "scene": scene, "world": scene.world}[holder]["tint"] = (0.5, 0.25)
    read_of_object(bpy.data.objects["Large"].data.materials[0], "view_layer")
    shown = principled(baked(ball, texture_looks="END").material).inputs["Base Color"]
    np.testing.assert_allclose(shown.default_value[:3], (0.5, 0.25, 0.0), atol=0.005)


def test_properties_of_view_layers_come_before_those_of_scenes_and_worlds():
    """In each of them, custom properties come first."""
    scene = bpy.context.scene
    layer, scene.world = scene.view_layers[0], bpy.data.worlds.new("World")
    layer["a"], scene["a"], scene.world["a"] = 1.0, 2.0, 3.0
    scene["b"], scene.world["b"], scene.world["color"] = 2.0, 3.0, (4.0, 5.0, 6.0)
    # Both the view layer and the scene have a property of Blender of one of these names.
    layer.samples, scene["samples"], scene["frame_start"] = 7, 8, 9
    material = plain_material("Reading", RED)
    names = ["a", "b", "color", "samples", "frame_start", "frame_end", "none"]
    for name in names:
        new_node(material.node_tree, "ShaderNodeAttribute", attribute_type="VIEW_LAYER", attribute_name=name)
    found = SceneValues.of(scene, layer, [None, material]).properties
    end = scene.frame_end
    expected = [(1, 1, 1, 1), (2, 2, 2, 1), (4, 5, 6, 1), (7, 7, 7, 1), (9, 9, 9, 1), (end, end, end, 1), (0,) * 4]
    assert [found[name] for name in names] == expected


def rendered_center(scene):
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.filepath = bpy.app.tempdir + "center.exr"
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    found = np.array(image.pixels[:]).reshape(8, 8, 4)[3:5, 3:5, :3].mean(axis=(0, 1))
    bpy.data.images.remove(image)
    return found


def test_a_mesh_without_uvs_is_unwrapped_and_a_texture_of_the_shape_lands_where_it_belongs(ball):
    """The shape is colored by its height; every corner of the mesh must find its own height in the image."""
    while ball.data.uv_layers:
        ball.data.uv_layers.remove(ball.data.uv_layers[0])
    material = ball["convwass_shapes"]["Large"]["shape"].data.materials[0]
    tree = material.node_tree
    place, axes = tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeSeparateXYZ")
    tree.links.new(place.outputs["Generated"], axes.inputs[0])
    tree.links.new(axes.outputs["Z"], principled(material).inputs["Roughness"])
    found = baked(ball, texture_looks="END")
    (image,) = found.images
    assert image.colorspace_settings.name == "Non-Color" and found.uv_map == "Baked"
    assert error_of_heights(ball, image) < 0.06


def test_an_image_on_a_mesh_without_uvs_stays_one_color(ball):
    """It shows its corner everywhere, and is not laid along the UV map that is made for the textures."""
    while ball.data.uv_layers:
        ball.data.uv_layers.remove(ball.data.uv_layers[0])
    stripes = np.zeros((16, 16, 4), np.float32)
    stripes[..., 3] = stripes[:, :4, 0] = stripes[:, -4:, 0] = stripes[:, 4:-4, 1] = 1.0
    texture = bpy.data.images.new("Stripes", 16, 16)
    texture.pixels.foreach_set(stripes.ravel())
    texture.pack()
    material = ball.data.materials[0]
    node = new_node(material.node_tree, "ShaderNodeTexImage", image=texture)
    material.node_tree.links.new(node.outputs["Color"], principled(material).inputs["Base Color"])
    for _ in range(2):
        found = baked(ball, texture_looks="START")
        assert found.uv_map == "Baked" and not found.images
        color = principled(found.material).inputs["Base Color"].default_value
        np.testing.assert_allclose(color[:3], (1.0, 0.0, 0.0), atol=0.01)
    assert ball.data.uv_layers.keys() == ["Baked"]


def test_faces_outside_of_the_image_are_told(ball):
    """A quarter of the ball is on the next UDIM tile."""
    layer = ball.data.uv_layers[0]
    uvs = np.array([own.vector for own in layer.uv], np.float32)
    layer.uv.foreach_set("vector", (uvs * (4.0 / 3.0, 1.0)).astype(np.float32).ravel())
    told = job(ball, texture_uvs="OWN")
    told.discard()
    assert [str(own) for own in told.notices] == [
        "25% of Ball Morph are outside of the image in the UV map UVMap, as on other UDIM tiles, and repeat the look "
        "of what is inside; set UV Map to New"
    ]
    layer.uv.foreach_set("vector", (uvs + np.array((1.0, 0.0))).astype(np.float32).ravel())
    with pytest.raises(InputError, match="All of Ball Morph is outside"):
        job(ball, texture_uvs="OWN")
    assert not baked(ball).notices


def error_of_heights(ball, image):
    """Return how far values in an image are from 0 at the bottom of a mesh to 1 at the top, at most of its corners."""
    uvs = np.array([own.vector for own in ball.data.uv_layers["Baked"].uv])
    heights = np.array([ball.data.vertices[loop.vertex_index].co.z for loop in ball.data.loops])
    places = np.clip((uvs * SIZE).astype(int), 0, SIZE - 1)
    seen = pixels(image)[places[:, 1], places[:, 0], 0]
    return np.quantile(np.abs(seen - (heights + 1.0) / 2.0), 0.95)


def test_normal_maps_and_light_are_baked(ball):
    material = ball.data.materials[0]
    tree = material.node_tree
    image = bpy.data.images.new("Tilted", 4, 4)
    image.colorspace_settings.name = "Non-Color"
    image.pixels.foreach_set(np.tile(np.array([0.75, 0.5, 0.933, 1.0], np.float32), 16))
    texture, normal = tree.nodes.new("ShaderNodeTexImage"), tree.nodes.new("ShaderNodeNormalMap")
    texture.image = image
    tree.links.new(texture.outputs["Color"], normal.inputs["Color"])
    tree.links.new(normal.outputs[0], principled(material).inputs["Normal"])
    principled(material).inputs["Emission Color"].default_value = (1.0, 0.5, 0.0, 1.0)
    principled(material).inputs["Emission Strength"].default_value = 4.0
    found = baked(ball, texture_looks="START")
    assert principled(found.material).inputs["Emission Strength"].default_value == 1.0
    np.testing.assert_allclose(principled(found.material).inputs["Emission Color"].default_value[:3], (4.0, 2.0, 0.0))
    (normals,) = found.images
    np.testing.assert_allclose(np.median(pixels(normals), axis=(0, 1)), (0.75, 0.5, 0.933), atol=0.02)


@pytest.mark.parametrize(
    ("source", "name"),
    [("FILE", "lost.png"), ("MOVIE", "lost.mp4"), ("SEQUENCE", "lost_001.png"), ("TILED", "lost.<UDIM>.png")],
)
def test_missing_images_are_named(ball, tmp_path, source, name):
    texture = bpy.data.images.new("Lost", 4, 4, tiled=source == "TILED")
    texture.source, texture.filepath = source, str(tmp_path / name)
    tree = ball["convwass_shapes"]["Large"]["shape"].data.materials[0].node_tree
    for _ in range(2):
        node = new_node(tree, "ShaderNodeTexImage", image=texture)
        tree.links.new(node.outputs[0], tree.nodes["Principled BSDF"].inputs["Base Color"])
    made = job(ball)
    assert [str(notice) for notice in made.notices] == [
        "The file of the image Lost of Large is missing; it is baked in magenta"
    ]
    made.discard()


def test_the_missing_file_of_the_current_frame_counts(ball, tmp_path):
    tree = bpy.data.objects["Large"].data.materials[0].node_tree
    tree.links.new(sequence(tree, tmp_path), tree.nodes["Principled BSDF"].inputs["Roughness"])
    (tmp_path / "042.exr").unlink()
    for frame, count in ((41, 0), (42, 1)):
        bpy.context.scene.frame_set(frame)
        made = job(ball)
        assert len(made.notices) == count
        made.discard()


def test_mixed_shaders_and_groups_are_read(ball):
    """A quarter of a red Diffuse BSDF and three quarters of a group with a green Principled BSDF of alpha 0.5."""
    group = bpy.data.node_groups.new("Coat", "ShaderNodeTree")
    group.interface.new_socket("Shader", in_out="OUTPUT", socket_type="NodeSocketShader")
    coat, result = group.nodes.new("ShaderNodeBsdfPrincipled"), group.nodes.new("NodeGroupOutput")
    color = group.nodes.new("ShaderNodeRGB")
    color.outputs[0].default_value = (0.0, 1.0, 0.0, 1.0)
    coat.inputs["Alpha"].default_value = 0.5
    group.links.new(color.outputs[0], coat.inputs["Base Color"])
    group.links.new(coat.outputs[0], result.inputs[0])
    tree = ball.data.materials[0].node_tree
    used, diffuse, mix = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("Group", "BsdfDiffuse", "MixShader"))
    used.node_tree = group
    diffuse.inputs["Color"].default_value, mix.inputs[0].default_value = (1.0, 0.0, 0.0, 1.0), 0.75
    tree.links.new(diffuse.outputs[0], mix.inputs[1])
    tree.links.new(used.outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
    found = principled(baked(ball, texture_looks="START").material)
    assert not found.inputs["Base Color"].is_linked and not found.inputs["Alpha"].is_linked
    np.testing.assert_allclose(found.inputs["Base Color"].default_value[:3], (0.25, 0.75, 0.0), atol=1e-3)
    assert found.inputs["Alpha"].default_value == pytest.approx(0.625, abs=1e-3)


def half_transparent(tree):
    """Return a node with an image of a single color, which is half transparent."""
    image = bpy.data.images.new("Leaf", 4, 4, alpha=True)
    image.pixels.foreach_set(np.tile(np.float32((0.8, 0.4, 0.2, 0.5)), 16))
    image.pack()
    return new_node(tree, "ShaderNodeTexImage", image=image)


@pytest.mark.parametrize("reader", ["Alpha", "Roughness", "Factor"])
def test_images_with_alpha_keep_their_colors(ball, reader):
    """Cycles multiplies colors by the alpha that materials do not use; the baked material uses another image of it."""
    tree = ball.data.materials[0].node_tree
    leaf, shader = half_transparent(tree), tree.nodes["Principled BSDF"]
    tree.links.new(leaf.outputs["Color"], shader.inputs["Base Color"])
    if reader == "Factor":
        clear, mix = tree.nodes.new("ShaderNodeBsdfTransparent"), tree.nodes.new("ShaderNodeMixShader")
        for source, target in zip(
            (leaf.outputs["Alpha"], clear.outputs[0], shader.outputs[0]), mix.inputs, strict=True
        ):
            tree.links.new(source, target)
        tree.links.new(mix.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
    else:
        tree.links.new(leaf.outputs["Alpha"], shader.inputs[reader])
    found = baked(ball, texture_looks="START")
    values = principled(found.material).inputs
    color = values["Base Color"].default_value[:3]
    np.testing.assert_allclose(color, linear_of_srgb(np.array((0.8, 0.4, 0.2))), atol=0.01)
    read = values["Roughness" if reader == "Roughness" else "Alpha"]
    assert read.default_value == pytest.approx(0.5, abs=0.01)


def test_transparency_that_is_mixed_in_becomes_alpha_alone(ball):
    """A quarter of transparency does not make red and the light of a lamp pale."""
    tree = ball.data.materials[0].node_tree
    shader = tree.nodes["Principled BSDF"]
    shader.inputs["Emission Color"].default_value, shader.inputs["Emission Strength"].default_value = (0, 1, 0, 1), 2.0
    clear, mix = tree.nodes.new("ShaderNodeBsdfTransparent"), tree.nodes.new("ShaderNodeMixShader")
    mix.inputs[0].default_value = 0.25
    tree.links.new(shader.outputs[0], mix.inputs[1])
    tree.links.new(clear.outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
    found = principled(baked(ball, texture_looks="START").material).inputs
    assert [found[name].is_linked for name in ("Base Color", "Alpha", "Emission Color")] == [False] * 3
    np.testing.assert_allclose(found["Base Color"].default_value[:3], RED, atol=1e-3)
    assert found["Alpha"].default_value == pytest.approx(0.75, abs=1e-3)
    np.testing.assert_allclose(found["Emission Color"].default_value[:3], (0.0, 2.0, 0.0), atol=1e-3)


def test_reroutes_are_followed(ball):
    """The sum of an emission and a red Principled BSDF is red."""
    tree = ball.data.materials[0].node_tree
    light, total = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeAddShader")
    matte = tree.nodes.new("ShaderNodeBsdfPrincipled")
    matte.inputs["Base Color"].default_value = (1.0, 0.0, 0.0, 1.0)
    tree.links.new(light.outputs[0], total.inputs[0])
    tree.links.new(matte.outputs[0], total.inputs[1])
    tree.links.new(total.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
    with_reroutes(tree)
    found = principled(baked(ball, texture_looks="START").material)
    np.testing.assert_allclose(found.inputs["Base Color"].default_value[:3], (1.0, 0.0, 0.0), atol=1e-3)


def test_baking_again_replaces_images_with_those_of_the_original_materials(ball):
    first = baked(ball)
    again = baked(ball, texture_looks="START")
    assert [own.name for own in ball.data.materials] == ["Red", again.material.name]
    assert first.material.users == 0
    assert principled(again.material).inputs["Base Color"].default_value[0] == pytest.approx(1.0)


@pytest.mark.parametrize("how", ["AUTO", "NEW"])
def test_baking_again_replaces_the_uv_map_that_the_first_baking_has_made(ball, how):
    ball.data.uv_layers.new(name="Baked", do_init=False)
    uvs = np.array([corner.vector for corner in ball.data.uv_layers[0].uv])
    # The halves overlap.
    ball.data.uv_layers[0].uv.foreach_set("vector", (uvs % [0.5, 1.0]).ravel())
    before = {layer.name: np.array([corner.vector for corner in layer.uv]) for layer in ball.data.uv_layers}
    for _ in range(3):
        assert baked(ball, texture_uvs=how).uv_map == "Baked.001"
    assert baked(ball, texture_uvs="OWN").uv_map == ball.data.uv_layers[0].name
    assert baked(ball, texture_uvs=how).uv_map == "Baked.001"
    assert ball.data.uv_layers.keys() == [*before, "Baked.001"]
    for name, own in before.items():
        np.testing.assert_array_equal([corner.vector for corner in ball.data.uv_layers[name].uv], own)


def test_the_material_that_the_object_has_in_place_of_that_of_its_mesh_is_baked(ball):
    (slot,) = ball.material_slots
    slot.link, slot.material = "OBJECT", plain_material("Green", (0.0, 1.0, 0.0))
    found = principled(baked(ball, texture_looks="START").material)
    assert found.inputs["Base Color"].default_value[:3] == pytest.approx((0.0, 1.0, 0.0), abs=1e-4)


def test_the_object_may_have_been_moved(ball):
    expected = [pixels(image) for image in baked(ball).images]
    ball.matrix_world = Matrix.LocRotScale((3.0, -4.0, 5.0), Euler((0.0, 0.0, 0.5)), (2.0, 2.0, 2.0))
    bpy.context.view_layer.update()
    for image, before in zip(baked(ball).images, expected, strict=True):
        np.testing.assert_allclose(pixels(image), before, atol=0.02)
    copy = object_with_keys(ball, world_copy(ball), [], bpy.context.scene)
    bpy.context.view_layer.update()
    assert copy.matrix_world == Matrix() and len(baked(copy).images) == len(expected)


def test_the_shape_may_be_sheared(ball, inventory):
    """A turned child of an unevenly scaled parent has a matrix that no location, rotation and scale give."""
    shape, parent = ball["convwass_shapes"]["Large"]["shape"], linked("Stretch", None)
    place = shape.matrix_world.copy()
    parent.scale.x, shape.parent, shape.rotation_euler.y = 3.0, parent, 0.6
    while ball.data.uv_layers:
        ball.data.uv_layers.remove(ball.data.uv_layers[0])
    bpy.context.view_layer.update()
    shape.data.transform(shape.matrix_world.inverted() @ place)
    # Heights from -2 to 2 become values from 0 to 1.
    material = shape.data.materials[0]
    tree = material.node_tree
    position, axes = tree.nodes.new("ShaderNodeNewGeometry"), tree.nodes.new("ShaderNodeSeparateXYZ")
    tree.links.new(position.outputs["Position"], axes.inputs[0])
    value = new_node(tree, "ShaderNodeMath", {0: axes.outputs["Z"], 1: 0.25, 2: 0.5}, operation="MULTIPLY_ADD")
    tree.links.new(value.outputs[0], principled(material).inputs["Roughness"])
    before = {name for kind, name in inventory() if kind == "OBJECT"}
    (image,) = baked(ball, texture_looks="END").images
    assert {name for kind, name in inventory() if kind == "OBJECT"} == before
    assert error_of_heights(ball, image) < 0.06


def world_copy(obj):
    mesh = obj.data.copy()
    mesh.transform(obj.matrix_world, shape_keys=True)
    return mesh


def test_a_mesh_to_which_shapes_are_added_keeps_those_that_it_has(ball):
    rest = triangle_mesh(ball, bpy.context.evaluated_depsgraph_get()).vertices
    path = KeyPath("Small", (1.0,), 0.5 * rest[None], 0.9, 0.0, 0.0, 0.003, 0)
    more = object_with_keys(ball, ball.data.copy(), [path], bpy.context.scene)
    remember_shape(more, "Small", sphere("Small", 24, plain_material("Green", (0.0, 1.0, 0.0)), 0.5), np.eye(4))
    bpy.context.view_layer.update()
    assert len(baked(more).images) == 2 * 3


def test_images_can_be_written_to_a_folder(ball, tmp_path):
    found = baked(ball, texture_folder=str(tmp_path / "textures"))
    assert sorted(file.name for file in (tmp_path / "textures").iterdir()) == sorted(file.name for file in found.files)
    assert len(found.files) == 2 and all(file.stat().st_size > 0 for file in found.files)


def test_a_folder_that_cannot_be_made_is_refused_before_anything_is_baked(ball, tmp_path):
    (tmp_path / "textures").touch()
    with pytest.raises(InputError, match="cannot be written to; choose another one"):
        job(ball, texture_folder=str(tmp_path / "textures" / "ball"))


def test_a_folder_that_can_no_longer_be_made_is_named(ball, tmp_path):
    begun = job(ball, texture_folder=str(tmp_path / "textures" / "ball"))
    drained(begun.steps())
    (tmp_path / "textures").touch()
    with pytest.raises(InputError, match=r"The folder .*ball cannot be created"):
        begun.finish()


@pytest.mark.parametrize("packed", [True, False])
def test_images_of_a_new_baking_replace_those_of_the_one_before(ball, tmp_path, packed):
    folder = "" if packed else str(tmp_path)
    first = baked(ball, texture_folder=folder)
    name, kept = first.images[1].name, first.material.name
    mine = new_node(own_tree(bpy.data.materials.new("Mine")), "ShaderNodeTexImage", image=first.images[1])
    loaded = None if packed else bpy.data.images.load(str(first.files[1]))
    if loaded:
        assert pixels(loaded)[5, 5, 1] == 0.0
    principled(bpy.data.materials["Blue"]).inputs["Base Color"].default_value = (0.0, 1.0, 0.0, 1.0)
    second = baked(ball, texture_folder=folder)
    assert (second.images[1].name, second.material.name) == (name, kept)
    assert mine.image == second.images[1]
    assert second.files == first.files
    for image in [mine.image] + ([loaded] if loaded else []):
        np.testing.assert_allclose(pixels(image)[5, 5], (0.0, 1.0, 0.0), atol=0.01)


def test_images_of_a_baking_that_another_mesh_shows_or_that_were_renamed_are_kept(ball):
    first = baked(ball)
    linked("Twin", ball.data.copy())
    second = baked(ball)
    assert not set(first.images) & set(second.images)
    assert [image.name for image in first.images] == ["Ball Morph Base Color", "Ball Morph Large Base Color"]
    second.images[0].name = "Painted"
    painted = new_node(own_tree(bpy.data.materials.new("Mine")), "ShaderNodeTexImage", image=second.images[0])
    baked(ball)
    assert painted.image == second.images[0]


def test_each_of_two_meshes_has_its_own_look_only(ball):
    ball["convwass_swap"] = {"object": ball, "slider": "Large", "at": 0.5}
    for looks in ("ALL", "END"):
        with pytest.raises(InputError, match="Ball Morph is one of two meshes"):
            job(ball, texture_looks=looks)
    assert principled(baked(ball, texture_looks="START").material).inputs["Base Color"].default_value[0] == 1.0


def test_images_beside_the_file_move_with_it(ball, tmp_path):
    (tmp_path / "old").mkdir()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "old" / "ball.blend"))
    baked(ball, texture_folder="//textures")
    bpy.ops.wm.save_mainfile()
    (tmp_path / "old").rename(tmp_path / "new")
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "new" / "ball.blend"))
    assert [image.size[0] for image in bpy.data.images if len(image.pixels)] == [SIZE, SIZE]


def test_images_that_cannot_be_written_leave_nothing(ball, tmp_path, inventory):
    before = inventory()
    (tmp_path / "Ball_Morph_Large_Base_Color.png").mkdir()
    with pytest.raises(InputError, match=r"Large_Base_Color\.png could not be written"):
        baked(ball, texture_folder=str(tmp_path))
    assert inventory() == before
    assert [own.name for own in ball.data.materials] == ["Red"]


@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_gltf_files_contain_the_images_of_a_single_look(ball, tmp_path):
    texture = bpy.data.images.new("Dots", 4, 4)
    texture.pixels.foreach_set(np.tile(np.array([1, 1, 1, 1, 0, 0, 0, 1], np.float32), 8))
    node = ball.data.materials[0].node_tree.nodes.new("ShaderNodeTexImage")
    node.image = texture
    shader = principled(ball.data.materials[0])
    node.id_data.links.new(node.outputs["Color"], shader.inputs["Base Color"])
    baked(ball, texture_looks="START")
    animate_sliders(ball, ["Large"], 1, 2)
    (file,) = export_shape_keys(ball, tmp_path / "ball.glb")
    data = file.read_bytes()
    head = json.loads(data[20 : 20 + struct.unpack_from("<I", data, 12)[0]])
    (material,) = head["materials"]
    assert len(head["images"]) == 1 and "baseColorTexture" in material["pbrMetallicRoughness"]


def test_what_cannot_be_baked_is_refused_and_leaves_nothing(ball, inventory):
    shape, before = ball["convwass_shapes"]["Large"]["shape"], inventory()
    shape.location.z = 5.0
    bpy.context.view_layer.update()
    with pytest.raises(InputError, match="does not reach Large"):
        job(ball)
    while ball.data.uv_layers:
        ball.data.uv_layers.remove(ball.data.uv_layers[0])
    with pytest.raises(InputError, match="no UV map"):
        job(ball, texture_uvs="OWN")
    while len(ball.data.uv_layers) < 8:
        ball.data.uv_layers.new(do_init=False)
    with pytest.raises(InputError, match=r"^Ball Morph has eight UV maps"):
        job(ball)
    ball.data.uv_layers.remove(ball.data.uv_layers[0])
    assert inventory() == before
    bpy.data.objects.remove(shape)
    with pytest.raises(InputError, match="not in this file"):
        job(ball)


def test_the_button_bakes_and_a_stopped_job_leaves_nothing(ball, inventory):
    bpy.context.view_layer.objects.active = ball
    assert bpy.ops.convwass.bake_textures(texture_size=16, texture_samples=1) == {"FINISHED"}
    assert ball.data.materials[-1].name.startswith("Ball Morph Baked")
    before = inventory()
    stopped = job(ball)
    work = stopped.steps()
    next(work), next(work)
    work.close()
    stopped.discard()
    assert inventory() == before
