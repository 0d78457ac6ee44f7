# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials as lobes and lobes as materials, against closed forms and Cycles' own rendering."""

from __future__ import annotations

import math
import struct

import bpy
import numpy as np
import pytest
from hypothesis import given, strategies as st

from convwass_addon.applications.reflectance.lobe_lookup import HEIGHT, WIDTH, half_angle_table
from convwass_addon.applications.reflectance.lobe_table import incoming_directions, tabulated
from convwass_addon.applications.reflectance.materials import Ggx
from convwass_addon.applications.reflectance.table_pictures import has_table_size, table_of_picture, table_picture
from convwass_addon.bridge.nodes.node_trees import own_tree
from convwass_addon.bridge.reflectance.frame_span import Frames
from convwass_addon.bridge.reflectance.glossy_materials import read_glossy
from convwass_addon.bridge.reflectance.lobe_files import read_lobe_file, read_whole_table
from convwass_addon.bridge.reflectance.lobe_images import read_lobe_exr, write_lobe_exr, write_table_exr
from convwass_addon.bridge.reflectance.lobe_materials import PrincipledFit, fitted_material, lobe_material
from convwass_addon.bridge.reflectance.lobe_nodes import BLEND, DIFFUSE, DIRECTION, GROUP, LIGHT, STRENGTH
from convwass_addon.errors import InputError
from tests.lights import glossy, only, principled
from tests.reroutes import with_reroutes

PIXELS = 48


def even(value):
    return np.full((HEIGHT, WIDTH, 3), value, np.float32)


def table_of(alpha, rows=64):
    return half_angle_table(tabulated(Ggx(alpha, alpha), incoming_directions(12, 1), rows))


@pytest.fixture
def studio(bare_scene, tmp_path):
    """A ball, a colored sun and a camera; returns a function that renders a material, (pixels, pixels, 3)."""
    scene = bare_scene
    bpy.ops.mesh.primitive_uv_sphere_add(segments=128, ring_count=64)
    ball = bpy.context.object
    bpy.ops.object.shade_smooth()
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.data.energy, sun.data.angle, sun.data.color = 2.0, 0.0, (1.0, 0.5, 0.25)
    sun.rotation_euler = (0.6, 0.3, 0.2)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.data.type, camera.data.ortho_scale = "ORTHO", 2.2
    camera.location, camera.rotation_euler = (0, -1, 5), (math.atan2(1, 5), 0, 0)
    for obj in (sun, camera):
        scene.collection.objects.link(obj)
    scene.camera = camera
    scene.render.engine, scene.cycles.samples, scene.cycles.use_denoising = "CYCLES", 16, False
    scene.render.resolution_x = scene.render.resolution_y = PIXELS
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"

    def render(material):
        ball.data.materials.clear()
        ball.data.materials.append(material)
        scene.render.filepath = str(tmp_path / f"{material.name}.exr")
        bpy.ops.render.render(write_still=True)
        image = bpy.data.images.load(scene.render.filepath)
        values = np.array(image.pixels[:]).reshape(PIXELS, PIXELS, -1)[..., :3]
        bpy.data.images.remove(image)
        return values

    render.sun = sun
    return render


def test_cycles_shows_a_table_as_it_shows_the_lobe_itself(studio):
    alpha = 0.25
    exact = studio(glossy("Exact", math.sqrt(alpha)))
    shown = studio(lobe_material("Table", [table_of(alpha)], [(0, 0, 0)], studio.sun))
    assert np.abs(shown - exact).sum() < 0.015 * exact.sum()
    assert np.abs(shown - exact).max() < 0.01 * exact.max()


def test_the_blend_goes_evenly_from_one_table_of_the_stack_to_the_next(studio):
    """Constant tables: the rendered color is their value times the cosine."""
    material = lobe_material("Stack", [even(1.0), even(3.0), even(2.0)], [(0, 0, 0)] * 3, studio.sun, Frames(1, 9))
    seen = {}
    for frame in (1, 3, 5, 7, 9):
        bpy.context.scene.frame_set(frame)
        seen[frame] = studio(material)
    for frame, value in ((3, 2.0), (5, 3.0), (7, 2.5), (9, 2.0)):
        np.testing.assert_allclose(seen[frame], value * seen[1], rtol=2e-3, atol=1e-4)


