# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Looks of inputs are read as renders show them, and frames get what their matter brings along."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.morphs.appearance import Carried, FaceSlots, Painted, Plain, Seen, Textured
from convwass_addon.applications.morphs.computation import Computation
from convwass_addon.applications.morphs.layouts import path_blends
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.bridge.morphs.disk.exports import export_frames
from convwass_addon.bridge.morphs.job import MorphJob
from convwass_addon.bridge.morphs.looks import appearance as appearance_module
from convwass_addon.bridge.morphs.looks.appearance import read_appearance, read_looks, seen_colors, write_carried
from convwass_addon.bridge.morphs.looks.dropped_appearance import dropped_notes, dropped_parts
from convwass_addon.bridge.morphs.stored import frame_objects, stored_diagnostics
from convwass_addon.bridge.nodes.node_trees import own_tree
from convwass_addon.bridge.objects import frozen_copy
from convwass_addon.geometry.meshes.closest_points import ClosestPoints
from convwass_addon.geometry.meshes.normals import triangle_normals
from tests.shapes import ball, box, joined

RED, GREEN, BLUE, WHITE = (1, 0, 0, 1), (0, 1, 0, 1), (0, 0, 1, 1), (1, 1, 1, 1)


def material(name, color=WHITE, roughness=0.5):
    import bpy

    made = bpy.data.materials.new(name)
    own_tree(made)
    shader = principled(made)
    shader.inputs["Base Color"].default_value = color
    shader.inputs["Roughness"].default_value = roughness
    return made


def principled(made):
    return next(node for node in made.node_tree.nodes if node.type == "BSDF_PRINCIPLED")


def linked(made, kind, socket="Color"):
    """Add a node that gives the base color."""
    node = made.node_tree.nodes.new(kind)
    made.node_tree.links.new(node.outputs[socket], principled(made).inputs["Base Color"])
    return node


def image(pixels, name="Image", is_float=False):
    import bpy

    values = np.asarray(pixels, np.float32)
    made = bpy.data.images.new(name, values.shape[1], values.shape[0], float_buffer=is_float)
    made.pixels.foreach_set(values.ravel())
    return made


def add_shape(make_object, name, mesh, *materials):
    obj = make_object(name, mesh.vertices, (), mesh.faces)
    for own in materials:
        obj.data.materials.append(own)
    return obj


def paint(obj, colors, domain="POINT", kind="FLOAT_COLOR", name="Paint"):
    attribute = obj.data.color_attributes.new(name, kind, domain)
    attribute.data.foreach_set("color", np.asarray(colors, np.float32).ravel())
    return attribute


def appearance_of(obj, depsgraph):
    names = [group.name for group in obj.vertex_groups]
    return read_looks(frozen_copy(obj, depsgraph), tuple(obj.color), names).appearance


def bake(inputs, steps=2, options=None, **settings):

    settings = MorphSettings(32, motion="transport", **settings)
    job = MorphJob(inputs, path_blends(2, steps), settings, options or {}, 1)
    for step in job.steps(computation=Computation(workers=1)):
        job.write(step)
    return job.finish(hide_inputs=True)


def values(mesh, name, prop="value", size=1):
    found = np.empty(len(mesh.vertices) * size, np.float32)
    mesh.attributes[name].data.foreach_get(prop, found)
    return found.reshape(-1, size)


def two_balls(make_object):
    return [
        add_shape(make_object, name, ball(points=300), material(name, color))
        for name, color in (("A", RED), ("B", BLUE))
    ]


def test_plain_colors_by_material(make_object, depsgraph):
    obj = add_shape(make_object, "Shape", ball(points=200), material("A", RED), material("B", BLUE))
    for polygon in obj.data.polygons:
        polygon.material_index = int(polygon.center.z > 0)
    appearance = appearance_of(obj, depsgraph)
    assert appearance.paints == (Plain(RED), Plain(BLUE))
    np.testing.assert_array_equal(appearance.at([[0, 0, 2.0], [0, 0, -2.0]]).colors, [BLUE, RED])


def test_without_material_the_object_has_its_color_or_that_of_its_attribute(make_object, depsgraph):
    plain = add_shape(make_object, "Plain", ball(points=100))
    plain.color = GREEN
    assert appearance_of(plain, depsgraph).paints == (Plain(GREEN),)
    painted = add_shape(make_object, "Painted", ball(points=100))
    heights = (ball(points=100).vertices[:, 2:] + 1) / 2
    paint(painted, np.hstack([heights] * 3 + [np.ones_like(heights)]))
    found = appearance_of(painted, depsgraph).at(ball(points=100).vertices * 1.5).colors
    np.testing.assert_allclose(found[:, :1], heights, atol=1e-5)


