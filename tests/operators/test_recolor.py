# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Recoloring images and color attributes, and grades to reuse."""

from __future__ import annotations

from types import SimpleNamespace

import bpy
import numpy as np
import pytest

from convwass_addon.applications.palettes.lab_colors import lab_of_linear, linear_of_srgb, srgb_of_linear
from convwass_addon.applications.palettes.lookup_table import read_cube
from convwass_addon.applications.palettes.palette_settings import RecolorSettings
from convwass_addon.bridge.element_values import element_values
from convwass_addon.bridge.files.image_files import pixel_values
from convwass_addon.bridge.handles import Handle
from convwass_addon.bridge.palettes.grade_nodes import grade_group
from convwass_addon.bridge.palettes.image_kinds import RESULT_OF
from convwass_addon.errors import Cancelled
from convwass_addon.operators.recolor_grade import CONVWASS_OT_write_cube
from convwass_addon.operators.recolor_image import CONVWASS_OT_recolor_image, RecolorJob
from convwass_addon.operators.recolor_table import CubeFile, TableJob
from convwass_addon.operators.recolor_targets import read_pictures, shown_image
from tests.controls import ConditionalControl
from tests.linked_objects import linked_object
from tests.operators.running import Pressed, call, inventory, started, until, window_context
from tests.pictures import SIZE, blue_image, image_of, mean_lab, pixels_in, red_image

pytestmark = pytest.mark.usefixtures("empty_scene")


@pytest.fixture
def own():
    found = bpy.context.scene.convwass_recolor
    found.palette = blue_image()
    return found


def test_a_new_image_takes_the_palette(own):
    red = red_image()
    before = pixel_values(red)
    assert call("recolor_image", image="Red") == {"FINISHED"}
    result = bpy.data.images["Red recolored"]
    np.testing.assert_allclose(mean_lab(pixel_values(result)), mean_lab(pixel_values(own.palette)), atol=0.6)
    np.testing.assert_array_equal(pixel_values(red), before)
    assert result.packed_file
    known = inventory()
    call("recolor_image", image="Red", strength=0.0)
    assert inventory() == known, "the result is used again"
    np.testing.assert_array_equal(pixel_values(result), before)


def test_renamed_copies_of_results_are_kept(own):
    red_image()
    call("recolor_image", image="Red")
    call("build_grade_nodes", image="Red", cube_size=3)
    image, group = bpy.data.images["Red recolored"].copy(), bpy.data.node_groups["Grade Blue"].copy()
    image.name, group.name, group.nodes[0].label = "A good one", "A good one", "Changed"
    before = pixel_values(image)
    call("recolor_image", image="Red", strength=0.0)
    call("build_grade_nodes", image="Red", cube_size=3)
    np.testing.assert_array_equal(pixel_values(image), before)
    np.testing.assert_array_equal(pixel_values(bpy.data.images["Red recolored"]), pixel_values(bpy.data.images["Red"]))
    assert group.nodes[0].label == "Changed"


def test_results_belong_to_images_whatever_their_names(own):
    red = red_image()
    call("recolor_image", image="Red")
    result = bpy.data.images["Red recolored"]
    before = pixel_values(result)
    red.name = "Old red"
    call("recolor_image", image=red_image().name, strength=0.0)
    np.testing.assert_array_equal(pixel_values(result), before)
    assert shown_image(editor(result)) == red
    call("recolor_image", image="Old red", strength=0.0)
    np.testing.assert_array_equal(pixel_values(result), pixel_values(red))


def test_groups_for_the_compositor_belong_to_images_whatever_their_names(own):
    red = red_image()
    for _ in range(2):
        call("build_grade_nodes", image="Red", cube_size=3)
    (group,) = bpy.data.node_groups
    group.nodes[0].label = "Changed"
    red.name = "Old red"
    call("build_grade_nodes", image=red_image().name, cube_size=3)
    assert group.nodes[0].label == "Changed"
    assert len(bpy.data.node_groups) == 2
    call("build_grade_nodes", image="Old red", cube_size=3)
    assert group.nodes[0].label == ""
    assert len(bpy.data.node_groups) == 2


def test_results_of_earlier_versions_are_known_by_the_names_of_their_images(own):
    red = red_image()
    call("recolor_image", image="Red")
    result = bpy.data.images["Red recolored"]
    result[RESULT_OF] = "Red"
    call("build_grade_nodes", image="Red", cube_size=3)
    (group,) = bpy.data.node_groups
    group["convwass_grade"] = "Grade Blue\nRed"
    call("build_grade_nodes", image="Red", cube_size=3)
    assert list(bpy.data.node_groups) == [group]
    assert shown_image(editor(result)) == red
    call("recolor_image", image="Red", strength=0.0)
    np.testing.assert_array_equal(pixel_values(result), pixel_values(red))


