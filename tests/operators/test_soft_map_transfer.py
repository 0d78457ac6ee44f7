# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Transfers along known maps: to the closest points of coinciding spheres."""

from __future__ import annotations

import time

import bpy
import numpy as np
import pytest

from convwass_addon.bridge.element_values import element_values
from convwass_addon.bridge.vertex_groups import read_group, write_group
from convwass_addon.operators import soft_map_transfer
from convwass_addon.operators.soft_map_transfer import CONVWASS_OT_transfer_by_map
from convwass_addon.progress import Progress
from convwass_addon.sentence import Sentence
from tests.operators.running import ESCAPE, Pressed, call, inventory, pretend_window, until, window_context
from tests.operators.soft_maps import choose, points, sphere, store_closest, store_mirror

pytestmark = pytest.mark.usefixtures("empty_scene")


@pytest.fixture
def pair():
    """A sphere and a finer one, with the map between them."""
    giver, receiver = sphere("Cow"), sphere("Horse", segments=40, ring_count=24)
    store_closest(giver, receiver)
    return giver, receiver


def paint(obj, **weights):
    for name, values in weights.items():
        write_group(obj, name, values)


def halves(obj):
    """Weights of two groups that sum to 1, from the left to the right."""
    share = np.clip((points(obj)[:, 0] + 1) / 2, 0, 1)
    return {"Left": 1 - share, "Right": share}


def test_unknown_names_are_refused(pair):
    giver, receiver = pair
    paint(giver, **halves(giver))
    giver.data.uv_layers[0].name = "Map"
    with pytest.raises(RuntimeError, match="Cow has no Rihgt to transfer; it has: Left, Map, Right"):
        call("transfer_by_map", what={"GROUPS", "UVS"}, names="Left, Map, Rihgt")
    assert receiver.vertex_groups.keys() == []
    assert call("transfer_by_map", what={"GROUPS", "UVS"}, names="Left, Map") == {"FINISHED"}
    assert receiver.vertex_groups.keys() == ["Left"]


def test_names_may_begin_and_end_with_spaces(pair):
    giver, receiver = pair
    weights = halves(giver)
    paint(giver, **{" Left ": weights["Left"], "Right": weights["Right"]})
    assert call("transfer_by_map", names=" Left ,  Right") == {"FINISHED"}
    assert receiver.vertex_groups.keys() == [" Left ", "Right"]


def add_armature(obj, *names):
    armature = bpy.data.objects.new("Armature", bpy.data.armatures.new("Armature"))
    bpy.context.collection.objects.link(armature)
    bpy.context.view_layer.objects.active = armature
    bpy.ops.object.mode_set(mode="EDIT")
    for name in names:
        armature.data.edit_bones.new(name).tail = (0, 0, 1)
    bpy.ops.object.mode_set(mode="OBJECT")
    obj.modifiers.new("Armature", "ARMATURE").object = armature


@pytest.mark.parametrize("direction", ["FORWARD", "BACKWARD"])
def test_weights_go_either_way(pair, direction):
    giver, receiver = pair if direction == "FORWARD" else pair[::-1]
    paint(giver, **halves(giver))
    assert call("transfer_by_map", direction=direction) == {"FINISHED"}
    assert receiver.vertex_groups.keys() == ["Left", "Right"]
    for name, expected in halves(receiver).items():
        np.testing.assert_allclose(read_group(receiver, name), expected, atol=0.01)
    assert receiver.data.validate() is False


def test_a_map_serves_the_swapped_objects_too(pair):
    paint(pair[1], **halves(pair[1]))
    call("swap_map_objects")
    call("transfer_by_map")
    np.testing.assert_allclose(read_group(pair[0], "Right"), halves(pair[0])["Right"], atol=0.01)


def test_weights_of_bones_are_limited_and_sum_to_one(pair):
    giver, receiver = pair
    across = points(giver)
    weights = {f"Bone{k}": np.exp(-np.sum((across - across[k * 60]) ** 2, axis=1)) for k in range(6)}
    paint(giver, Mask=np.full(len(across), 0.5), **weights)
    add_armature(giver, *weights)
    call("transfer_by_map", limit=3)
    found = np.stack([read_group(receiver, name) for name in weights])
    np.testing.assert_allclose(found.sum(axis=0), 1.0, atol=1e-5)
    assert (found > 0).sum(axis=0).max() == 3
    np.testing.assert_allclose(read_group(receiver, "Mask"), 0.5, atol=1e-5)
    call("transfer_by_map", limit=0, normalize=False)
    found = np.stack([read_group(receiver, name) for name in weights])
    assert (found > 0).sum(axis=0).max() == 6
    sums = sum(weights.values())
    assert found.sum(axis=0).max() == pytest.approx(sums.max(), rel=0.02)


