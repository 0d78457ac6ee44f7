# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Blending materials: results, keys, and refused input, with coarse lobes."""

from __future__ import annotations

import bpy
import numpy as np
import pytest

from convwass_addon.applications.reflectance.lobe_lookup import HEIGHT
from convwass_addon.applications.reflectance.table_files import read_table
from convwass_addon.bridge.keyframes import curves_of
from convwass_addon.bridge.reflectance.lobe_images import read_lobe_exr
from convwass_addon.bridge.reflectance.lobe_nodes import BLEND, DIRECTION, GROUP, LIGHT, STRENGTH
from convwass_addon.operators.reflectance_blend import CONVWASS_OT_blend_materials
from convwass_addon.operators.reflectance_import import CONVWASS_OT_import_lobes
from convwass_addon.properties.light import sun_of
from tests.lights import coarse_lobes, only, principled
from tests.operators.running import ESCAPE, TIMER, Pressed, inventory, started, window_context

pytestmark = pytest.mark.usefixtures("empty_scene", "coarse_tables")

ROWS = 8


def blend(**arguments):
    return bpy.ops.convwass.blend_materials(**{"materials": "A, B", "detail": ROWS, "blends": 3} | arguments)


@pytest.fixture(scope="module")
def coarse_tables():
    with coarse_lobes():
        yield


@pytest.fixture
def metals(empty_scene):
    return principled("A", 0.4, base_color=(1, 0, 0, 1)), principled("B", 0.7, base_color=(0, 0, 1, 1))


@pytest.fixture
def sun(empty_scene):
    light = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    empty_scene.collection.objects.link(light)
    return light


@pytest.mark.usefixtures("metals")
def test_a_path_makes_both_materials_and_keys_them(sun):
    assert blend(frame_start=10, frame_end=30, detail=16) == {"FINISHED"}
    shown, fitted = bpy.data.materials["Blend A-B"], bpy.data.materials["Blend A-B fitted"]
    for material in (shown, fitted):
        bpy.ops.mesh.primitive_plane_add()
        bpy.context.object.data.materials.append(material)
    scene, node, seen = bpy.context.scene, only(fitted, "BSDF_PRINCIPLED"), []
    for frame in (10, 20, 30):
        scene.frame_set(frame)
        seen.append((shown.node_tree.nodes[GROUP].inputs[BLEND].default_value, node.inputs["Roughness"].default_value))
    np.testing.assert_allclose([value for value, _ in seen], [0.0, 0.5, 1.0], atol=1e-6)
    # Rows of five degrees: the ends come back to a few percent, and lie in order.
    rough = [value for _, value in seen]
    np.testing.assert_allclose(rough[::2], (0.4, 0.7), rtol=0.08)
    assert rough[0] < rough[1] < rough[2]
    # Half-way alpha is the mean, not the roughness.
    assert rough[1] ** 2 == pytest.approx((rough[0] ** 2 + rough[2] ** 2) / 2, rel=0.1)
    np.testing.assert_allclose(list(node.inputs["Base Color"].default_value)[:3], (0, 0, 1), atol=1e-6)
    assert shown.node_tree.animation_data.drivers.find(f"{node_path(shown)}.inputs[1].default_value", index=0)
    assert sun.name == "Sun"


def node_path(material):
    return material.node_tree.nodes[GROUP].path_from_id()


@pytest.mark.usefixtures("metals", "sun")
def test_the_same_blend_again_leaves_nothing_behind():
    blend()
    before = inventory()
    assert blend(blends=4) == {"FINISHED"}
    assert {name for kind, name in before[0] if kind == "ACTION"} == {"Blend A-BAction", "Blend A-B fittedAction"}
    assert inventory() == before


