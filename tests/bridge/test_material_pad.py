# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Material pads: drivers, rendering in Cycles, and independence from scripts."""

from __future__ import annotations

import bpy
import numpy as np
import pytest

from convwass_addon.applications.reflectance.lobe_lookup import HEIGHT, WIDTH
from convwass_addon.applications.reflectance.materials import Ggx
from convwass_addon.applications.reflectance.weight_sheets import PadSheet, pad_weights, spread_out
from convwass_addon.bridge.reflectance.lobe_materials import PrincipledFit
from convwass_addon.bridge.reflectance.material_pad import SIDE, material_pad
from convwass_addon.bridge.reflectance.pad_materials import PLACE, pad_fitted_material, pad_lobe_material

pytestmark = pytest.mark.usefixtures("empty_scene")

NAMES = ["A", "B", "C", "D"]
HIGH = {3: np.sqrt(0.75), 4: 1.0}
# Corners in the order of the weights, as places across and up from -1 to 1.
CORNERS = {3: [(-1, -1), (1, -1), (0, 1)], 4: [(-1, 1), (1, 1), (-1, -1), (1, -1)]}


def put(pad, across, up):
    """Drag the empty, to a place from -1 to 1 both ways."""
    pad.handle.location = (0.5 * SIDE * across, 0.0, 0.5 * SIDE * HIGH[pad.count] * up)
    bpy.context.view_layer.update()
    bpy.context.scene.frame_set(bpy.context.scene.frame_current)


def place_of(material):
    node = material.node_tree.nodes[PLACE]
    return tuple(node.inputs[axis].default_value for axis in "XY")


def used(material):
    bpy.ops.mesh.primitive_plane_add()
    bpy.context.object.data.materials.append(material)
    return material


@pytest.mark.parametrize("count", [3, 4])
def test_corners_show_the_materials_themselves(count):
    pad = material_pad(bpy.context.scene, "Pad", NAMES[:count], 2)
    fits = [PrincipledFit(Ggx(0.2, 0.2), (1, 1, 1), 1.0)] * 4
    material = used(pad_fitted_material("M", fits, pad))
    for number, corner in enumerate(CORNERS[count]):
        put(pad, *corner)
        weights = pad_weights(count, *place_of(material))
        np.testing.assert_allclose(weights, np.eye(count)[number], atol=1e-4)


def test_the_place_in_a_triangle_has_the_weights_that_lie_in_it():
    """The weighted mean of the corners is the place itself."""
    pad = material_pad(bpy.context.scene, "Pad", NAMES[:3], 2)
    material = used(pad_fitted_material("M", [PrincipledFit(Ggx(0.2, 0.2), (1, 1, 1), 1.0)] * 4, pad))
    for place in ((0.0, -0.2), (0.3, -0.6), (-0.2, 0.3)):
        put(pad, *place)
        weights = pad_weights(3, *place_of(material))
        np.testing.assert_allclose(np.array(weights) @ np.array(CORNERS[3]), place, atol=1e-5)


def test_a_pad_may_be_moved_and_turned():
    pad = material_pad(bpy.context.scene, "Pad", NAMES, 2)
    material = used(pad_fitted_material("M", [PrincipledFit(Ggx(0.2, 0.2), (1, 1, 1), 1.0)] * 4, pad))
    pad.handle.parent.location, pad.handle.parent.rotation_euler = (5, 4, 3), (0.3, 0.2, 0.1)
    put(pad, 0.5, -0.5)
    np.testing.assert_allclose(place_of(material), (0.75, 0.25), atol=1e-5)


def test_drivers_are_arithmetic_that_needs_no_scripts():
    """Those that Blender can only work out with Python are disabled in files that are not trusted."""
    pad = material_pad(bpy.context.scene, "Pad", NAMES[:3], 2)
    material = pad_fitted_material("M", [PrincipledFit(Ggx(0.2, 0.2), (1, 1, 1), 1.0)] * 4, pad)
    drivers = [curve.driver for curve in material.node_tree.animation_data.drivers]
    assert len(drivers) == 2
    assert all(driver.is_valid and driver.is_simple_expression for driver in drivers)