def test_locked_groups_stay_and_leave_the_rest(pair, capfd):
    giver, receiver = pair
    paint(giver, **halves(giver))
    add_armature(giver, "Left", "Right", "Other")
    paint(receiver, Left=np.full(len(receiver.data.vertices), 0.25), Other=np.full(len(receiver.data.vertices), 0.5))
    receiver.vertex_groups["Left"].lock_weight = True
    assert call("transfer_by_map") == {"FINISHED"}
    np.testing.assert_allclose(read_group(receiver, "Left"), 0.25)
    np.testing.assert_allclose(read_group(receiver, "Other"), 0.5)
    # Half of the giver's average, and never more than what is left.
    right = read_group(receiver, "Right")
    np.testing.assert_allclose(right, np.minimum(halves(receiver)["Right"], 0.75), atol=0.01)
    said = capfd.readouterr().out
    assert "Transferred to Horse: Vertex Groups 1" in said
    assert "Not overwritten: Left" in said


def test_a_part_of_the_groups_keeps_its_share(pair):
    """The weights of one of two bones are not scaled up to 1; the order and the receiver's other groups are kept."""
    giver, receiver = pair
    paint(giver, **halves(giver))
    paint(receiver, Mine=np.full(len(receiver.data.vertices), 0.5))
    call("transfer_by_map", names="Right")
    assert receiver.vertex_groups.keys() == ["Mine", "Right"]
    np.testing.assert_allclose(read_group(receiver, "Right"), halves(receiver)["Right"], atol=0.01)
    np.testing.assert_allclose(read_group(receiver, "Mine"), 0.5)


def test_existing_data_can_be_kept(pair):
    giver, receiver = pair
    paint(giver, **halves(giver))
    paint(receiver, Left=np.full(len(receiver.data.vertices), 0.125))
    call("transfer_by_map", existing="KEEP")
    np.testing.assert_allclose(read_group(receiver, "Left"), 0.125)
    assert "Right" in receiver.vertex_groups


def test_sides_change_their_names(pair):
    giver, receiver = pair
    both = list(halves(giver).values())
    paint(giver, **{"Arm.L": both[0], "Arm.R": both[1]})
    call("transfer_by_map", flip_names=True)
    np.testing.assert_allclose(read_group(receiver, "Arm.R"), halves(receiver)["Left"], atol=0.01)


def test_vertices_without_an_image_keep_their_weights(pair):
    giver, receiver = pair
    receiver.data.vertices.add(1)
    store_closest(giver, receiver)
    paint(giver, **halves(giver))
    paint(receiver, Left=np.full(len(receiver.data.vertices), 0.125))
    call("transfer_by_map")
    assert read_group(receiver, "Left")[-1] == 0.125
    assert read_group(receiver, "Right")[-1] == 0.0


def add_key(obj, name, offsets, relative_to=None):
    if obj.data.shape_keys is None:
        obj.shape_key_add(name="Basis")
    key = obj.shape_key_add(name=name, from_mix=False)
    if relative_to:
        key.relative_key = obj.data.shape_keys.key_blocks[relative_to]
    base = np.array([point.co for point in key.relative_key.data])
    key.data.foreach_set("co", (base + offsets).astype(np.float32).ravel())
    return key


def key_points(obj, name):
    return element_values(obj.data.shape_keys.key_blocks[name].data, "co", 3)