@pytest.mark.usefixtures("metals")
@pytest.mark.parametrize("blends", [3, 4])
def test_edited_nodes_stay_when_materials_are_blended_again(blends):
    blend(blends=3, frame_start=1, frame_end=5)
    shown, fitted = bpy.data.materials["Blend A-B"].node_tree, bpy.data.materials["Blend A-B fitted"].node_tree
    direction, group = shown.nodes[GROUP].inputs[DIRECTION], shown.nodes[GROUP].node_tree
    direction.default_value = (1, 0, 0)
    shown.nodes[GROUP].location.x = -777.0
    glow = next(node for node in group.nodes if node.type == "EMISSION")
    glow.label = "Brighter"
    mine = group.nodes.new("ShaderNodeTexImage")
    mine.image = bpy.data.images.new("Mine", 256, 3 * HEIGHT)
    coat = fitted.nodes["Principled BSDF"].inputs["Coat Weight"]
    for frame, value in ((1, 0.0), (9, 1.0)):
        coat.default_value = value
        coat.keyframe_insert("default_value", frame=frame)
    for tree in (shown, fitted):
        output = tree.get_output_node("ALL").inputs["Surface"]
        mix = tree.nodes.new("ShaderNodeMixShader")
        tree.links.new(output.links[0].from_socket, mix.inputs[1])
        tree.links.new(mix.outputs[0], output)
    assert blend(blends=blends, frame_start=11, frame_end=15) == {"FINISHED"}
    for tree, name in ((shown, GROUP), (fitted, "Principled BSDF")):
        (mix,) = (node for node in tree.nodes if node.type == "MIX_SHADER")
        assert tree.get_output_node("ALL").inputs["Surface"].links[0].from_node == mix
        assert mix.inputs[1].links[0].from_node == tree.nodes[name]
    node = shown.nodes[GROUP]
    assert node.inputs[DIRECTION].default_value[:] == (1, 0, 0) and node.location.x == -777.0
    # Another number of blends needs another group.
    assert (node.node_tree == group) == (blends == 3)
    assert mine.image == bpy.data.images["Mine"] and glow.label == "Brighter"
    assert group.use_fake_user or node.node_tree == group
    keys = {tuple(point.co[0] for point in curve.keyframe_points) for curve in curves_of(fitted)}
    between = [*np.linspace(11, 15, blends)]
    assert sorted(keys) == [(1.0, 9.0), pytest.approx(between)]
    (own,) = (curve for curve in curves_of(fitted) if curve.keyframe_points[0].co[0] == 1.0)
    assert own.keyframe_points[0].interpolation == "BEZIER"
    assert {round(point.co[0]) for curve in curves_of(shown) for point in curve.keyframe_points} >= {11, 15}
    assert min(point.co[0] for curve in curves_of(shown) for point in curve.keyframe_points) == 11


@pytest.mark.usefixtures("metals")
def test_added_nodes_stay_although_the_own_ones_were_deleted():
    blend(output="FITTED")
    tree = bpy.data.materials["Blend A-B fitted"].node_tree
    tree.nodes.remove(tree.nodes["Principled BSDF"])
    glass, noise = tree.nodes.new("ShaderNodeBsdfGlass"), tree.nodes.new("ShaderNodeTexNoise")
    tree.links.new(noise.outputs[0], glass.inputs["Roughness"])
    names = {node.name for node in tree.nodes}
    assert blend(output="FITTED") == {"FINISHED"}
    assert {node.name for node in tree.nodes} == names | {"Principled BSDF"}
    assert glass.inputs["Roughness"].links[0].from_node == noise
    assert tree.get_output_node("ALL").inputs["Surface"].links[0].from_node == tree.nodes["Principled BSDF"]