def editor(image):
    """Return the context of an Image Editor."""
    return SimpleNamespace(space_data=SimpleNamespace(type="IMAGE_EDITOR", image=image))


def test_an_image_is_replaced(own):
    red, known = red_image(), len(bpy.data.images)
    call("recolor_image", image="Red", output="REPLACE", lightness="KEEP")
    light, green, blue = mean_lab(pixel_values(red)) - mean_lab(pixel_values(own.palette))
    assert abs(light + 5.0) < 0.6 and abs(green) < 0.6 and abs(blue) < 0.6
    assert len(bpy.data.images) == known


def test_floats_and_bytes_go_together(own):
    pixels = pixel_values(red_image("Bytes"))
    scene = pixels.copy()
    scene[..., :3] = linear_of_srgb(pixels[..., :3])
    red = image_of("Red", scene, as_floats=True)
    call("recolor_image", image="Red", output="REPLACE")
    found = lab_of_linear(pixel_values(red)[..., :3].reshape(-1, 3).T.astype(float)).mean(axis=1)
    np.testing.assert_allclose(found, mean_lab(pixel_values(own.palette)), atol=0.6)


def test_several_palettes_by_their_weights(own):
    red_image()
    own.palette_2 = red_image("Second")
    own.weight, own.weight_2 = 1.0, 3.0
    call("recolor_image", image="Red", output="REPLACE")
    wanted = 0.25 * mean_lab(pixel_values(own.palette)) + 0.75 * mean_lab(pixel_values(own.palette_2))
    np.testing.assert_allclose(mean_lab(pixel_values(bpy.data.images["Red"])), wanted, atol=0.6)


def test_masks(own):
    red = red_image()
    before = pixel_values(red)
    white = np.ones((SIZE[1], SIZE[0], 4))
    white[:, :30, :3] = 0.0
    own.mask = image_of("Mask", white)
    palette = pixel_values(own.palette)
    half = np.ones_like(palette)
    half[:20, :, :3] = 0.0
    own.palette_mask = image_of("Palette Mask", half)
    call("recolor_image", image="Red", output="REPLACE")
    np.testing.assert_array_equal(pixel_values(red)[:, :30], before[:, :30])
    np.testing.assert_allclose(mean_lab(pixel_values(red)[:, 30:]), mean_lab(palette[20:]), atol=0.6)


def test_missing_input_is_reported(own):
    with pytest.raises(RuntimeError, match="Open an image in the Image Editor first"):
        call("recolor_image")
    with pytest.raises(RuntimeError, match="no image named Nobody"):
        call("recolor_image", image="Nobody")
    own.mask = own.palette
    red_image()
    with pytest.raises(RuntimeError, match="The mask Blue has 30 x 40"):
        call("recolor_image", image="Red")
    own.mask = None
    own.weight = 0.0
    with pytest.raises(RuntimeError, match="All weights are zero"):
        call("recolor_image", image="Red")
    own.palette = None
    with pytest.raises(RuntimeError, match="Choose a palette"):
        call("recolor_image", image="Red")


def test_images_without_colors_are_named(own):
    red = red_image()
    own.palette_2 = image_of("Empty", np.zeros((4, 4, 4)))
    with pytest.raises(RuntimeError, match="No pixel of Empty counts: it is transparent"):
        call("recolor_image", image="Red")
    own.palette_2, own.mask = None, image_of("Mask", np.zeros_like(pixel_values(red)))
    with pytest.raises(RuntimeError, match=r"No pixel of Red counts: .* its mask is black"):
        call("recolor_image", image="Red")


def test_a_table_does_the_same(own, tmp_path):
    red = red_image()
    call("write_cube", image="Red", filepath=str(tmp_path / "grade"), cube_size=33)
    table = read_cube(tmp_path / "grade.cube")
    before = np.moveaxis(pixel_values(red)[..., :3], -1, 0)
    call("recolor_image", image="Red", output="REPLACE")
    error = np.abs(np.moveaxis(table.applied(before), 0, -1) - pixel_values(red)[..., :3]) * 255
    assert error.mean() < 0.6 and error.max() < 6.0
    with pytest.raises(RuntimeError, match="Choose a file"):
        call("write_cube", image="Red")
    with pytest.raises(RuntimeError, match=r"Save the file first, since //grade\.cube is relative to it"):
        call("write_cube", image="Red", filepath="//grade.cube")
    with pytest.raises(RuntimeError, match="does not exist"):
        call("write_cube", image="Red", filepath=str(tmp_path / "none" / "grade.cube"))


def test_nothing_happens_if_the_file_browser_is_closed():
    pressed = Pressed(CONVWASS_OT_write_cube)
    pressed.cancel(window_context())
    assert not pressed.reports


