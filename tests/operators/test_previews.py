# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Previews in the scene, as the operator shows them in a window, which a context imitates here."""

from __future__ import annotations

import bpy
import pytest

from convwass_addon.applications.morphs import first_preview
from convwass_addon.applications.morphs.bake_plan import MorphPreview
from convwass_addon.applications.morphs.computation import Computation
from convwass_addon.applications.morphs.layouts import path_blends, single_blend
from convwass_addon.applications.morphs.morph_problem import MorphFrame
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.bridge.morphs import job
from convwass_addon.bridge.morphs.bake import MorphBake
from convwass_addon.bridge.morphs.stored import frame_objects, stored_diagnostics, stored_inputs, stored_morph
from convwass_addon.operators import background
from tests.operators.morphs import PressedBake, baked_morph, census, two_shapes
from tests.operators.running import (
    ESCAPE,
    TIMER,
    is_computing,
    started,
    until,
    wait_for_the_thread,
    window_context,
    write_one_at_a_time,
)

pytestmark = pytest.mark.usefixtures("empty_scene")


@pytest.fixture
def context():
    return window_context()


@pytest.fixture
def press(context):
    """Give a function that starts a bake of the selected shapes and returns the running operator."""

    def start(frames, resolution=24):
        settings = bpy.context.scene.convwass_morph
        settings.frames, settings.resolution, settings.motion = frames, resolution, "TRANSPORT"
        context.selected_objects = bpy.context.selected_objects
        pressed = PressedBake()
        assert started(pressed, context)
        return pressed

    return start


def test_every_frame_is_there_coarsely_and_then_finished(press, context, monkeypatch):
    two_shapes()
    blends, previews, seen = path_blends(2, 6), {}, {}
    add, preview = MorphBake.add, MorphBake.preview

    def previewing(bake, frame):
        preview(bake, frame)
        obj = bpy.data.objects[f"Morph {blends.index(frame.blend) + 1:04d}"]
        previews[frame.blend] = obj.session_uid, len(obj.data.vertices), obj.name, obj.animation_data.action_slot.handle

    def adding(bake, frame):
        obj = add(bake, frame)
        seen[frame.blend] = obj.session_uid, len(obj.data.vertices), obj.name, obj.animation_data.action_slot.handle
        return obj

    monkeypatch.setattr(MorphBake, "preview", previewing)
    monkeypatch.setattr(MorphBake, "add", adding)
    pressed = press(6)
    assert until(pressed, context) == {"FINISHED"}
    assert len(previews) == len(seen) == 7
    for blend, (uid, vertices, name, slot) in seen.items():
        before = previews[blend]
        assert (uid, name, slot) == (before[0], before[2], before[3])
        assert vertices == before[1] if blend.source is not None else vertices > 2 * before[1]
    assert [obj.name for obj in frame_objects(baked_morph())] == [f"Morph {n:04d}" for n in range(1, 8)]
    assert len(stored_morph(baked_morph()).records) == 7


def held_back(monkeypatch, frames):
    """Limit the number of frames that bakes write, as if others took long; return the written ones."""
    write, finished = job.MorphJob.write, []

    def writing(own, report):
        if isinstance(report.payload, MorphFrame):
            if len(finished) == frames:
                return
            finished.append(report)
        write(own, report)

    monkeypatch.setattr(job.MorphJob, "write", writing)
    return finished


def test_stopping_keeps_finished_frames_and_no_previews(press, context, monkeypatch):
    two_shapes()
    finished, pressed = held_back(monkeypatch, 3), press(40)
    until(pressed, context, lambda: len(finished) == 3)
    assert len(frame_objects(baked_morph())) == 41
    assert pressed.modal(context, ESCAPE) == {"FINISHED"}
    collection = baked_morph()
    assert [obj.name for obj in frame_objects(collection)] == ["Morph 0001", "Morph 0002", "Morph 0003"]
    (action,) = bpy.data.actions
    assert len(action.slots) == 3
    assert len([mesh for mesh in bpy.data.meshes if mesh.name.startswith("Morph")]) == 2


def test_stopping_during_previews_keeps_and_reports_them(press, context, monkeypatch):
    two_shapes()
    held_back(monkeypatch, 0)
    pressed = press(80)
    until(pressed, context, lambda: len(frame_objects(baked_morph())) > 4)
    assert pressed.modal(context, ESCAPE) == {"FINISHED"}
    collection = baked_morph()
    assert len(frame_objects(collection)) > 4
    assert [note.kind for note in stored_diagnostics(collection)] == ["PREVIEWS"]
    assert "previews are kept" in pressed.reports[0]


def test_inputs_are_hidden_behind_previews_and_come_back(press, context, monkeypatch):
    shapes = two_shapes()
    chosen = [obj.select_get() for obj in shapes]
    held_back(monkeypatch, 0)
    pressed = press(80)
    until(pressed, context, lambda: len(frame_objects(baked_morph())) > 4)
    assert all(obj.hide_get() for obj in shapes)
    pressed.cancel(context)
    assert not any(obj.hide_get() for obj in shapes)
    assert [obj.select_get() for obj in shapes] == chosen


def test_closing_the_window_leaves_nothing_behind(press, context):
    two_shapes()
    before = census()
    pressed = press(80)
    until(pressed, context, lambda: len(frame_objects(baked_morph())) > 4)
    pressed.cancel(context)
    assert census() == before