def test_shape_keys_go_into_the_space_of_the_receiver():
    """A swelling of the sphere, on one that is turned, twice as large, and mirrored in its own space."""
    giver = sphere("Cow")
    receiver = sphere("Horse", segments=40, ring_count=24)
    receiver.rotation_euler, receiver.scale = (0.3, 0.5, 0.7), (-0.5, 0.5, 0.5)
    receiver.data.transform(receiver.matrix_basis.inverted().to_3x3().to_4x4())
    receiver.data.flip_normals()
    bpy.context.view_layer.update()
    store_closest(giver, receiver)
    own_points = points(giver)
    add_key(giver, "Swell", own_points * np.maximum(own_points[:, 2:], 0.0)).slider_max = 2.0
    assert call("transfer_by_map", what={"KEYS"}) == {"FINISHED"}
    keys = receiver.data.shape_keys.key_blocks
    assert keys.keys() == ["Basis", "Swell"]
    assert (keys["Swell"].value, keys["Swell"].slider_max) == (0.0, 2.0)
    matrix = np.array(receiver.matrix_world)[:3, :3]
    world = points(receiver) @ matrix.T
    moved = (key_points(receiver, "Swell") - points(receiver)) @ matrix.T
    np.testing.assert_allclose(moved, np.maximum(world[:, 2:], 0.0) * world, atol=0.05)
    assert np.abs(moved[world[:, 2] < -0.1]).max() < 1e-6


def test_shape_keys_that_are_there_keep_all_but_their_shape(pair, capfd):
    giver, receiver = pair
    add_key(giver, "Smile", points(giver) * 0.2)
    add_key(giver, "More", points(giver) * 0.1, relative_to="Smile")
    add_key(giver, "Frown", points(giver) * 0.2)
    before = points(receiver) * 0.05
    add_key(receiver, "Mine", before)
    smile = add_key(receiver, "Smile", before)
    smile.value, smile.mute = 0.5, True
    add_key(receiver, "Follows", before, relative_to="Smile")
    add_key(receiver, "Frown", before).lock_shape = True
    receiver.active_shape_key_index = 1
    call("transfer_by_map", what={"KEYS"})
    assert "Not overwritten: Frown" in capfd.readouterr().out
    blocks = receiver.data.shape_keys.key_blocks
    assert blocks.keys() == ["Basis", "Mine", "Smile", "Follows", "Frown", "More"]
    assert (blocks["Smile"].value, blocks["Smile"].mute, blocks["Smile"].lock_shape) == (0.5, True, False)
    assert blocks["More"].relative_key == blocks["Smile"]
    assert receiver.active_shape_key_index == 1
    rest = points(receiver)
    for name, expected in (("Mine", 1.05), ("Frown", 1.05), ("Smile", 1.2), ("Follows", 1.25), ("More", 1.3)):
        np.testing.assert_allclose(key_points(receiver, name), expected * rest, atol=0.02)


def test_shape_keys_are_computed_without_poses(pair):
    """The giver shows a key and a modifier while it gives; the offsets are those of the key."""
    giver, receiver = pair
    add_key(giver, "Smile", points(giver) * 0.2).value = 1.0
    giver.modifiers.new("Displace", "DISPLACE").strength = 0.5
    call("transfer_by_map", what={"KEYS"})
    np.testing.assert_allclose(key_points(receiver, "Smile"), 1.2 * points(receiver), atol=0.02)


def test_uv_maps_bring_their_seams(pair):
    giver, receiver = pair
    assert giver.data.uv_layers.keys() == ["UVMap"]
    receiver.data.uv_layers.remove(receiver.data.uv_layers[0])
    assert call("transfer_by_map", what={"UVS"}) == {"FINISHED"}
    assert receiver.data.uv_layers.keys() == ["UVMap"]
    uvs = np.empty(2 * len(receiver.data.loops), np.float32)
    receiver.data.uv_layers["UVMap"].uv.foreach_get("vector", uvs)
    uvs = uvs.reshape(-1, 2)
    # No polygon reaches across the texture, but those at the poles that the sphere's own map has so too.
    inner = [polygon for polygon in receiver.data.polygons if abs(polygon.center.z) < 0.95]
    widths = [np.ptp(uvs[list(polygon.loop_indices)], axis=0).max() for polygon in inner]
    assert max(widths) < 0.15
    seams = [edge for edge in receiver.data.edges if edge.use_seam]
    assert len(seams) >= 20
    # Where the height of the texture is that of the sphere.
    loops = np.array([loop.vertex_index for loop in receiver.data.loops])
    height = np.arccos(-points(receiver)[loops, 2].clip(-1, 1)) / np.pi
    assert np.median(np.abs(uvs[:, 1] - height)) < 0.01