@pytest.mark.usefixtures("metals")
def test_a_shader_that_the_user_shows_instead_stays():
    blend(output="BOTH")
    trees = [bpy.data.materials[name].node_tree for name in ("Blend A-B", "Blend A-B fitted")]
    for tree, own in zip(trees, (GROUP, "Principled BSDF"), strict=True):
        tree.nodes.remove(tree.nodes[own])
        glass = tree.nodes.new("ShaderNodeBsdfGlass")
        tree.links.new(glass.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
    assert blend(output="BOTH") == {"FINISHED"}
    for tree in trees:
        assert tree.get_output_node("ALL").inputs["Surface"].links[0].from_node.type == "BSDF_GLASS"


@pytest.mark.usefixtures("metals")
def test_nodes_of_earlier_versions_are_replaced():
    blend(output="FITTED")
    material = bpy.data.materials["Blend A-B fitted"]
    material.pop("convwass_keeps_nodes", None)
    for node in material.node_tree.nodes:
        node.pop("convwass_lobes", None)
    assert blend(output="FITTED") == {"FINISHED"}
    assert len(material.node_tree.nodes) == 2


@pytest.mark.usefixtures("metals")
def test_a_blend_no_longer_follows_a_sun_that_was_deleted(sun):
    blend(output="LOBES")
    tree = bpy.data.materials["Blend A-B"].node_tree
    assert len(tree.animation_data.drivers) == 7
    bpy.data.objects.remove(sun)
    assert blend(output="LOBES") == {"FINISHED"}
    assert not len(tree.animation_data.drivers)


def drivers_of(socket):
    path = socket.path_from_id("default_value")
    return [curve for curve in socket.id_data.animation_data.drivers if curve.data_path == path]


@pytest.mark.usefixtures("metals")
@pytest.mark.parametrize("blends", [3, 4])
def test_what_users_change_of_a_light_that_follows_a_sun_stays(sun, blends):
    blend(output="LOBES")
    node = bpy.data.materials["Blend A-B"].node_tree.nodes[GROUP]
    direction, strength, light = (node.inputs[name] for name in (DIRECTION, STRENGTH, LIGHT))
    direction.driver_remove("default_value")
    direction.default_value = (1, 0, 0)
    (curve,) = drivers_of(strength)
    curve.driver.variables[0].targets[0].data_path = "location.x"
    light.driver_remove("default_value", 1)
    light.default_value[1] = 0.125
    other = bpy.data.objects.new("Other", bpy.data.lights.new("Other", "SUN"))
    bpy.context.scene.collection.objects.link(other)
    bpy.context.scene.convwass_reflectance.sun = other
    assert blend(output="LOBES", blends=blends) == {"FINISHED"}
    direction, strength, light = (node.inputs[name] for name in (DIRECTION, STRENGTH, LIGHT))
    assert direction.default_value[:] == (1, 0, 0) and not drivers_of(direction)
    target = drivers_of(strength)[0].driver.variables[0].targets[0]
    assert (target.id, target.data_path) == (sun, "location.x")
    assert light.default_value[1] == 0.125
    found = {curve.array_index: curve.driver.variables[0].targets[0].id for curve in drivers_of(light)}
    assert found == {0: other, 2: other}
    for own in (sun, other):
        bpy.data.objects.remove(own)
    assert blend(output="LOBES") == {"FINISHED"}
    assert len(drivers_of(node.inputs[STRENGTH])) == 1
    assert len(node.id_data.animation_data.drivers) == 1


@pytest.mark.usefixtures("metals")
def test_a_light_as_it_was_made_or_left_follows_the_next_sun():
    for energy in (3.0, 5.0):
        assert blend(output="LOBES") == {"FINISHED"}
        light = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
        light.data.energy = energy
        bpy.context.scene.collection.objects.link(light)
        assert blend(output="LOBES") == {"FINISHED"}
        tree = bpy.data.materials["Blend A-B"].node_tree
        assert len(tree.animation_data.drivers) == 7
        bpy.context.view_layer.update()
        bpy.data.objects.remove(light)


@pytest.mark.usefixtures("metals")
def test_a_blend_whose_group_was_removed_gets_another():
    blend(output="LOBES")
    node = bpy.data.materials["Blend A-B"].node_tree.nodes[GROUP]
    bpy.data.node_groups.remove(node.node_tree)
    assert blend(output="LOBES") == {"FINISHED"}
    assert DIRECTION in node.inputs


@pytest.mark.usefixtures("metals")
def test_groups_that_were_not_edited_are_replaced():
    for blends in (3, 3, 4):
        blend(blends=blends, output="LOBES")
    assert [group.use_fake_user for group in bpy.data.node_groups] == [False]


@pytest.mark.parametrize("has_other", [False, True])
def test_a_chosen_light_that_is_no_sun_any_more_is_not_followed(sun, has_other):
    settings = bpy.context.scene.convwass_reflectance
    settings.sun = sun
    assert sun_of(bpy.context) == sun
    other = bpy.data.objects.new("Other", bpy.data.lights.new("Other", "SUN")) if has_other else None
    if has_other:
        bpy.context.scene.collection.objects.link(other)
    sun.data.type = "POINT"
    assert sun_of(bpy.context) == other


@pytest.mark.usefixtures("metals")
def test_weights_make_one_still_material():
    assert blend(blend="WEIGHTS", weights="1, 3") == {"FINISHED"}
    shown, fitted = (bpy.data.materials[f"Blend A-B 25:75{end}"] for end in ("", " fitted"))
    assert shown.node_tree.animation_data is None
    assert fitted.node_tree.animation_data is None
    group = shown.node_tree.nodes[GROUP]
    assert {item.name for item in group.inputs} >= {DIRECTION}
    image = next(node.image for node in group.node_tree.nodes if node.type == "TEX_IMAGE")
    assert tuple(image.size) == (256, HEIGHT)
    assert image.packed_file is not None
    color = list(only(fitted, "BSDF_PRINCIPLED").inputs["Base Color"].default_value)[:3]
    np.testing.assert_allclose(color, (0.25, 0, 0.75), atol=1e-6)


@pytest.mark.usefixtures("metals")
def test_the_materials_of_the_panel_are_the_default():
    own = bpy.context.scene.convwass_reflectance
    own.material, own.material_2 = bpy.data.materials["A"], bpy.data.materials["B"]
    own.weight_2 = 0.0
    assert blend(materials="", blend="WEIGHTS", output="FITTED") == {"FINISHED"}
    assert "Blend A-B 100:0 fitted" in bpy.data.materials
    assert not bpy.data.node_groups


def test_materials_with_a_grain_are_fitted_only():
    principled("A", 0.6, anisotropic=0.9)
    principled("B", 0.6, anisotropic=0.9, anisotropic_rotation=0.25)
    assert blend(blend="WEIGHTS", detail=8) == {"FINISHED"}
    assert "Blend A-B 50:50 fitted" in bpy.data.materials
    assert "Blend A-B 50:50" not in bpy.data.materials
    with pytest.raises(RuntimeError, match="Anisotropic highlights"):
        blend(output="LOBES")


@pytest.mark.usefixtures("metals")
def test_the_table_is_written_and_can_be_imported(tmp_path):
    blend(table=str(tmp_path / "a.exr"), output="LOBES")
    assert len(read_lobe_exr(tmp_path / "a.exr")) == 3
    blend(table=str(tmp_path / "b.npz"), blend="WEIGHTS", output="FITTED")
    assert read_table(tmp_path / "b.npz").rows == ROWS
    blend(table=str(tmp_path / "d.lobes.exr"), blend="WEIGHTS", output="FITTED")
    for name in ("a.exr", "b.npz", "d.lobes.exr"):
        assert bpy.ops.convwass.import_lobes(filepath=str(tmp_path / name)) == {"FINISHED"}
        assert GROUP in bpy.data.materials[name.rpartition(".")[0]].node_tree.nodes
    with pytest.raises(RuntimeError, match="There is no file"):
        bpy.ops.convwass.import_lobes(filepath=str(tmp_path / "c.exr"))
    with pytest.raises(RuntimeError, match="Choose a file to read"):
        bpy.ops.convwass.import_lobes(filepath="")
    with pytest.raises(RuntimeError, match="Save the file first"):
        bpy.ops.convwass.import_lobes(filepath="//a.exr")


@pytest.mark.usefixtures("metals")
def test_tables_of_the_same_name_are_materials_of_their_own(tmp_path):
    (tmp_path / "other").mkdir()
    files = [tmp_path / "Blend A-B.exr", tmp_path / "other" / "Blend A-B.exr"]
    for file in files:
        blend(table=str(file), output="LOBES")
    blended = bpy.data.materials["Blend A-B"]
    for _ in range(2):
        for file in files:
            assert bpy.ops.convwass.import_lobes(filepath=str(file)) == {"FINISHED"}
    made = [material for material in bpy.data.materials if material.name.startswith("Blend A-B")]
    assert len(made) == 3 and blended in made


@pytest.mark.usefixtures("metals")
def test_a_renamed_copy_of_a_blend_is_kept():
    blend(output="LOBES")
    copy = bpy.data.materials["Blend A-B"].copy()
    copy.name, copy.node_tree.nodes[GROUP].label = "Armor", "Changed"
    blend(output="LOBES")
    assert copy.node_tree.nodes[GROUP].label == "Changed"


def test_the_cursor_shows_that_blender_is_busy_and_is_restored():
    context, cursors = window_context(), []
    context.window.cursor_modal_set = cursors.append
    context.window.cursor_modal_restore = lambda: cursors.append("own")
    pressed = Pressed(CONVWASS_OT_import_lobes, filepath="/nowhere/a.binary")
    assert pressed.execute(context) == {"CANCELLED"}
    assert cursors == ["WAIT", "own"]


@pytest.mark.usefixtures("metals")
@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"materials": "A"}, "Choose two to four"),
        ({"materials": "A, C"}, "There is no material named C"),
        ({"blend": "WEIGHTS", "weights": "1"}, "one weight for each"),
        ({"blend": "WEIGHTS", "weights": "1, x"}, "Weights must be numbers"),
        ({"blend": "WEIGHTS", "weights": "1, 0; 0, 1"}, "Weights must be numbers"),
        ({"frame_start": 5, "frame_end": 5}, "must come after"),
        ({"table": "/tmp/x.png"}, "does not end in"),
        ({"table": "//x.exr"}, "Save the file first"),
        ({"table": "/tmp/x.npz"}, "one blend"),
        ({"table": "/tmp/x.lobes.exr"}, "one blend"),
    ],
)
def test_invalid_input_is_refused_and_changes_nothing(arguments, message):
    before = {block.name for block in bpy.data.materials}
    with pytest.raises(RuntimeError, match=message):
        blend(**arguments)
    assert {block.name for block in bpy.data.materials} == before