def test_empty_slots_beside_others_are_gray_in_all_frames(make_object):
    """As the ends are in renders, whatever the color of the object."""
    inputs = []
    for name in "AB":
        obj = add_shape(make_object, name, ball(points=200), material(name, RED), None)
        obj.data.polygons.foreach_set("material_index", [1] * len(obj.data.polygons))
        paint(obj, np.tile(GREEN, (len(obj.data.vertices), 1)))
        obj.color = GREEN
        inputs.append(obj)
    first, between, _ = (frame.data for frame in frame_objects(bake(inputs)))
    assert [own and own.name for own in first.materials] == ["A", None]
    assert [own.name for own in between.materials] == ["Morph A and B.001"]
    colors = values(between, "Color", "color", 4)
    np.testing.assert_allclose(colors, [(0.8, 0.8, 0.8, 1)] * len(colors), atol=0.005)


@pytest.mark.parametrize(
    ("domain", "kind"), [("CORNER", "BYTE_COLOR"), ("POINT", "BYTE_COLOR"), ("CORNER", "FLOAT_COLOR")]
)
def test_a_material_may_show_any_color_attribute(make_object, depsgraph, domain, kind):
    made = material("Shows")
    linked(made, "ShaderNodeVertexColor").layer_name = "Second"
    obj = add_shape(make_object, "Shape", ball(points=100), made)
    count = len(obj.data.vertices if domain == "POINT" else obj.data.loops)
    paint(obj, np.tile(RED, (count, 1)), domain, kind, "First")
    paint(obj, np.tile((0.2, 0.4, 0.6, 1), (count, 1)), domain, kind, "Second")
    appearance = appearance_of(obj, depsgraph)
    assert isinstance(appearance.paints[0], Painted)
    np.testing.assert_allclose(appearance.at([[0, 0, 1.0]]).colors, [(0.2, 0.4, 0.6, 1)], atol=0.01)


def with_uvs(obj):
    """Lay an image over a shape from above."""
    layer = obj.data.uv_layers.new(name="From Above")
    loops = np.empty(len(obj.data.loops), np.int32)
    obj.data.loops.foreach_get("vertex_index", loops)
    points = np.array([vertex.co for vertex in obj.data.vertices])
    layer.uv.foreach_set("vector", (points[loops, :2] / 2 + 0.5).astype(np.float32).ravel())
    return obj


@pytest.mark.parametrize(("is_float", "expected"), [(False, 0.214), (True, 0.5)])
def test_images_are_seen_where_their_texture_coordinates_say_and_in_linear_light(
    make_object, depsgraph, is_float, expected
):
    pixels = np.zeros((4, 4, 4), np.float32)
    pixels[..., 3] = 1.0
    pixels[:, 2:, 0] = 0.5
    made = material("Pictured")
    linked(made, "ShaderNodeTexImage").image = image(pixels, is_float=is_float)
    obj = with_uvs(add_shape(make_object, "Shape", ball(points=800), made))
    found = appearance_of(obj, depsgraph).at([[0.6, 0, 0.9], [-0.6, 0, 0.9], [0.6, 0.1, -0.9]]).colors
    np.testing.assert_allclose(found, [(expected, 0, 0, 1), (0, 0, 0, 1), (expected, 0, 0, 1)], atol=0.01)


def test_an_image_behind_other_nodes_is_found(make_object, depsgraph):
    made = material("Corrected")
    between = linked(made, "ShaderNodeHueSaturation")
    picture = made.node_tree.nodes.new("ShaderNodeTexImage")
    picture.image = image(np.ones((2, 2, 4)))
    made.node_tree.links.new(picture.outputs["Color"], between.inputs["Color"])
    obj = with_uvs(add_shape(make_object, "Shape", ball(points=100), made))
    assert isinstance(appearance_of(obj, depsgraph).paints[0], Textured)


@pytest.mark.parametrize("missing", ["image", "file", "coordinates", "node"])
def test_unreadable_images_are_replaced_by_the_viewport_color(make_object, depsgraph, missing, tmp_path):
    import bpy

    made = material("Broken")
    made.diffuse_color = BLUE
    node = linked(made, "ShaderNodeTexNoise" if missing == "node" else "ShaderNodeTexImage")
    if missing == "file":
        node.image = bpy.data.images.new("Gone", 4, 4)
        node.image.source, node.image.filepath = "FILE", str(tmp_path / "gone.png")
    elif missing == "coordinates":
        node.image = image(np.ones((2, 2, 4)))
    obj = add_shape(make_object, "Shape", ball(points=100), made)
    if missing != "coordinates":
        with_uvs(obj)
    assert appearance_of(obj, depsgraph).paints == (Plain(BLUE),)