def test_a_table_that_is_stopped_while_it_is_written_leaves_the_old_file(own, tmp_path):
    target = tmp_path / "grade.cube"
    target.write_text("old")
    red = red_image()
    pictures = read_pictures(bpy.context, red)
    inner = RecolorJob(Handle.of("images", red), *pictures, RecolorSettings(), ends="map")
    job, written = TableJob(inner, 5, CubeFile(target, "Blue")), []
    control = ConditionalControl(lambda: written)
    with pytest.raises(Cancelled):
        for step in job.steps(control):
            job.write(step)
            written += [step] * (str(step.message) == "Writing the table")
    job.discard()
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == {"grade.cube": "old"}


def test_a_group_for_the_compositor_is_made(own):
    red_image()
    call("build_grade_nodes", image="Red", cube_size=17)
    group = bpy.data.node_groups["Grade Blue"]
    assert group.bl_idname == "CompositorNodeTree"
    image = bpy.data.images["Grade Blue"]
    assert tuple(image.size) == (5 * 17, 4 * 17) and image.packed_file


def test_a_group_takes_the_place_of_the_last_one_for_the_same(own):
    red_image()
    call("build_grade_nodes", image="Red", cube_size=5)
    group = bpy.data.node_groups["Grade Blue"]
    user = bpy.data.node_groups.new("Mine", "CompositorNodeTree")
    node = user.nodes.new("CompositorNodeGroup")
    node.node_tree = group
    link = user.links.new(user.nodes.new("CompositorNodeRGB").outputs[0], node.inputs["Image"])
    known, count = inventory(), len(group.nodes)
    call("build_grade_nodes", image="Red", cube_size=5)
    assert inventory() == known and len(group.nodes) == count
    assert node.node_tree == group and link.is_valid and node.inputs["Image"].is_linked
    call("build_grade_nodes", image="Red", cube_size=9)
    assert inventory() == known and tuple(bpy.data.images["Grade Blue"].size) == (3 * 9, 3 * 9)
    call("build_grade_nodes", image="Blue", cube_size=5)
    assert len(bpy.data.node_groups) == 3


def test_the_palette_that_has_a_weight_gives_the_name(own):
    red_image()
    own.weight = 0.0
    own.palette_2, own.weight_2 = image_of("Other", pixel_values(bpy.data.images["Blue"])), 1.0
    call("build_grade_nodes", image="Red", cube_size=5)
    assert [group.name for group in bpy.data.node_groups] == ["Grade Other"]


@pytest.mark.parametrize("operator", ["recolor_image", "build_grade_nodes"])
def test_names_are_those_of_the_beginning(own, operator):
    """Choices made while the job runs do not affect its messages and results."""
    red_image()
    context = window_context()
    context.space_data = None
    pressed = Pressed(getattr(bpy.types, f"CONVWASS_OT_{operator}"), image="Red")
    assert started(pressed, context)
    own.palette = image_of("Later", pixel_values(bpy.data.images["Blue"]))
    assert until(pressed, context) == {"FINISHED"}
    told = " ".join(text for _, text in pressed.reports)
    assert "Blue" in told and "Later" not in told


def test_the_compositor_applies_tables_unchanged(own, tmp_path):
    """Rendered: random colors, colors over white, and half transparent ones."""
    red_image()
    call("write_cube", image="Red", filepath=str(tmp_path / "a.cube"), cube_size=9)
    table = read_cube(tmp_path / "a.cube")
    straight = np.ones((16, 16, 4), np.float32)
    straight[..., :3] = np.random.default_rng(0).random((16, 16, 3)) * 1.2
    straight[8:, :, 3] = 0.5
    scene = straight.copy()
    scene[..., :3] = linear_of_srgb(straight[..., :3]) * straight[..., 3:]
    image = image_of("In", scene, as_floats=True)
    found = _composited(grade_group(table, "Grade"), image, tmp_path / "out.exr")
    inside = np.clip(straight[..., :3], 0, 1)
    wanted = np.moveaxis(table.applied(np.moveaxis(inside, -1, 0)), 0, -1) + straight[..., :3] - inside
    encoded = srgb_of_linear(found[..., :3] / found[..., 3:])
    assert np.abs(encoded - wanted).max() < 0.1 / 255
    np.testing.assert_allclose(found[..., 3], straight[..., 3], atol=1e-6)


def _composited(group, image, path):
    scene = bpy.context.scene
    if bpy.app.version >= (5, 0):
        tree = bpy.data.node_groups.new("Compositing", "CompositorNodeTree")
        scene.compositing_node_group = tree
        tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
        end = tree.nodes.new("NodeGroupOutput").inputs[0]
    else:
        scene.use_nodes = True
        tree = scene.node_tree
        tree.nodes.clear()
        end = tree.nodes.new("CompositorNodeComposite").inputs[0]
    source, node = tree.nodes.new("CompositorNodeImage"), tree.nodes.new("CompositorNodeGroup")
    source.image, node.node_tree = image, group
    tree.links.new(source.outputs[0], node.inputs[0])
    tree.links.new(node.outputs[0], end)
    scene.camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(scene.camera)
    render = scene.render
    render.engine, scene.cycles.samples = "CYCLES", 1
    render.resolution_x, render.resolution_y = image.size
    render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
    render.image_settings.color_mode = "RGBA"
    render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    return pixels_in(path)