@pytest.mark.usefixtures("metals")
def test_escape_leaves_nothing_behind():
    pressed, window = Pressed(CONVWASS_OT_blend_materials, materials="A, B", detail=32), window_context()
    assert started(pressed, window)
    pressed.modal(window, TIMER)
    while (result := pressed.modal(window, ESCAPE)) == {"PASS_THROUGH"}:
        pass
    assert result == {"CANCELLED"}
    assert pressed.reports[-1] == ("INFO", "Stopped; nothing was changed")
    assert sorted(block.name for block in bpy.data.materials) == ["A", "B"]


@pytest.fixture
def three(metals, empty_scene):
    own = empty_scene.convwass_reflectance
    third = principled("C", 0.5, base_color=(0, 1, 0, 1))
    own.material, own.material_2, own.material_3 = *metals, third
    return own


def test_keyed_weights_are_followed(three):
    for frame, weights in ((1, (1, 0, 0)), (11, (0, 0, 1)), (21, (0, 1, 0))):
        for name, weight in zip(("weight", "weight_2", "weight_3"), weights, strict=True):
            setattr(three, name, weight)
            three.id_data.keyframe_insert(f"convwass_reflectance.{name}", frame=frame)
    arguments = {"materials": "", "blend": "KEYED", "frame_start": 1, "frame_end": 21}
    assert blend(**arguments, output="FITTED") == {"FINISHED"}
    fitted = bpy.data.materials["Blend A-B-C fitted"]
    bpy.ops.mesh.primitive_plane_add()
    bpy.context.object.data.materials.append(fitted)
    for frame, color in ((1, (1, 0, 0)), (11, (0, 1, 0)), (16, (0, 0.5, 0.5)), (21, (0, 0, 1))):
        bpy.context.scene.frame_set(frame)
        found = list(only(fitted, "BSDF_PRINCIPLED").inputs["Base Color"].default_value)[:3]
        np.testing.assert_allclose(found, color, atol=1e-6)