def test_large_images_are_halved_until_they_are_small(make_object, depsgraph, monkeypatch):
    monkeypatch.setattr(appearance_module, "_MOST_PIXELS", 4)
    pixels = np.zeros((6, 16, 4), np.float32)
    pixels[:, 8:] = 1.0
    made = material("Large")
    linked(made, "ShaderNodeTexImage").image = image(pixels, is_float=True)
    obj = with_uvs(add_shape(make_object, "Shape", ball(points=100), made))
    appearance = read_appearance(frozen_copy(obj, depsgraph), WHITE)
    assert appearance.paints[0].pixels.shape == (2, 4, 4)
    np.testing.assert_array_equal(appearance.paints[0].pixels[:, :, 0], [[0, 0, 1, 1]] * 2)


def test_vertex_groups_become_attributes_if_all_inputs_have_them(make_object):
    inputs = [add_shape(make_object, name, ball(radius, points=300)) for name, radius in (("A", 1.0), ("B", 0.8))]
    for obj in inputs:
        head = obj.vertex_groups.new(name="Head")
        head.add([vertex.index for vertex in obj.data.vertices if vertex.co.z > 0], 0.5, "REPLACE")
    inputs[0].vertex_groups.new(name="Only Here").add([0], 1.0, "REPLACE")
    mesh = frame_objects(bake(inputs))[1].data
    points = values(mesh, "position", "vector", 3)
    np.testing.assert_allclose(values(mesh, "Head")[points[:, 2] > 0.2], 0.5, atol=1e-5)
    assert values(mesh, "Head")[points[:, 2] < -0.2].max() == 0
    assert "Only Here" not in mesh.attributes


def test_colors_travel_with_the_matter(make_object):
    """The distance between two balls changes; each keeps its color."""
    inputs = []
    for name, gap, colors in (("Near", 0.3, (RED, GREEN)), ("Far", 0.9, (RED, WHITE))):
        pair = joined(ball(0.5, (-0.5 - gap / 2, 0, 0), 300), ball(0.5, (0.5 + gap / 2, 0, 0), 300))
        obj = add_shape(make_object, name, pair, *(material(f"{name} {i}", color) for i, color in enumerate(colors)))
        for polygon in obj.data.polygons:
            polygon.material_index = int(polygon.center.x > 0)
        inputs.append(obj)
    mesh = frame_objects(bake(inputs))[1].data
    right = values(mesh, "position", "vector", 3)[:, 0] > 0
    expected = np.where(right[:, None], (0.5, 1, 0.5, 1), RED)
    np.testing.assert_allclose(values(mesh, "Color", "color", 4), expected, atol=0.005)
    np.testing.assert_allclose(values(mesh, "look_1", "color", 4), np.where(right[:, None], GREEN, RED), atol=1e-5)
    np.testing.assert_allclose(values(mesh, "look_2", "color", 4), np.where(right[:, None], WHITE, RED), atol=1e-5)
    assert (values(mesh, "source_weight_1") == 0.5).all()
    assert (values(mesh, "source_weight_2") == 0.5).all()
    slots = np.empty(len(mesh.vertices), np.int32)
    mesh.attributes["source_material_1"].data.foreach_get("value", slots)
    np.testing.assert_array_equal(slots, right)
    assert mesh.color_attributes.active_color_name == "Color"
    np.testing.assert_array_equal(seen_colors(mesh, WHITE), values(mesh, "Color", "color", 4))
    # A material that its user has assigned shows its own color.
    for slot in range(len(mesh.materials)):
        mesh.materials[slot] = material("Own", (0.25, 0.5, 0.0, 1.0))
    np.testing.assert_allclose(seen_colors(mesh, WHITE), np.tile((0.25, 0.5, 0.0, 1.0), (len(slots), 1)), atol=1e-3)