def test_matte_tables_look_like_a_diffuse_bsdf(studio):
    exact = bpy.data.materials.new("Diffuse")
    tree = own_tree(exact)
    tree.nodes.clear()
    node = tree.nodes.new("ShaderNodeBsdfDiffuse")
    node.inputs["Color"].default_value = (0.8, 0.4, 0.2, 1)
    tree.links.new(node.outputs[0], tree.nodes.new("ShaderNodeOutputMaterial").inputs[0])
    shown = studio(lobe_material("Matte", [even(0.0)], [(0.8, 0.4, 0.2)], studio.sun))
    np.testing.assert_allclose(shown, studio(exact), atol=2e-3)


def test_the_node_group_follows_the_sun(studio):
    sun = studio.sun
    material = lobe_material("Followed", [even(1.0)], [(0, 0, 0)], sun)
    bpy.context.object.data.materials.append(material)
    node = material.node_tree.nodes[GROUP]
    sun.rotation_euler = (0.3, -0.7, 1.1)
    sun.data.energy = 5.0
    bpy.context.view_layer.update()
    axis = sun.matrix_world.col[2][:3]
    bpy.context.scene.frame_set(2)
    np.testing.assert_allclose(node.inputs[DIRECTION].default_value, axis, atol=1e-5)
    assert node.inputs[STRENGTH].default_value == pytest.approx(5.0)
    np.testing.assert_allclose(list(node.inputs[LIGHT].default_value)[:3], (1.0, 0.5, 0.25), atol=1e-6)


def test_a_new_result_replaces_the_last_one():
    def blocks():
        return {(block.id_type, block.name) for block in bpy.data.user_map()}

    first = lobe_material("Again", [even(1.0)] * 2, [(0, 0, 0)] * 2, None, Frames(1, 5))
    before = blocks()
    assert lobe_material("Again", [even(2.0)], [(0, 0, 0)], None) == first
    assert blocks() <= before
    assert {kind: sum(own == kind for own, _ in blocks()) for kind in ("IMAGE", "NODETREE")} == {
        "IMAGE": 1,
        "NODETREE": 1,
    }
    assert BLEND not in first.node_tree.nodes[GROUP].inputs
    assert fitted_material("Again", [PrincipledFit(Ggx(0.2, 0.2), (1, 1, 1), 1.0)]) != first


def test_a_group_with_other_inputs_follows_the_sun_as_before():
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.data.energy = 3.0
    material = lobe_material("Again", [even(1.0)] * 2, [(0, 0, 0)] * 2, sun, Frames(1, 5))
    bpy.context.view_layer.update()
    assert lobe_material("Again", [even(2.0)], [(0, 0, 0)], sun) == material
    node = material.node_tree.nodes[GROUP]
    paths = {curve.data_path for curve in material.node_tree.animation_data.drivers}
    assert paths == {node.inputs[name].path_from_id("default_value") for name in (DIRECTION, STRENGTH, LIGHT)}
    assert len(material.node_tree.animation_data.drivers) == 7


def test_a_principled_bsdf_is_read_as_cycles_uses_it():
    found = read_glossy(principled("A", 0.5, anisotropic=0.6, base_color=(0.9, 0.6, 0.3, 1.0)))
    aspect = math.sqrt(1 - 0.9 * 0.6)
    assert found.lobe.alpha_x == pytest.approx(0.25 / aspect)
    assert found.lobe.alpha_y == pytest.approx(0.25 * aspect)
    np.testing.assert_allclose(found.lobe.color, (0.9, 0.6, 0.3), atol=1e-6)
    assert found.diffuse == (0.0, 0.0, 0.0)
    turned = read_glossy(principled("B", 0.5, anisotropic=0.6, anisotropic_rotation=0.25)).lobe
    assert (turned.alpha_x, turned.alpha_y) == (found.lobe.alpha_y, found.lobe.alpha_x)


def test_dielectrics_reflect_by_their_index_of_refraction():
    found = read_glossy(principled("Plastic", 0.4, metallic=0.0, base_color=(0.2, 0.4, 0.8, 1.0)))
    np.testing.assert_allclose(found.lobe.color, 0.04, atol=1e-6)
    np.testing.assert_allclose(found.diffuse, (0.2, 0.4, 0.8), atol=1e-6)