def test_too_many_uv_maps_are_refused_immediately(pair):
    giver, receiver = pair
    giver.data.uv_layers[0].name = "Ninth"
    while len(receiver.data.uv_layers) < 8:
        receiver.data.uv_layers.new()
    paint(giver, **halves(giver))
    with pytest.raises(RuntimeError, match="Horse would have 9 UV maps, and Blender allows 8"):
        call("transfer_by_map", what={"UVS", "GROUPS"})
    assert not receiver.vertex_groups


@pytest.mark.parametrize("domain", ["POINT", "CORNER"])
@pytest.mark.parametrize("kind", ["BYTE_COLOR", "FLOAT_COLOR"])
def test_colors_of_every_kind(pair, domain, kind):
    giver, receiver = pair
    attribute = giver.data.color_attributes.new("Paint", kind, domain)
    corners = [loop.vertex_index for loop in giver.data.loops]
    colors = np.c_[(points(giver) + 1) / 2, np.ones(len(giver.data.vertices))].astype(np.float32)
    attribute.data.foreach_set("color", (colors if domain == "POINT" else colors[corners]).ravel())
    call("transfer_by_map", what={"COLORS"})
    made = receiver.data.color_attributes["Paint"]
    assert (made.domain, made.data_type) == ("POINT", kind)
    found = np.array([item.color for item in made.data])
    np.testing.assert_allclose(found[:, :3], (points(receiver) + 1) / 2, atol=0.02)


def test_colors_are_written_to_an_attribute_of_any_domain(pair):
    giver, receiver = pair
    attribute = giver.data.color_attributes.new("Paint", "FLOAT_COLOR", "POINT")
    attribute.data.foreach_set("color", np.full(4 * len(giver.data.vertices), 0.5, np.float32))
    receiver.data.color_attributes.new("Paint", "BYTE_COLOR", "CORNER")
    call("transfer_by_map", what={"COLORS"})
    made = receiver.data.color_attributes["Paint"]
    assert (made.domain, made.data_type) == ("CORNER", "BYTE_COLOR")
    np.testing.assert_allclose([item.color for item in made.data], 0.5, atol=0.01)
    giver.data.color_attributes["Paint"].name = "Taken"
    receiver.vertex_groups.new(name="Taken")
    with pytest.raises(RuntimeError, match="vertex group Taken of another kind"):
        call("transfer_by_map", what={"COLORS"})


def test_hard_edges_of_colors_stay_hard(pair):
    """Colors of corners that jump from face to face are sampled on each face's own side."""
    giver, receiver = pair
    attribute = giver.data.color_attributes.new("Paint", "FLOAT_COLOR", "CORNER")
    for polygon in giver.data.polygons:
        for loop in polygon.loop_indices:
            attribute.data[loop].color = (float(polygon.center.x > 0), 0.0, 0.0, 1.0)
    call("transfer_by_map", what={"COLORS"})
    red = np.array([item.color[0] for item in receiver.data.color_attributes["Paint"].data])
    off = np.abs(points(receiver)[:, 0]) > 1e-3
    np.testing.assert_allclose(red[off], points(receiver)[off, 0] > 0, atol=1e-4)


def test_a_mirror_carries_left_to_right_and_back(empty_scene):
    obj = sphere("Cow")
    store_mirror(obj)
    left = np.clip(points(obj)[:, 0], 0, 1)
    paint(obj, **{"Arm.L": left, "Arm.R": np.zeros(len(left)), "Spine": 1 - left})
    call("transfer_by_map")
    np.testing.assert_allclose(read_group(obj, "Arm.R"), np.clip(-points(obj)[:, 0], 0, 1), atol=1e-3)
    np.testing.assert_allclose(read_group(obj, "Arm.L"), left, atol=1e-6)
    np.testing.assert_allclose(read_group(obj, "Spine"), 1 - left, atol=1e-6)
    write_group(obj, "Arm.L", np.zeros(len(left)))
    call("transfer_by_map", direction="BACKWARD")
    np.testing.assert_allclose(read_group(obj, "Arm.L"), left, atol=1e-3)
    with pytest.raises(RuntimeError, match="Cow cannot receive UV maps or color attributes from itself"):
        call("transfer_by_map", what={"UVS"})
    add_key(obj, "Wink.L", np.c_[left, left, left] * 0.1)
    call("transfer_by_map", what={"KEYS"})
    moved = key_points(obj, "Wink.R") - points(obj)
    expected = np.clip(-points(obj)[:, :1], 0, 1) * (-0.1, 0.1, 0.1)
    np.testing.assert_allclose(moved, expected, atol=0.02)