@pytest.mark.usefixtures("three")
def test_a_way_of_weights_needs_no_keys():
    assert blend(materials="", blend="KEYED", weights="1,0,0; 0,1,1", output="FITTED") == {"FINISHED"}
    with pytest.raises(RuntimeError, match="No weight is keyed"):
        blend(materials="", blend="KEYED")
    with pytest.raises(RuntimeError, match="two stops"):
        blend(materials="", blend="KEYED", weights="1,0,0")
    with pytest.raises(RuntimeError, match="same number"):
        blend(materials="", blend="KEYED", weights="1,0,0; 1,0")


@pytest.mark.usefixtures("three")
@pytest.mark.parametrize("blends", [2, 3])
def test_edited_nodes_of_a_pad_stay_when_materials_are_blended_again(blends):
    blend(materials="", blend="PAD", blends=2)
    tree = bpy.data.materials["Blend A-B-C on a pad fitted"].node_tree
    shader = tree.nodes["Principled BSDF"]
    color = shader.inputs["Base Color"].links[0].from_node
    hue = tree.nodes.new("ShaderNodeHueSaturation")
    tree.links.new(color.outputs["Color"], hue.inputs["Color"])
    tree.links.new(hue.outputs["Color"], shader.inputs["Base Color"])
    tree.links.remove(shader.inputs["Metallic"].links[0])
    count = len(tree.nodes)
    assert blend(materials="", blend="PAD", blends=blends) == {"FINISHED"}
    assert len(tree.nodes) == count and len(tree.animation_data.drivers) == 2
    assert shader.inputs["Base Color"].links[0].from_node == hue
    assert hue.inputs["Color"].links[0].from_node == color
    assert not shader.inputs["Metallic"].is_linked and shader.inputs["Roughness"].is_linked
    side = color.image.size[0]
    assert (side > 2) == (blends > 2)
    scaled = color.inputs["Vector"].links[0].from_node.inputs["X"].links[0].from_node
    assert scaled.inputs[1].default_value == pytest.approx((side - 1) / side)