def rendered_color(scene, tmp_path, obj):
    """Render an object alone from above in even white light, and return the color of the picture's middle."""
    import bpy

    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.data.type, camera.data.ortho_scale, camera.location.z = "ORTHO", 0.2, 10
    scene.collection.objects.link(camera)
    scene.camera = camera
    world = scene.world = bpy.data.worlds.new("White")
    own_tree(world).nodes["Background"].inputs["Color"].default_value = WHITE
    scene.render.engine, scene.cycles.device, scene.cycles.samples = "CYCLES", "CPU", 16
    scene.cycles.use_denoising = False
    scene.render.resolution_x = scene.render.resolution_y = 4
    scene.render.resolution_percentage = 100
    scene.view_settings.view_transform = "Raw"
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.filepath = str(tmp_path / f"{obj.name}.exr")
    bpy.ops.render.render(write_still=True)
    pixels = np.array(bpy.data.images.load(scene.render.filepath).pixels).reshape(-1, 4)
    return pixels[:, :3].mean(axis=0)


def test_frames_look_like_their_inputs_near_them(bare_scene, make_object, tmp_path):
    """Neither color nor roughness jumps where the morph begins: the first frame has a material of its own."""
    one = add_shape(make_object, "One", ball(points=600), material("Mirror", (0.8, 0.2, 0.1, 1), 0.1))
    other = add_shape(make_object, "Other", ball(points=600), material("Chalk", (0.1, 0.3, 0.9, 1), 0.9))
    frames = frame_objects(bake([one, other], steps=24))
    colors = []
    for number in (1, 2):
        bare_scene.frame_set(number)
        colors.append(rendered_color(bare_scene, tmp_path, frames[number - 1]))
    np.testing.assert_allclose(colors[0], colors[1], atol=0.06)


def glowing(name, light, strength):
    """Return a black material that only glows."""
    made = material(name, (0, 0, 0, 1))
    shader = principled(made)
    shader.inputs["Specular IOR Level"].default_value = 0.0
    shader.inputs["Emission Color"].default_value = light
    shader.inputs["Emission Strength"].default_value = strength
    return made


def test_light_that_inputs_emit_is_mixed(bare_scene, make_object, tmp_path):
    """The shader of one input is a Principled BSDF, that of the other an Emission."""
    red, green = glowing("Red", RED, 0.4), material("Green")
    emission = green.node_tree.nodes.new("ShaderNodeEmission")
    emission.inputs["Color"].default_value, emission.inputs["Strength"].default_value = GREEN, 0.8
    output = next(node for node in green.node_tree.nodes if node.type == "OUTPUT_MATERIAL")
    green.node_tree.links.new(emission.outputs["Emission"], output.inputs["Surface"])
    inputs = [add_shape(make_object, "A", ball(points=300), red), add_shape(make_object, "B", ball(points=300), green)]
    half = frame_objects(bake(inputs))[1]
    principled(half.data.materials[0]).inputs["Specular IOR Level"].default_value = 0.0
    for link in list(principled(half.data.materials[0]).inputs["Specular IOR Level"].links):
        half.data.materials[0].node_tree.links.remove(link)
    bare_scene.frame_set(2)
    np.testing.assert_allclose(rendered_color(bare_scene, tmp_path, half), (0.2, 0.4, 0.0), atol=0.01)


@pytest.mark.parametrize("faces", ["TRIANGLES", "QUADS"])
def test_frames_keep_the_slots_of_their_inputs(make_object, faces):
    """In two pairs of balls, the right balls have their own slot, which is emissive in one input."""
    inputs = []
    for name, own in (("Near", glowing("Lamp", WHITE, 2.0)), ("Far", material("Bulb"))):
        pair = joined(ball(0.5, (-0.7, 0, 0), 300), ball(0.5, (0.7, 0, 0), 300))
        obj = add_shape(make_object, name, pair, material(f"{name} Body"), own)
        for polygon in obj.data.polygons:
            polygon.material_index = int(polygon.center.x > 0)
        inputs.append(obj)
    mesh = frame_objects(bake(inputs, options={"faces": faces}))[1].data
    assert [own.name for own in mesh.materials] == ["Morph Near and Far", "Morph Lamp and Bulb"]
    lit = [principled(own).inputs["Emission Strength"].default_value for own in mesh.materials]
    assert lit == [0.0, 1.0]
    assert all(polygon.material_index == int(polygon.center.x > 0) for polygon in mesh.polygons)


