# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Colors in files whose linear color space is not that of sRGB."""

from __future__ import annotations

import bpy
import numpy as np
import pytest
from mathutils import Color

from convwass_addon.applications.palettes.lab_colors import linear_of_srgb
from convwass_addon.bridge.color_attributes import read_colors, write_colors
from convwass_addon.bridge.element_values import write_attribute
from convwass_addon.bridge.heat_map import heat_colors
from convwass_addon.bridge.morphs.looks.appearance import read_appearance
from convwass_addon.bridge.morphs.looks.frame_attributes import COLOR
from convwass_addon.bridge.morphs.stored import frame_objects
from convwass_addon.bridge.nodes.node_math import new_node
from convwass_addon.bridge.nodes.node_trees import own_tree
from convwass_addon.bridge.palettes.color_pictures import read_colors_as_picture, write_picture_colors
from convwass_addon.bridge.scene_colors import scene_of_srgb, scene_to_rec709, srgb_of_scene
from convwass_addon.bridge.skies.sky_pixels import read_sky
from tests.operators.morphs import baked_morph, two_shapes
from tests.pictures import image_of

pytestmark = [
    pytest.mark.usefixtures("empty_scene"),
    pytest.mark.skipif(bpy.app.version < (5, 0), reason="the color space is always Rec.709"),
]

ORANGE = (0.9, 0.5, 0.2)


@pytest.fixture(autouse=True, params=["ACEScg", "Linear Rec.2020"])
def working_space(request, empty_scene):
    bpy.ops.wm.set_working_color_space(working_space=request.param)
    yield
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)


def in_scene(encoded):
    """Return an sRGB color in the space of the scene, as Blender converts it."""
    return np.array(Color(encoded).from_srgb_to_scene_linear())


@pytest.fixture
def plane():
    bpy.ops.mesh.primitive_plane_add()
    return bpy.context.object


def test_conversions_are_those_of_blender():
    encoded = np.random.default_rng(0).random((9, 3))
    found = scene_of_srgb(encoded)
    np.testing.assert_allclose(found, [in_scene(own) for own in encoded], atol=1e-4)
    np.testing.assert_allclose(srgb_of_scene(found), encoded, atol=1e-12)
    np.testing.assert_allclose(found @ scene_to_rec709().T, linear_of_srgb(encoded), atol=1e-12)


@pytest.mark.parametrize("kind", ["BYTE_COLOR", "FLOAT_COLOR"])
@pytest.mark.parametrize("domain", ["POINT", "CORNER"])
def test_attributes_keep_the_colors_written_to_them(plane, kind, domain):
    colors = np.tile([*in_scene(ORANGE), 0.5], (4, 1))
    plane.data.color_attributes.new("Own", kind, domain)
    write_colors(plane, "Own", colors)
    write_attribute(plane.data, "Other", kind, colors, domain)
    for name in ("Own", "Other"):
        np.testing.assert_allclose(read_colors(plane, name), colors, atol=0.008)
        shown = np.array(plane.data.color_attributes[name].data[0].color_srgb)
        np.testing.assert_allclose(shown, [*ORANGE, 0.5], atol=0.005)


def test_pictures_of_colors_keep_them(plane):
    plane.data.color_attributes.new("Own", "BYTE_COLOR", "POINT").data.foreach_set("color_srgb", [*ORANGE, 1.0] * 4)
    write_picture_colors(plane, "Own", "Copy", read_colors_as_picture(plane).pixels[:, 0])
    np.testing.assert_allclose(plane.data.color_attributes["Copy"].data[0].color_srgb[:3], ORANGE, atol=0.005)


def test_images_of_materials_have_the_colors_that_renders_show(plane):
    material = bpy.data.materials.new("Orange")
    tree = own_tree(material)
    image = image_of("Orange", np.tile([*ORANGE, 1.0], (4, 4, 1)))
    texture = new_node(tree, "ShaderNodeTexImage", image=image)
    tree.links.new(texture.outputs["Color"], tree.nodes["Principled BSDF"].inputs["Base Color"])
    plane.data.materials.append(material)
    (paint,) = read_appearance(plane.data, plane.color).paints
    np.testing.assert_allclose(paint.pixels[0, 0, :3], in_scene(ORANGE), atol=0.005)


@pytest.mark.parametrize("space", ["sRGB", "Linear Rec.709"])
def test_images_of_bytes_are_read_as_skies(space):
    image = bpy.data.images.new("Sky", 8, 4)
    image.colorspace_settings.name = space
    image.pixels.foreach_set(np.tile(np.float32([*ORANGE, 1.0]), 32))
    linear = Color(ORANGE).from_rec709_linear_to_scene_linear()
    np.testing.assert_allclose(read_sky(image)[0, 0], in_scene(ORANGE) if space == "sRGB" else linear, atol=0.005)


def test_frames_hold_colors_beyond_srgb():
    color = (1.0, 0.2, 0.02, 1.0)
    for obj in two_shapes():
        obj.color = color
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", frames=2, resolution=16)
    (colors,) = [own for own in frame_objects(baked_morph())[1].data.color_attributes if own.name == COLOR]
    np.testing.assert_allclose(colors.data[0].color, color, atol=0.01)


def test_heat_maps_have_the_same_colors():
    (darkest,) = heat_colors([0.0])
    np.testing.assert_allclose(srgb_of_scene(darkest[:3]) * 255.0, (0x1A, 0x14, 0x23), atol=1e-9)