def test_unreadable_input_is_refused():
    material = principled("A", 0.5)
    tree = material.node_tree
    noise = tree.nodes.new("ShaderNodeTexNoise")
    node = only(material, "BSDF_PRINCIPLED")
    tree.links.new(noise.outputs["Color"], node.inputs["Base Color"])
    assert "its unlinked color is used" in str(read_glossy(material).notices[0])
    tree.links.new(noise.outputs[0], node.inputs["Roughness"])
    with pytest.raises(InputError, match="Roughness of A comes from another node"):
        read_glossy(material)
    with pytest.raises(InputError, match="oblique"):
        read_glossy(principled("B", 0.5, anisotropic=0.5, anisotropic_rotation=0.1))
    tree.nodes.remove(node)
    with pytest.raises(InputError, match="does not end in"):
        read_glossy(material)


@pytest.mark.parametrize("what", ["node", "link"])
def test_muted_nodes_are_ignored(what):
    material = glossy("Muted", 0.5)
    node = only(material, "BSDF_GLOSSY")
    if what == "node":
        node.mute = True
    else:
        node.outputs[0].links[0].is_muted = True
    with pytest.raises(InputError, match="does not end in"):
        read_glossy(material)


def test_reroutes_are_followed():
    material = principled("Laid", 0.3)
    with_reroutes(material.node_tree)
    assert read_glossy(material).lobe.alpha_x == pytest.approx(0.09)


@pytest.mark.skipif(bpy.app.version >= (5, 0, 0), reason="from Blender 5 on nodes cannot be switched off")
def test_a_material_without_its_nodes_is_refused():
    material = principled("Plain", 0.5)
    material.use_nodes = False
    with pytest.raises(InputError, match="does not end in"):
        read_glossy(material)


def test_of_an_image_on_the_roughness_the_mean_counts():
    material = principled("A", 0.9)
    image = bpy.data.images.new("Rough", 4, 4, float_buffer=True, is_data=True)
    image.pixels.foreach_set(np.tile(np.float32([0.2, 0.2, 0.2, 1, 0.4, 0.4, 0.4, 1]), 8))
    tree = material.node_tree
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image = image
    tree.links.new(texture.outputs["Color"], only(material, "BSDF_PRINCIPLED").inputs["Roughness"])
    found = read_glossy(material)
    assert found.lobe.roughness == pytest.approx(0.3, rel=1e-5)
    assert [str(notice) for notice in found.notices] == [
        "Roughness of A is an image; its mean, 0.30, counts everywhere."
    ]
    with_reroutes(tree)
    assert read_glossy(material).lobe.roughness == pytest.approx(0.3, rel=1e-5)
    image.colorspace_settings.name = "sRGB"
    with pytest.raises(InputError, match="comes from another node"):
        read_glossy(material)


def test_a_fitted_material_is_keyed_step_by_step():
    fits = [PrincipledFit(Ggx(0.04, 0.04), (1, 0, 0), 1.0), PrincipledFit(Ggx(0.1, 0.4), (0, 1, 0), 0.5)]
    material = fitted_material("Keyed", fits, Frames(10, 20))
    node = only(material, "BSDF_PRINCIPLED")
    scene = bpy.context.scene
    bpy.ops.mesh.primitive_plane_add()
    bpy.context.object.data.materials.append(material)
    seen = []
    for frame in (10, 15, 20):
        scene.frame_set(frame)
        seen.append([node.inputs[name].default_value for name in ("Roughness", "Metallic", "Anisotropic Rotation")])
    np.testing.assert_allclose(seen[0], (0.2, 1.0, 0.0), atol=1e-6)
    np.testing.assert_allclose(seen[2], (0.04**0.25, 0.5, 0.25), atol=1e-6)
    np.testing.assert_allclose(seen[1][:2], np.mean([seen[0], seen[2]], axis=0)[:2], atol=1e-6)
    assert seen[1][2] == 0.0


def test_tables_survive_a_file(tmp_path):
    tables = list(np.random.default_rng(1).random((3, HEIGHT, WIDTH, 3), np.float32) * 1e5)
    path = write_lobe_exr(tmp_path / "a.exr", tables)
    for found in (read_lobe_exr(path), read_lobe_file(path)):
        np.testing.assert_array_equal(found, tables)
    assert [item.name for item in tmp_path.iterdir()] == ["a.exr"]
    assert not bpy.data.images