@pytest.mark.parametrize(
    ("what", "message"),
    [
        ("GROUPS", "Cow has no vertex groups to transfer"),
        ("KEYS", "Cow has no shape keys to transfer besides its basis"),
        ("UVS", "Cow has no UV maps to transfer; unwrap it first"),
        ("COLORS", "Cow has no color attributes to transfer"),
    ],
)
def test_missing_data_is_reported(pair, what, message):
    giver = pair[0]
    giver.data.uv_layers.remove(giver.data.uv_layers[0])
    with pytest.raises(RuntimeError, match=message):
        call("transfer_by_map", what={what})
    with pytest.raises(RuntimeError, match="Choose what to transfer"):
        call("transfer_by_map", what=set())


def test_missing_names_are_reported_with_those_that_exist(pair):
    giver = pair[0]
    paint(giver, **halves(giver))
    add_key(giver, "Tall", points(giver) * 2.0)
    with pytest.raises(RuntimeError, match=r"Cow has no Nope to transfer; it has: Left, Right\."):
        call("transfer_by_map", names="Nope")
    with pytest.raises(RuntimeError, match=r"Cow has no Nope to transfer; it has: Tall\."):
        call("transfer_by_map", names="Nope", what={"KEYS"})
    with pytest.raises(RuntimeError, match=r"Cow has no Nope to transfer; it has: UVMap\."):
        call("transfer_by_map", names="Nope", what={"UVS"})


@pytest.mark.parametrize(("direction", "example"), [("FORWARD", "Arm.L"), ("BACKWARD", "Arm.R")])
def test_names_without_a_side_cannot_be_mirrored(direction, example):
    obj = sphere("Cow")
    store_mirror(obj)
    paint(obj, Spine=np.ones(len(points(obj))))
    with pytest.raises(RuntimeError, match=f"nothing to mirror among Spine; names need .*, such as {example}"):
        call("transfer_by_map", direction=direction)


def test_failures_leave_nothing_behind(pair):
    giver = pair[0]
    paint(giver, **halves(giver))
    before = inventory()
    with pytest.raises(RuntimeError, match="no shape keys"):
        call("transfer_by_map", what={"GROUPS", "KEYS"})
    assert inventory() == before


def test_the_receiver_must_be_editable(pair):
    giver, receiver = pair
    paint(giver, **halves(giver))
    bpy.context.view_layer.objects.active = receiver
    bpy.ops.object.mode_set(mode="EDIT")
    with pytest.raises(RuntimeError, match="Horse is in Edit Mode; leave it with Tab"):
        call("transfer_by_map")
    bpy.ops.object.mode_set(mode="OBJECT")
    receiver.data.vertices.add(1)
    with pytest.raises(RuntimeError, match="vertices or faces of Horse have changed since its soft map was"):
        call("transfer_by_map")


def test_a_giver_in_edit_mode_may_give(pair):
    giver, receiver = pair
    paint(giver, **halves(giver))
    bpy.context.view_layer.objects.active = giver
    receiver.select_set(False)
    bpy.ops.object.mode_set(mode="EDIT")
    assert call("transfer_by_map", what={"GROUPS", "UVS"}) == {"FINISHED"}
    assert receiver.vertex_groups.keys() == ["Left", "Right"]


@pytest.mark.parametrize("mode", ["WEIGHT_PAINT", "VERTEX_PAINT", "POSE"])
def test_other_modes_are_no_obstacle(pair, mode):
    giver, receiver = pair
    paint(giver, **halves(giver))
    add_key(giver, "Smile", points(giver) * 0.2)
    if mode == "POSE":
        add_armature(receiver, "Left", "Right")
    else:
        bpy.context.view_layer.objects.active = receiver
    bpy.ops.object.mode_set(mode=mode)
    assert call("transfer_by_map", what={"GROUPS", "KEYS", "UVS"}) == {"FINISHED"}
    assert bpy.context.object.mode == mode
    np.testing.assert_allclose(read_group(receiver, "Left"), halves(receiver)["Left"], atol=0.01)
    assert "Smile" in receiver.data.shape_keys.key_blocks


