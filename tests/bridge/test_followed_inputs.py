# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Morphs between animated objects: blends follow them, and the ends stay animated."""

from __future__ import annotations

import bpy
import numpy as np
import pytest

from convwass_addon.applications.morphs.computation import Computation
from convwass_addon.applications.morphs.layouts import grid_blends, path_blends
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.bridge.element_values import element_values
from convwass_addon.bridge.morphs.changes import changed_inputs
from convwass_addon.bridge.morphs.fields.field_sampling import read_blends
from convwass_addon.bridge.morphs.job import MorphJob
from convwass_addon.bridge.morphs.players.player import make_player
from convwass_addon.bridge.morphs.removal import remove_bake
from convwass_addon.bridge.morphs.stored import frame_objects
from convwass_addon.bridge.objects import triangle_mesh
from convwass_addon.errors import InputError

FIRST = 10


@pytest.fixture
def movers(make_object):
    """Octahedra that move by one unit per frame: one to the right, one up, which is mirrored."""
    right, up = make_object("Right"), make_object("Up")
    up.scale.x = -1
    for obj, axis in ((right, 0), (up, 2)):
        for frame in (0, 30):
            obj.location[axis] = frame - FIRST
            obj.keyframe_insert("location", index=axis, frame=frame)
        bag = obj.animation_data.action.layers[0].strips[0].channelbags[0]
        for point in bag.fcurves[0].keyframe_points:
            point.interpolation = "LINEAR"
    return [right, up]


@pytest.fixture
def hat(movers, make_object):
    """A child of the second one."""
    hat = make_object("Hat")
    hat.parent, hat.location.z, hat.scale = movers[1], 2, (0.5, 0.5, 0.5)
    return hat


def job(inputs, blends=None, **options):
    settings = MorphSettings(24, motion="transport")
    options = {"follow": "FOLLOW", **options}
    return MorphJob(inputs, blends or path_blends(len(inputs), 3), settings, options, FIRST)


def finished(made):
    for step in made.steps(computation=Computation(workers=1)):
        made.write(step)
    return made.finish(hide_inputs=True)


def seen(scene, frame):
    """Bounds of the visible objects in a frame, (2, 3)."""
    scene.frame_set(frame)
    depsgraph = bpy.context.evaluated_depsgraph_get()
    points = []
    for instance in depsgraph.object_instances:
        if instance.object.type == "MESH" and instance.object.data.polygons:
            mesh, matrix = instance.object.data, np.array(instance.matrix_world)
            points.append(element_values(mesh.vertices, "co", 3) @ matrix[:3, :3].T + matrix[:3, 3])
    return np.array([np.min(np.concatenate(points), axis=0), np.max(np.concatenate(points), axis=0)])


def test_moving_objects_become_moving_objects(bare_scene, movers, inventory):
    bare_scene.frame_set(7)
    before = inventory()
    made = job(movers)
    assert bare_scene.frame_current == 7
    made.discard()
    assert inventory() == before
    morph = finished(job(movers))
    for frame in (FIRST + 1, FIRST + 2):
        share, moved = (frame - FIRST) / 3, frame - FIRST
        center = seen(bare_scene, frame).mean(axis=0)
        np.testing.assert_allclose(center, [(1 - share) * moved, 0, share * moved], atol=0.1)
    assert changed_inputs(morph) == []


def test_stretched_time_shows_what_was_followed(bare_scene, movers):
    bare_scene.render.frame_map_old, bare_scene.render.frame_map_new = 100, 200
    bare_scene.frame_set(7, subframe=0.5)
    made = job(movers)
    assert (bare_scene.frame_current, bare_scene.frame_subframe) == (7, 0.5)
    finished(made)
    # One unit in each of the times 11 and 12, which are shown in frames 22 and 24.
    for share, frame in ((1 / 3, 22), (2 / 3, 24)):
        low, high = seen(bare_scene, frame)
        middle = (low + high)[[0, 2]] / 2
        np.testing.assert_allclose(middle, 3 * share * np.array([1 - share, share]), atol=0.1)