def _colored(name, mean, seed):
    bpy.ops.mesh.primitive_uv_sphere_add()
    obj = bpy.context.object
    obj.name = name
    attribute = obj.data.color_attributes.new("Col", "FLOAT_COLOR", "POINT")
    colors = np.ones((len(attribute.data), 4), np.float32)
    colors[:, :3] = np.asarray(mean) + np.random.default_rng(seed).uniform(-0.05, 0.05, (len(colors), 3))
    attribute.data.foreach_set("color", colors.ravel())
    obj.data.color_attributes.active_color_name = "Col"
    return obj


def _mean(obj, name):
    data = obj.data.color_attributes[name].data
    return element_values(data, "color", 4)[:, :3].mean(axis=0)


def test_attributes_take_the_palette_of_others(own):
    own.palette_object = _colored("Giver", (0.1, 0.3, 0.5), 1)
    obj = _colored("Receiver", (0.4, 0.2, 0.2), 2)
    assert call("recolor_attribute") == {"FINISHED"}
    np.testing.assert_allclose(_mean(obj, "Recolored"), (0.1, 0.3, 0.5), atol=0.02)
    np.testing.assert_allclose(_mean(obj, "Col"), (0.4, 0.2, 0.2), atol=0.02)
    obj.data.color_attributes.active_color_name = "Col"
    call("recolor_attribute", result="Col", strength=0.5)
    assert (np.abs(_mean(obj, "Col") - (0.25, 0.25, 0.35)) < 0.06).all()


def test_attributes_of_linked_objects_are_read_and_not_written(own, tmp_path):
    _colored("Linked", (0.1, 0.3, 0.5), 1)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "library.blend"))
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    linked, obj = linked_object(tmp_path / "library.blend", "Linked"), _colored("Local", (0.4, 0.2, 0.2), 2)
    settings = bpy.context.scene.convwass_recolor
    settings.palette_object = linked
    assert call("recolor_attribute") == {"FINISHED"}
    settings.palette_object = obj
    bpy.context.view_layer.objects.active = linked
    with pytest.raises(RuntimeError, match="is linked from another file and cannot be changed here"):
        call("recolor_attribute")
    assert linked.data.color_attributes.keys() == ["Col"]


def test_a_result_without_a_name_is_refused_before_the_work(own, monkeypatch):
    own.palette_object = _colored("Giver", (0.1, 0.3, 0.5), 1)
    _colored("Receiver", (0.4, 0.2, 0.2), 2)
    monkeypatch.setattr(RecolorJob, "steps", lambda *args: pytest.fail("it has begun"))
    with pytest.raises(RuntimeError, match="Name the color attribute of the result"):
        call("recolor_attribute", result="")


def test_objects_without_colors_are_refused(own):
    obj = _colored("Receiver", (0.4, 0.2, 0.2), 2)
    with pytest.raises(RuntimeError, match="Choose an object"):
        call("recolor_attribute")
    own.palette_object = _colored("Giver", (0.1, 0.3, 0.5), 1)
    bpy.context.view_layer.objects.active = obj
    bpy.ops.object.mode_set(mode="EDIT")
    with pytest.raises(RuntimeError, match="Edit Mode"):
        call("recolor_attribute")
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.ops.mesh.primitive_cube_add()
    with pytest.raises(RuntimeError, match="Select a mesh with a color attribute"):
        call("recolor_attribute")


@pytest.mark.parametrize("ends", [{"FINISHED"}, {"CANCELLED"}])
def test_in_the_background(own, ends):
    red_image()
    known, drawn = inventory(), []
    context = window_context()
    sidebar = SimpleNamespace(type="UI", tag_redraw=lambda: drawn.append("sidebar"))
    context.window.screen.areas.append(
        SimpleNamespace(type="IMAGE_EDITOR", regions=[sidebar], tag_redraw=lambda: drawn.append("end"))
    )
    context.space_data = None
    pressed = Pressed(CONVWASS_OT_recolor_image, image="Red")
    assert started(pressed, context)
    context.window_manager.convwass_progress.stopping = ends == {"CANCELLED"}
    assert until(pressed, context) == ends
    assert drawn[0] == "sidebar" and drawn[-1] == "end"
    assert ("Red recolored" in bpy.data.images) == (ends == {"FINISHED"})
    if ends == {"CANCELLED"}:
        assert inventory() == known
    assert not context.window_manager.convwass_progress.running