def test_the_last_pad_is_taken_again():
    first = material_pad(bpy.context.scene, "Pad", NAMES[:3], 2)
    put(first, 0.5, 0.0)
    again = material_pad(bpy.context.scene, "Pad", NAMES[:3], 5)
    assert (again.handle, again.side) == (first.handle, 5)
    assert len([obj for obj in bpy.data.objects if obj.type == "EMPTY"]) == 1


def rendered(material, folder):
    """Return the middle pixel of a plane that a camera sees from above, (3,)."""
    scene = bpy.context.scene
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location = (0, 0, 3)
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.render.engine, scene.cycles.samples, scene.cycles.use_denoising = "CYCLES", 1, False
    scene.render.resolution_x = scene.render.resolution_y = 4
    scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
    scene.render.filepath = str(folder / "seen.exr")
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    values = np.array(image.pixels[:]).reshape(4, 4, -1)[2, 2, :3]
    bpy.data.images.remove(image)
    return values


def test_pads_of_other_scenes_go_on_moving_their_materials():
    fits = [PrincipledFit(Ggx(0.2, 0.2), (1, 1, 1), 1.0)] * 4
    first = material_pad(bpy.context.scene, "Pad", NAMES, 2)
    material = used(pad_fitted_material("M", fits, first))
    bpy.ops.scene.new(type="FULL_COPY")
    second = material_pad(bpy.context.scene, "Pad", NAMES, 2)
    other = used(pad_fitted_material("M", fits, second))
    assert second.handle != first.handle
    assert other not in (material, pad_fitted_material("M", fits, first))
    assert pad_fitted_material("M", fits, second) == other
    put(second, 1.0, 1.0)
    np.testing.assert_allclose(place_of(other), (1.0, 1.0), atol=1e-5)
    np.testing.assert_allclose(place_of(material), (0.5, 0.5), atol=1e-5)
    bpy.data.scenes.remove(bpy.data.scenes[0])
    assert pad_fitted_material("M", fits, second) == other


def test_a_pad_that_was_deleted_leaves_its_material_to_the_next_one():
    fits = [PrincipledFit(Ggx(0.2, 0.2), (1, 1, 1), 1.0)] * 4
    first = material_pad(bpy.context.scene, "Pad", NAMES, 2)
    material = used(pad_fitted_material("M", fits, first))
    for parent in first.handle.users_collection:
        parent.objects.unlink(first.handle)
    assert pad_fitted_material("M", fits, material_pad(bpy.context.scene, "Pad", NAMES, 2)) == material


def test_the_shown_material_is_bilinear_between_blends(tmp_path):
    """Constant tables: under a light from above, the rendered color is their value."""
    pad = material_pad(bpy.context.scene, "Pad", NAMES, 3)
    values = np.random.default_rng(1).random((3, 3, 3)).astype(np.float32)
    matte = np.random.default_rng(2).random((3, 3, 3))
    tables = [np.broadcast_to(value, (HEIGHT, WIDTH, 3)) for value in values.reshape(9, 3)]
    material = used(pad_lobe_material("M", tables, matte.reshape(9, 3).tolist(), None, pad))
    put(pad, 0.5, -0.75)
    # 1.5 places across and a quarter up.
    own = values + matte / np.pi
    expected = 0.75 * own[0, 1:].mean(axis=0) + 0.25 * own[1, 1:].mean(axis=0)
    np.testing.assert_allclose(rendered(material, tmp_path), expected, rtol=5e-3)


@pytest.mark.parametrize("count", [3, 4])
def test_sheets_have_every_blend_once_and_neighbors_in_turn(count):
    sheet = PadSheet.of(count, 4)
    assert len(sheet.weights) == (13 if count == 3 else 16)
    assert len(np.unique(sheet.weights, axis=0)) == len(sheet.weights)
    np.testing.assert_allclose(sheet.weights.sum(axis=1), 1.0)
    assert np.abs(np.diff(sheet.weights, axis=0)).sum(axis=1).max() < 2 / 3 + 1e-9
    spread = np.array(spread_out(sheet, list(sheet.weights))).reshape(4, 4, count)
    for row in range(4):
        for column in range(4):
            np.testing.assert_allclose(spread[row, column], pad_weights(count, column / 3, row / 3))