@pytest.mark.usefixtures("three")
def test_a_deleted_node_of_a_pad_is_linked_again():
    blend(materials="", blend="PAD", blends=2)
    names = {"": GROUP, " fitted": "Principled BSDF"}
    trees = {own: bpy.data.materials[f"Blend A-B-C on a pad{end}"].node_tree for end, own in names.items()}

    def linked():
        return [{socket.name for socket in tree.nodes[own].inputs if socket.is_linked} for own, tree in trees.items()]

    before = linked()
    assert all(before)
    for own, tree in trees.items():
        tree.nodes.remove(tree.nodes[own])
    assert blend(materials="", blend="PAD", blends=2) == {"FINISHED"}
    assert linked() == before


@pytest.mark.usefixtures("three")
def test_a_pad_drives_both_materials():
    assert blend(materials="", blend="PAD", blends=2) == {"FINISHED"}
    for material in ("Blend A-B-C on a pad", "Blend A-B-C on a pad fitted"):
        assert len(bpy.data.materials[material].node_tree.animation_data.drivers) == 2
    before = sorted(block.name for block in (*bpy.data.objects, *bpy.data.images, *bpy.data.node_groups))
    assert blend(materials="", blend="PAD", blends=2, detail=8) == {"FINISHED"}
    assert sorted(block.name for block in (*bpy.data.objects, *bpy.data.images, *bpy.data.node_groups)) == before
    with pytest.raises(RuntimeError, match="three or four materials, not 2"):
        blend(materials="A, B", blend="PAD")
    with pytest.raises(RuntimeError, match="2 to 16"):
        blend(materials="", blend="PAD", blends=17)