def test_in_sculpt_mode_it_waits_for_another_one(pair):
    bpy.context.view_layer.objects.active = pair[1]
    bpy.ops.object.mode_set(mode="SCULPT")
    with pytest.raises(RuntimeError, match="Go to Object Mode first"):
        call("transfer_by_map")


def test_later_changes_of_the_shape_are_reported(pair, capfd):
    giver = pair[0]
    paint(giver, **halves(giver))
    giver.data.vertices[5].co.x += 0.25
    call("transfer_by_map")
    assert "Cow was reshaped since its soft map was computed" in capfd.readouterr().out


def test_polygons_that_are_cut_otherwise_since_do_no_harm(pair):
    """The triangles are stored with the map: bending a face until it is triangulated differently changes nothing."""
    giver, receiver = pair
    paint(giver, **halves(giver))
    call("transfer_by_map")
    before = read_group(receiver, "Left")
    basis = points(giver)
    bent = basis.copy()
    bent[::3] *= 0.3
    add_key(giver, "Bent", bent - basis).value = 1.0
    bpy.context.view_layer.update()
    call("transfer_by_map")
    np.testing.assert_allclose(read_group(receiver, "Left"), before, atol=1e-6)


def test_one_step_is_undone(pair):
    giver = pair[0]
    paint(giver, **halves(giver))
    bpy.ops.ed.undo_push(message="before")
    before = inventory()
    call("transfer_by_map", what={"GROUPS", "UVS"})
    bpy.ops.ed.undo_push(message="after")
    assert inventory() != before
    bpy.ops.ed.undo()
    assert inventory() == before


def test_a_missing_map_is_reported():
    with pytest.raises(RuntimeError, match="Choose a source and a target"):
        call("transfer_by_map")
    choose(sphere("Cow"), sphere("Horse"))
    with pytest.raises(RuntimeError, match="Compute the soft map first"):
        call("transfer_by_map")


def start(monkeypatch, **arguments):
    context, pressed = window_context(), Pressed(CONVWASS_OT_transfer_by_map, **arguments)
    pretend_window(monkeypatch)
    assert pressed.invoke(context, None) == {"RUNNING_MODAL"}
    return pressed, context


ALL = {"what": {"GROUPS", "KEYS"}, "direction": "FORWARD", "existing": "REPLACE"}


def test_it_runs_in_the_background(pair, monkeypatch):
    giver, receiver = pair
    paint(giver, **halves(giver))
    add_key(giver, "Smile", points(giver) * 0.2)
    pressed, context = start(monkeypatch, **ALL)
    bpy.context.view_layer.objects.active = receiver
    bpy.ops.object.mode_set(mode="EDIT")
    until(pressed, context, lambda: getattr(context.window_manager.convwass_progress, "message", "").startswith("Done"))
    assert not receiver.vertex_groups
    bpy.ops.object.mode_set(mode="OBJECT")
    assert until(pressed, context) == {"FINISHED"}
    assert receiver.vertex_groups.keys() == ["Left", "Right"]
    assert "Smile" in receiver.data.shape_keys.key_blocks


def test_escape_leaves_everything_as_it_was(pair, monkeypatch):
    def for_ever(_self, _control):
        while True:
            yield Progress(0.0, Sentence("Transferring vertex groups"))
            time.sleep(0.001)

    paint(pair[0], **halves(pair[0]))
    monkeypatch.setattr(soft_map_transfer.CarriedGroups, "steps", for_ever)
    before = inventory()
    pressed, context = start(monkeypatch, **{**ALL, "what": {"GROUPS"}})
    assert pressed.modal(context, ESCAPE) == {"CANCELLED"}
    assert pressed.reports[-1] == ("INFO", "Stopped; nothing was changed")
    assert inventory() == before


def test_a_receiver_that_changes_meanwhile_is_left_alone(pair, monkeypatch):
    giver, receiver = pair
    paint(giver, **halves(giver))
    pressed, context = start(monkeypatch, **{**ALL, "what": {"GROUPS"}})
    receiver.data.vertices.add(1)
    assert until(pressed, context) == {"CANCELLED"}
    assert "vertices of Horse have changed since the start" in pressed.reports[-1][1]
    assert not receiver.vertex_groups