def test_materials_that_frames_do_not_show_are_named(make_object):
    """A procedural color, a normal map and a texture of the roughness in one input; another one is plain."""
    noisy = material("Noisy")
    linked(noisy, "ShaderNodeTexNoise")
    rough = material("Rough", RED)
    links, nodes = rough.node_tree.links, rough.node_tree.nodes
    links.new(nodes.new("ShaderNodeNormalMap").outputs["Normal"], principled(rough).inputs["Normal"])
    links.new(nodes.new("ShaderNodeTexImage").outputs["Color"], principled(rough).inputs["Roughness"])
    unused = material("Unused")
    linked(unused, "ShaderNodeTexNoise")
    shape = add_shape(make_object, "A", ball(points=300), noisy, rough, unused)
    for polygon in shape.data.polygons:
        polygon.material_index = int(polygon.center.z > 0)
    plain = add_shape(make_object, "B", ball(points=300), glowing("Lamp", RED, 2.0))
    notes = stored_diagnostics(bake([shape, plain], options={"looks": "COLORS"}))
    assert [(note.kind, note.values["materials"]) for note in notes] == [
        ("LOOK_PROCEDURAL", "Noisy"),
        ("LOOK_NORMALS", "Rough"),
        ("LOOK_MAPS", "Rough"),
    ]
    assert "Roughness of Rough (A)" in notes[-1].text


@pytest.mark.parametrize(
    ("kind", "expected"),
    [
        ("texture", ["LOOK_BLURRED"]),
        ("corrected", ["LOOK_NODES", "LOOK_BLURRED"]),
        ("missing", ["LOOK_MISSING"]),
        ("glass", ["LOOK_SHADER"]),
        ("keyed", ["LOOK_ANIMATED"]),
        ("object", []),
        ("random", ["LOOK_PROCEDURAL"]),
        ("tinted", ["LOOK_NODES"]),
    ],
)
def test_ignored_features_of_a_material_are_listed(make_object, depsgraph, kind, expected):
    made = material("Own")
    obj = with_uvs(add_shape(make_object, "Shape", ball(points=100), made))
    if kind == "glass":
        glass = made.node_tree.nodes.new("ShaderNodeBsdfGlass")
        output = next(node for node in made.node_tree.nodes if node.type == "OUTPUT_MATERIAL")
        made.node_tree.links.new(glass.outputs["BSDF"], output.inputs["Surface"])
    elif kind == "keyed":
        principled(made).inputs["Roughness"].keyframe_insert("default_value", frame=1)
    elif kind == "random":
        linked(made, "ShaderNodeObjectInfo", "Random")
    elif kind == "tinted":
        info = made.node_tree.nodes.new("ShaderNodeObjectInfo")
        made.node_tree.links.new(info.outputs["Color"], linked(made, "ShaderNodeInvert").inputs["Color"])
    elif kind == "corrected":
        between = linked(made, "ShaderNodeInvert")
        picture = made.node_tree.nodes.new("ShaderNodeTexImage")
        picture.image = image(np.ones((2, 2, 4)))
        made.node_tree.links.new(picture.outputs["Color"], between.inputs["Color"])
    else:
        node = linked(made, "ShaderNodeObjectInfo" if kind == "object" else "ShaderNodeTexImage")
        if kind == "texture":
            node.image = image(np.ones((2, 2, 4)))
    frozen = frozen_copy(obj, depsgraph)
    notes = dropped_notes(["Shape"], [dropped_parts(frozen, read_appearance(frozen, WHITE))])
    assert [note.kind for note in notes] == expected


def test_an_input_that_is_painted_and_has_no_material_wears_that_of_the_frames(make_object):
    painted = add_shape(make_object, "Painted", ball(points=300))
    paint(painted, np.tile((0.2, 0.4, 0.6, 1), (len(painted.data.vertices), 1)))
    bare = add_shape(make_object, "Bare", ball(0.8, points=300))
    frames = frame_objects(bake([painted, bare]))
    assert frames[0].data.materials[0] == frames[1].data.materials[0]
    assert frames[2].data.materials[0] != frames[1].data.materials[0]
    np.testing.assert_allclose(values(frames[0].data, "Color", "color", 4), [(0.2, 0.4, 0.6, 1)] * 300, atol=1e-6)


def test_without_carrying_frames_are_bare(make_object):
    inputs = [add_shape(make_object, name, ball(points=300)) for name in "AB"]
    mesh = frame_objects(bake(inputs, carry=False))[1].data
    assert not {"Color", "velocity", "look_1", "source_weight_1"} & set(mesh.attributes.keys())


