# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Which shapes are visible again after a morph was deleted."""

from __future__ import annotations

import bpy
import pytest

from convwass_addon.bridge.morphs.inputs.hidden_inputs import HIDDEN_KEY
from convwass_addon.bridge.morphs.removal import delete_morph, remove_bake
from convwass_addon.bridge.morphs.stored import MORPH_KEY, frame_objects, stored_inputs, stored_settings
from convwass_addon.bridge.one_mesh.baked_keys import SWAP_KEY
from tests.operators.morphs import add
from tests.scene import select_only


@pytest.fixture
def shapes(empty_scene):
    """Two spheres, A and B."""
    return [add("ico_sphere", name, subdivisions=2, location=(x, 0, 0)) for name, x in (("A", 0.0), ("B", 3.0))]


def bake(inputs="A,B", **options):
    bpy.ops.convwass.bake_morph(**{"inputs": inputs, "motion": "TRANSPORT", "frames": 2, "resolution": 16, **options})
    return bpy.context.object.users_collection[0]


def delete(morph):
    bpy.context.view_layer.objects.active = frame_objects(morph)[0]
    assert bpy.ops.convwass.delete_morph() == {"FINISHED"}


def hidden(*objects):
    """Where each object is hidden: in the viewport, in renders."""
    return [(obj.hide_get(), obj.hide_render) for obj in objects]


BOTH, NEITHER = (True, True), (False, False)


def test_the_other_shape_is_shown_where_one_no_longer_exists(shapes):
    morph = bake()
    assert hidden(*shapes) == [BOTH, BOTH]
    bpy.data.objects.remove(shapes[1])
    delete(morph)
    assert hidden(shapes[0]) == [NEITHER]


@pytest.mark.parametrize("output", ["OBJECTS", "SHAPE_KEYS"])
def test_shapes_that_were_renamed_are_named_where_they_stay_hidden(shapes, capfd, output):
    bake(output=output)
    shapes[1].name = "Hero"
    capfd.readouterr()
    assert bpy.ops.convwass.delete_morph() == {"FINISHED"}
    assert hidden(*shapes) == [NEITHER, BOTH]
    assert "deleted. No object is named B; if you have renamed such a shape" in capfd.readouterr().out


def test_shapes_that_another_morph_hides_stay_hidden(shapes):
    bpy.ops.mesh.primitive_cube_add()
    bpy.context.object.name = "C"
    first, second = bake(), bake("A,C")
    delete(first)
    assert hidden(*shapes) == [BOTH, NEITHER]
    delete(second)
    assert hidden(*shapes, bpy.data.objects["C"]) == [NEITHER] * 3


def test_a_morph_whose_collection_is_in_no_scene_hides_nothing(shapes):
    bpy.ops.mesh.primitive_cube_add()
    bpy.context.object.name = "C"
    first, second = bake(), bake("A,C")
    bpy.context.scene.collection.children.unlink(first)
    first.use_fake_user = True
    delete(second)
    assert hidden(shapes[0], bpy.data.objects["C"]) == [NEITHER, NEITHER]


def test_deleted_shape_keys_that_still_exist_hide_nothing(shapes):
    morph = bake()
    keyed = bpy.data.objects.new("Keys", bpy.data.meshes.new("Keys"))
    for key in (MORPH_KEY, HIDDEN_KEY):
        keyed[key] = morph[key]
    # As in a bake of two meshes, which refer to each other.
    keyed[SWAP_KEY] = {"object": keyed}
    delete(morph)
    assert hidden(*shapes) == [NEITHER, NEITHER]


def test_what_the_user_has_hidden_stays_hidden(shapes):
    shapes[0].hide_render = True
    shapes[1].hide_set(True)
    delete(bake())
    assert hidden(*shapes) == [(False, True), (True, False)]
    morph = bake(hide_inputs=False)
    shapes[0].hide_set(True)
    delete(morph)
    assert hidden(*shapes) == [BOTH, (True, False)]


def test_a_morph_whose_shapes_were_shown_again_hides_them_no_longer(shapes):
    first = bake()
    for obj in shapes:
        obj.hide_set(False)
        obj.hide_render = False
    second = bake()
    delete(second)
    assert hidden(*shapes) == [NEITHER, NEITHER]
    delete(first)
    assert hidden(*shapes) == [NEITHER, NEITHER]