@pytest.mark.parametrize(
    ("values", "message"),
    [
        (np.ones((HEIGHT + 1, WIDTH, 3), np.float32), "is not a table"),
        (np.ones((HEIGHT, WIDTH // 2, 3), np.float32), "is not a table"),
        (even(-1.0), "has values"),
        (even(np.nan), "has values"),
    ],
)
def test_files_that_are_no_tables_are_refused(tmp_path, values, message):
    write_lobe_exr(tmp_path / "a.exr", [values])
    with pytest.raises(InputError, match=message):
        read_lobe_exr(tmp_path / "a.exr")
    (tmp_path / "b.exr").write_bytes(b"nonsense")
    with pytest.raises(InputError):
        read_lobe_exr(tmp_path / "b.exr")
    with pytest.raises(InputError, match="There is no file"):
        read_lobe_exr(tmp_path / "c.exr")
    with pytest.raises(InputError, match="those end in"):
        read_lobe_file(tmp_path / "b.png")


@pytest.mark.parametrize(("turns", "kind"), [(1, Ggx(0.3, 0.3, (0.9, 0.5, 0.1))), (3, Ggx(0.2, 0.5, (0.4, 0.5, 0.6)))])
def test_complete_tables_survive_a_file(tmp_path, turns, kind):
    table = tabulated(kind, incoming_directions(4, turns), 16)
    back = read_whole_table(write_table_exr(tmp_path / "a.lobes.exr", table))
    assert back.fits(table)
    np.testing.assert_allclose(back.albedo, table.albedo, rtol=1e-5)
    np.testing.assert_allclose(back.lobes, table.lobes, rtol=1e-5, atol=1e-6)
    if turns == 1:
        np.testing.assert_allclose(read_lobe_file(tmp_path / "a.lobes.exr")[0], half_angle_table(back), rtol=1e-5)
    else:
        with pytest.raises(InputError, match="anisotropic"):
            read_lobe_file(tmp_path / "a.lobes.exr")


def test_the_layout_of_table_files_is_documented(tmp_path):
    """The top row has the incoming directions; below lies f, from the normal down."""
    table = tabulated(Ggx(0.3, 0.3), incoming_directions(4, 1), 16)
    image = bpy.data.images.load(str(write_table_exr(tmp_path / "a.lobes.exr", table)))
    image.colorspace_settings.name = "Non-Color"
    values = np.array(image.pixels[:]).reshape(image.size[1], image.size[0], -1)[::-1, :, :3]
    assert values.shape == (1 + 4 * 16, 64, 3)
    np.testing.assert_allclose(values[0, :4], np.stack([table.theta_in, 0 * table.theta_in, np.ones(4)], axis=1))
    np.testing.assert_allclose(values[1 + 2 * 16 + 5, 7], table.reflectance()[2, 5, 7], rtol=1e-5)


def test_a_wrong_size_in_a_header_allocates_nothing(tmp_path):
    path = write_lobe_exr(tmp_path / "a.exr", [even(1.0)])
    content = path.read_bytes()
    place = content.index(b"dataWindow\0box2i\0") + 21
    path.write_bytes(content[:place] + struct.pack("<4i", 0, 0, 65535, 65535) + content[place + 16 :])
    with pytest.raises(InputError, match="is damaged"):
        read_lobe_exr(path)
    path.write_bytes(content[:30])
    with pytest.raises(InputError, match="not an OpenEXR picture"):
        read_lobe_file(path)


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (lambda picture: picture[:-1], "is not a table"),
        (lambda picture: picture[1:], "is not a table"),
        (lambda picture: -picture, "has values"),
        (lambda picture: picture * np.nan, "has values"),
        (lambda picture: np.roll(picture, 1, axis=1), "is not a table"),
        (lambda picture: np.concatenate([picture[:1, ::-1], picture[1:]]), "is not a table"),
        (lambda picture: picture * [[[2.0, 1.0, 1.0]]], "has values"),
    ],
)
def test_incomplete_pictures_of_tables_are_refused(spoil, message):
    picture = table_picture(tabulated(Ggx(0.3, 0.3), incoming_directions(4, 1), 16))
    with pytest.raises(InputError, match=message):
        table_of_picture(spoil(picture), "a.lobes.exr")


@given(st.integers(1, 64), st.integers(2, 8100))
def test_every_number_of_directions_has_its_own_size(half_rows, count):
    rows = 2 * half_rows
    height = count * rows + math.ceil(count / (4 * rows))
    assert has_table_size(4 * rows, height)
    assert not has_table_size(4 * rows, height + 1)


def test_the_matte_color_is_an_input():
    node = lobe_material("M", [even(1.0)], [(0.1, 0.2, 0.3)], None).node_tree.nodes[GROUP]
    np.testing.assert_allclose(list(node.inputs[DIFFUSE].default_value)[:3], (0.1, 0.2, 0.3), atol=1e-6)