@pytest.mark.parametrize("flat", [True, False])
def test_normals_of_an_input_are_those_that_renders_show(make_object, depsgraph, flat):
    obj = add_shape(make_object, "Shape", ball(points=200))
    if not flat:
        obj.data.shade_smooth()
    shading = read_looks(frozen_copy(obj, depsgraph), WHITE).shading
    assert shading.is_smooth != flat
    facing = triangle_normals(shading.corners)
    assert np.allclose(shading.normals, facing[:, None], atol=1e-3) == flat
    outward = shading.corners / np.linalg.norm(shading.corners, axis=2, keepdims=True)
    assert np.allclose(shading.normals, outward, atol=0.05) != flat


@pytest.mark.parametrize("faces", ["TRIANGLES", "QUADS"])
def test_blends_of_flat_shapes_are_flat(make_object, faces):
    boxes = [add_shape(make_object, name, box(size)) for name, size in (("A", (1, 1, 1.5)), ("B", (1.5, 1, 1)))]
    first = frame_objects(bake(boxes, 2, {"faces": faces}, detail=1.0))[1].data
    assert first.normals_domain == "CORNER"
    corners, facing = np.empty(3 * len(first.loops), np.float32), np.empty(3 * len(first.polygons), np.float32)
    first.corner_normals.foreach_get("vector", corners)
    first.polygon_normals.foreach_get("vector", facing)
    counts = [polygon.loop_total for polygon in first.polygons]
    assert (max(counts) == 4) == (faces == "QUADS")
    agreement = (corners.reshape(-1, 3) * np.repeat(facing.reshape(-1, 3), counts, axis=0)).sum(axis=1)
    assert np.degrees(np.arccos(np.quantile(agreement, 0.1))) < 2.0


def test_blends_without_detail_are_smooth(make_object):
    boxes = [add_shape(make_object, name, box(size)) for name, size in (("A", (1, 1, 1.5)), ("B", (1.5, 1, 1)))]
    first = frame_objects(bake(boxes, 2))[1].data
    assert not first.has_custom_normals
    assert not first.attributes.get("sharp_face")


def test_a_discarded_bake_leaves_nothing_behind(make_object, inventory):
    inputs = [add_shape(make_object, name, ball(points=300), material(name)) for name in "AB"]
    before = inventory()
    job = MorphJob(inputs, path_blends(2, 2), MorphSettings(32, motion="transport"), {}, 1)
    for step in job.steps(computation=Computation(workers=1)):
        job.write(step)
    job.discard()
    assert inventory() == before


def test_usd_has_the_carried_colors(make_object, tmp_path):
    import bpy

    inputs = two_balls(make_object)
    (file,) = export_frames(bake(inputs), tmp_path / "colors", "usd")
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    bpy.ops.wm.usd_import(filepath=str(file))
    bpy.context.scene.frame_set(2)
    (obj,) = (obj for obj in bpy.data.objects if obj.type == "MESH")
    mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    assert not {"Color", "look_1", "look_2"} & set(mesh.attributes.keys())
    found = values(mesh, "displayColor", "color", 4)
    np.testing.assert_allclose(found[:, :3], np.tile((0.5, 0, 0.5), (len(found), 1)), atol=0.005)


def test_groups_do_not_replace_attributes(make_object):
    obj = make_object("Octahedron")
    count = len(obj.data.vertices)
    nowhere = ClosestPoints(np.zeros(count, np.int64), np.empty((0, 3)), np.empty(0))
    groups = {"Color": np.zeros(count, np.float32)}
    seen = Seen(np.ones((count, 4), np.float32), nowhere.triangles, groups, nowhere)
    write_carried(obj.data, Carried((1.0,), {0: seen}, FaceSlots.of(np.zeros((1, 1), np.int64))))
    assert (values(obj.data, "Color", "color", 4) == 1).all()


def test_stills_have_the_mean_color(make_object, tmp_path):
    import bpy

    files = export_frames(bake(two_balls(make_object)), tmp_path / "still", "obj")
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    bpy.ops.wm.obj_import(filepath=str(files[1]))
    (obj,) = (obj for obj in bpy.data.objects if obj.type == "MESH")
    color = principled(obj.data.materials[0]).inputs["Base Color"].default_value
    np.testing.assert_allclose(tuple(color)[:3], (0.5, 0, 0.5), atol=1e-3)


@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_gltf_has_the_color_of_every_vertex(make_object, tmp_path):
    import bpy

    (file,) = export_frames(bake(two_balls(make_object)), tmp_path / "still", "gltf")
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    bpy.ops.import_scene.gltf(filepath=str(file))
    colors = seen_colors(bpy.data.objects["still_0002"].data, WHITE)[:, :3]
    np.testing.assert_allclose(colors.mean(axis=0), (0.5, 0, 0.5), atol=0.01)