def test_a_morph_that_was_baked_again_still_hides_its_shapes(shapes):
    morph = bake()
    # One is shown to be edited, so that the new bake hides nothing.
    shapes[1].hide_set(False)
    shapes[1].hide_render = False
    bpy.ops.convwass.rebake_morph(which="ALL")
    assert hidden(*shapes) == [BOTH, NEITHER]
    delete(morph)
    assert hidden(*shapes) == [NEITHER, NEITHER]


def test_the_frames_of_a_player_need_the_shapes_hidden_too(shapes):
    morph = bake(output="PLAYER")
    bpy.ops.convwass.bake_player()
    delete(morph)
    assert hidden(*shapes) == [BOTH, BOTH]
    delete(bpy.context.scene.collection.children[0])
    assert hidden(*shapes) == [NEITHER, NEITHER]


def test_a_player_is_shown_again_when_all_frames_made_from_it_are_deleted(shapes):
    bake(output="PLAYER")
    player, made = bpy.context.object, []
    for _ in range(2):
        player.hide_viewport = False
        select_only(player)
        bpy.context.view_layer.objects.active = player
        bpy.ops.convwass.bake_player()
        made.append(bpy.context.object.users_collection[0])
    delete(made[0])
    assert player.hide_viewport and player.hide_render
    delete(made[1])
    assert not player.hide_viewport and not player.hide_render


def test_a_deleted_player_is_not_missed(shapes):
    morph = bake(output="PLAYER")
    bpy.ops.convwass.bake_player()
    frames = bpy.context.object.users_collection[0]
    remove_bake(morph)
    assert delete_morph(frames) == []
    assert hidden(*shapes) == [NEITHER, NEITHER]


@pytest.mark.parametrize("stored", [None, "{", "[3]", '[{"name": 1, "library": "", "layers": [], "in_renders": true}]'])
def test_without_a_valid_record_all_shapes_are_shown(shapes, stored):
    morph = bake()
    if stored is None:
        del morph[HIDDEN_KEY]
    else:
        morph[HIDDEN_KEY] = stored
    delete(morph)
    assert hidden(*shapes) == [NEITHER, NEITHER]


def test_a_shape_of_an_earlier_morph_stays_hidden(shapes):
    first = bake()
    del first[HIDDEN_KEY]
    delete(bake())
    assert hidden(*shapes) == [BOTH, BOTH]
    delete(first)
    assert hidden(*shapes) == [NEITHER, NEITHER]


def test_in_a_full_copy_of_a_scene_the_copied_shapes_are_shown(shapes):
    """Although their numbers are in another order than those of the originals."""
    shapes[1].name = "A.001"
    bake("A,A.001", guides='[{"points": {"A": 11, "A.001": 0}}]')
    bpy.context.view_layer.objects.active = None
    bpy.ops.scene.new(type="FULL_COPY")
    copies = [obj for obj in bpy.context.scene.objects if obj.name.startswith("A.")][:2]
    (morph,) = bpy.context.scene.collection.children
    assert stored_inputs(morph) == copies
    assert hidden(*copies) == [BOTH, BOTH]
    bpy.context.view_layer.objects.active = frame_objects(morph)[0]
    assert bpy.ops.convwass.rebake_morph(which="ACTIVE") == {"FINISHED"}
    (guide,) = stored_settings(morph)["guides"]
    assert guide["points"] == {copies[0].name: 11, copies[1].name: 0}
    delete(morph)
    assert hidden(*copies) == [NEITHER, NEITHER]
    assert [obj.hide_render for obj in shapes] == [True, True]


def test_shapes_of_another_scene_are_shown_if_this_one_is_no_copy_of_it(shapes):
    morph = bake()
    other = bpy.data.scenes.new("Shot")
    other.collection.children.link(morph)
    bpy.context.scene.collection.children.unlink(morph)
    other.collection.objects.link(bpy.data.objects.new("A.001", shapes[0].data))
    assert stored_inputs(morph) == shapes