@pytest.mark.parametrize("player", [False, True])
def test_the_ends_play_on(bare_scene, movers, hat, player):
    morph = finished(job(movers, grouping="PARENTS"))
    if player:
        make_player(morph)
    for frame in (FIRST - 5, FIRST):
        np.testing.assert_allclose(seen(bare_scene, frame).mean(axis=0), [frame - FIRST, 0, 0], atol=1e-4)
    for frame in (FIRST + 3, FIRST + 8):
        low, high = seen(bare_scene, frame)
        np.testing.assert_allclose([low[2], high[2]], [frame - FIRST - 1, frame - FIRST + 2.5], atol=1e-4)
    if not player:
        shown = frame_objects(morph)[-1].evaluated_get(bpy.context.evaluated_depsgraph_get()).data
        used = {shown.materials[polygon.material_index].name for polygon in shown.polygons}
        assert used == {"Convwass Morph"}
    first = triangle_mesh(frame_objects(morph)[0], bpy.context.evaluated_depsgraph_get())
    assert first.volume == pytest.approx(4 / 3)


@pytest.mark.parametrize("player", [False, True])
def test_the_ends_move_with_the_frames(bare_scene, movers, make_object, player):
    morph = finished(job(movers))
    before = [seen(bare_scene, frame) for frame in range(FIRST - 1, FIRST + 5)]
    parent = make_object("Set")
    parent.hide_viewport, parent.location, parent.scale = True, (0, 5, 7), (2, 2, 2)
    for obj in frame_objects(morph):
        obj.parent = parent
    if player:
        make_player(morph)
    after = [seen(bare_scene, frame) for frame in range(FIRST - 1, FIRST + 5)]
    np.testing.assert_allclose(after, 2 * np.array(before) + (0, 5, 7), atol=1e-4)


def test_a_morph_that_is_deleted_takes_its_ends_along(movers, inventory):
    before = inventory()
    remove_bake(finished(job(movers)))
    # Morphs share one material, which is kept.
    assert inventory() - before == {("MATERIAL", "Convwass Morph")}


def test_an_input_deleted_during_the_bake_is_kept(bare_scene, movers):
    made = job(movers)
    bpy.data.objects.remove(movers[1])
    finished(made)
    for frame in (FIRST + 3, FIRST + 8):
        np.testing.assert_allclose(seen(bare_scene, frame).mean(axis=0), [0, 0, 3], atol=1e-4)


def test_shapes_that_are_laid_on_each_other_stay_so(bare_scene, movers):
    """The second one is moved to where the first one is when the bake begins, and moves on from there."""
    bare_scene.frame_set(FIRST + 2)
    morph = finished(job(movers, alignment="CENTERED"))
    np.testing.assert_allclose(seen(bare_scene, FIRST + 5).mean(axis=0), [2, 0, 3], atol=1e-4)
    assert len(frame_objects(morph)) == 4


def test_an_intermediate_shape_is_shown_in_its_current_pose(bare_scene, movers, make_object):
    finished(job([*movers, make_object("Last")]))
    np.testing.assert_allclose(seen(bare_scene, FIRST + 3).mean(axis=0), [0, 0, 3], atol=1e-4)


def test_inputs_that_cannot_be_followed_are_refused(bare_scene, movers, make_object, inventory):
    before = inventory()
    with pytest.raises(InputError, match="Only an animation can follow"):
        job([*movers, make_object("C"), make_object("D")], grid_blends(4, 2))
    movers[0].modifiers.new("Vanishing", "MASK").vertex_group = movers[0].vertex_groups.new(name="None").name
    movers[0].modifiers[0].show_viewport = False
    movers[0].modifiers[0].keyframe_insert("show_viewport", frame=FIRST)
    movers[0].modifiers[0].show_viewport = True
    movers[0].modifiers[0].keyframe_insert("show_viewport", frame=FIRST + 2)
    bare_scene.frame_set(FIRST)
    with pytest.raises(InputError, match=f"In frame {FIRST + 2}: Right"):
        job(movers)
    movers[0].modifiers.clear()
    driver = movers[1].driver_add("location", 1).driver
    driver.type, driver.expression = "SCRIPTED", "nothing_of_this_name + 1"
    bpy.context.view_layer.update()
    with pytest.raises(InputError, match="The driver of location on Up has an error"):
        job(movers)
    assert {kind for kind, _ in inventory() - before} <= {"OBJECT", "MESH", "ACTION"}
    assert not [name for kind, name in inventory() if kind == "COLLECTION"]


def test_players_mix_animated_ends_as_they_are_at_their_times(bare_scene, movers):
    morph = finished(job(movers))
    bare_scene.frame_set(FIRST + 20)
    meshes = read_blends(morph, frame_objects(morph)).meshes
    assert bare_scene.frame_current == FIRST + 20
    for mesh, frame in ((meshes[0], FIRST), (meshes[-1], FIRST + 3)):
        np.testing.assert_allclose(mesh.bounds, seen(bare_scene, frame), atol=1e-5)