def test_disabling_the_add_on_leaves_nothing_of_a_bake(press, context, registered_addon):
    """Blender drops the handlers of operators that go and calls nothing of them."""
    two_shapes()
    before, manager = census(), bpy.context.window_manager
    context.window_manager.convwass_progress = manager.convwass_progress
    context.window_manager.event_timer_add = lambda seconds, window: manager.event_timer_add(
        seconds, window=bpy.context.window
    )
    pressed = press(80)
    until(pressed, context, lambda: len(frame_objects(baked_morph())) > 4)
    assert manager.convwass_progress.running
    assert not bpy.ops.convwass.bake_morph.poll()
    # It is removed with its class, and must not be accessed any more.
    context.window_manager.convwass_progress = None
    registered_addon.unregister()
    try:
        assert not is_computing()
        assert census() == before
    finally:
        registered_addon.register()
    assert not manager.convwass_progress.running
    assert bpy.ops.convwass.bake_morph.poll()


def test_a_finished_bake_is_not_stopped_again(press, context):
    two_shapes()
    pressed = press(3)
    assert until(pressed, context) == {"FINISHED"}
    background.stop_running(context)
    assert len(frame_objects(baked_morph())) == 4


def test_stopping_another_bake_leaves_the_morph_as_it_was(press, context, monkeypatch):
    two_shapes()
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", frames=2, resolution=24)
    name = baked_morph().name
    bpy.ops.object.select_all(action="DESELECT")
    for shape in stored_inputs(baked_morph()):
        shape.hide_set(False)
        shape.select_set(True)
    known = census()
    finished, pressed = held_back(monkeypatch, 3), press(40)
    pressed.replaces = name
    until(pressed, context, lambda: len(finished) == 3)
    # It may take longer than the window waits for.
    if pressed.modal(context, ESCAPE) == {"PASS_THROUGH"}:
        assert until(pressed, context) == {"CANCELLED"}
    assert pressed.reports == ["Stopped; the morph was not changed"]
    assert census() == known


def test_the_window_answers_while_many_objects_wait_to_be_made(press, context, monkeypatch):
    """Each time as many are made as there is time for; here that is one."""
    two_shapes()
    written, write = [], job.MorphJob.write
    monkeypatch.setattr(job.MorphJob, "write", lambda own, report: written.append(report) or write(own, report))
    write_one_at_a_time(monkeypatch)
    pressed = press(3)
    wait_for_the_thread()
    expected = 3 + 4 + 4
    for number in range(1, expected + 1):
        assert pressed.modal(context, TIMER) == {"PASS_THROUGH"}
        assert len(written) == number
    assert pressed.modal(context, TIMER) == {"FINISHED"}
    assert len(frame_objects(baked_morph())) == 4


def test_stopping_writes_all_that_waits(press, context, monkeypatch):
    two_shapes()
    write_one_at_a_time(monkeypatch)
    pressed = press(3)
    wait_for_the_thread()
    assert pressed.modal(context, ESCAPE) == {"FINISHED"}
    assert len(frame_objects(baked_morph())) == 4


@pytest.mark.parametrize(("current", "number"), [(1, 0), (5, 4), (-10, 0), (100, 6)])
def test_the_frame_that_is_looked_at_is_previewed_first(monkeypatch, current, number):
    two_shapes()
    asked = {}
    monkeypatch.setattr(job, "morph", lambda *args, **options: asked.update(options))
    bpy.context.scene.frame_set(current)
    for blends, expected in ((path_blends(2, 6), number), (single_blend([1, 1], 2), 0)):
        shapes = bpy.context.selected_objects
        baking = job.MorphJob(shapes, blends, MorphSettings(motion="transport", resolution=24), {}, 1)
        baking.steps(computation=Computation(previews=True))
        assert asked["computation"].looked_at == expected


def test_without_a_window_there_are_no_previews(monkeypatch):
    two_shapes()
    previews = []
    monkeypatch.setattr(job.MorphJob, "write", noting(job.MorphJob.write, previews))
    assert bpy.ops.convwass.bake_morph(motion="TRANSPORT", frames=3, resolution=24) == {"FINISHED"}
    assert previews
    assert not any(previews)


def noting(write, previews):
    def writing(job, step):
        previews.append(isinstance(step.payload, MorphPreview))
        write(job, step)

    return writing


def test_the_button_stops_as_escape_does(press, context, monkeypatch):
    two_shapes()
    finished, pressed = held_back(monkeypatch, 3), press(40)
    until(pressed, context, lambda: len(finished) == 3)
    context.window_manager.convwass_progress.stopping = True
    assert pressed.modal(context, TIMER) == {"FINISHED"}
    assert len(frame_objects(baked_morph())) == 3
    assert not context.window_manager.convwass_progress.running


def test_without_a_bake_stopping_is_refused():
    assert not bpy.ops.convwass.stop.poll()


@pytest.mark.parametrize(
    ("passed", "fraction", "left"),
    [(1.0, 0.5, None), (30.0, 0.1, None), (5.0, 0.5, 5), (5.0, 0.18, 25), (100.0, 0.4, 150), (4.0, 1.0, 0)],
)
def test_the_time_that_is_left(passed, fraction, left):
    assert background.time_left(passed, fraction) == left


def test_a_better_preview_replaces_the_first(press, context, monkeypatch):
    """One object per frame, whatever was shown before."""
    two_shapes()
    previewed, counts, preview = [], set(), MorphBake.preview

    def previewing(bake, frame):
        preview(bake, frame)
        previewed.append(frame.blend)
        counts.add((len(baked_morph().objects), len(set(previewed))))

    monkeypatch.setattr(MorphBake, "preview", previewing)
    # The first preview is coarser than others.
    monkeypatch.setattr(first_preview, "_RESOLUTION", 24)
    pressed = press(3, resolution=32)
    assert until(pressed, context) == {"FINISHED"}
    assert len(previewed) == 5
    assert counts == {(number, number) for number in (1, 2, 3, 4)}
