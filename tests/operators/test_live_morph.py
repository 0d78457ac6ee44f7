# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Live Morph between two events: its handle, sidebar and buttons, and its end."""

from __future__ import annotations

import time
from types import SimpleNamespace

import bpy
import pytest
from mathutils import Matrix

from convwass_addon.bridge.live.running import running_live
from convwass_addon.operators import live_morph
from convwass_addon.operators.live_drag import HandleDrag
from convwass_addon.operators.live_morph import CONVWASS_OT_live_morph
from tests.operators.morphs import two_shapes
from tests.operators.running import ESCAPE, TIMER, Pressed, window_context
from tests.panels.drawing import draw

pytestmark = pytest.mark.usefixtures("empty_scene")


@pytest.fixture
def press():
    """Give a function that presses Live Morph on two shapes, and returns the operator and its context."""

    def pressed(**arguments):
        two_shapes()
        context = window_context()
        context.scene, context.view_layer = bpy.context.scene, bpy.context.view_layer
        context.selected_objects = bpy.context.selected_objects
        operator = Pressed(CONVWASS_OT_live_morph, **{"motion": "TRANSPORT", "live_resolution": 24} | arguments)
        assert operator.begin(context) == {"RUNNING_MODAL"}
        return operator, context

    yield pressed
    last = window_context()
    last.window_manager.windows = []
    live_morph.stop_live(last)


def goes_on(operator, context, until, seconds=60.0):
    """Let time pass until something is so."""
    end = time.monotonic() + seconds
    while not until():
        assert operator.modal(context, TIMER) == {"PASS_THROUGH"}
        assert time.monotonic() < end
        time.sleep(0.005)


def is_shown():
    return len(running_live().scene.shape.data.polygons) > 0


def test_the_value_in_the_sidebar_is_that_of_the_handle(press):
    operator, context = press()
    goes_on(operator, context, is_shown)
    handle = bpy.context.window_manager.convwass_live
    assert handle.morph == pytest.approx(0.5)
    handle.morph = 0.25
    assert operator.modal(context, TIMER) == {"PASS_THROUGH"}
    assert running_live().weights == pytest.approx((0.75, 0.25), abs=1e-5)
    assert handle.across == pytest.approx(0.25)
    shown = draw(bpy.types.CONVWASS_PT_live)
    assert "convwass.keep_live_shape" in str(shown) and "convwass.live_morph" not in str(shown)


def test_escape_leaves_no_trace(press):
    names = {"before": None}
    operator, context = press()
    names["before"] = {obj.name for obj in bpy.data.objects if not obj.name.startswith("Live")}
    goes_on(operator, context, is_shown)
    assert operator.modal(context, ESCAPE) == {"CANCELLED"}
    assert {obj.name for obj in bpy.data.objects} == names["before"]
    assert running_live() is None and not any(obj.hide_get() for obj in bpy.data.objects)
    assert CONVWASS_OT_live_morph.poll(bpy.context)


def test_undo_ends_it_and_redo_restores_nothing(press):
    bpy.ops.ed.undo_push(message="empty")
    operator, context = press()
    goes_on(operator, context, is_shown)
    handle = bpy.context.window_manager.convwass_live
    for place in (0.25, 0.75):
        handle.morph = place
        bpy.ops.ed.undo_push(message="moved")
    bpy.ops.ed.undo()
    assert operator.modal(context, TIMER) == {"PASS_THROUGH"}
    assert handle.morph == pytest.approx(0.25)
    bpy.ops.ed.undo()
    assert operator.modal(context, TIMER) == {"CANCELLED"}
    assert running_live() is None
    bpy.ops.ed.redo()
    assert {obj.name for obj in bpy.data.objects} == {"Cube", "Sphere"}
    assert not any(obj.hide_get() for obj in bpy.data.objects)


def test_another_one_has_to_wait(press):
    press()
    assert not bpy.ops.convwass.live_morph.poll()


def test_shapes_can_be_kept_while_it_runs(press):
    operator, context = press()
    goes_on(operator, context, is_shown)
    assert bpy.ops.convwass.keep_live_shape() == {"FINISHED"}
    assert len(bpy.data.objects["Blend"].data.polygons) > 100
    assert operator.modal(context, TIMER) == {"PASS_THROUGH"}
    assert bpy.ops.convwass.end_live_morph() == {"FINISHED"}
    assert operator.modal(context, TIMER) == {"FINISHED"}
    assert "Blend" in bpy.data.objects and not bpy.ops.convwass.keep_live_shape.poll()


def test_a_single_blend_is_baked_with_the_weights_of_the_handle(press):
    press()
    settings = bpy.context.scene.convwass_morph
    settings.layout, settings.resolution, settings.motion = "BLEND", 24, "TRANSPORT"
    running_live().move_to(0.75, 0.0)
    running_live().tick()
    assert bpy.ops.convwass.bake_live_morph() == {"FINISHED"}
    (frame,) = [obj for obj in bpy.data.objects if obj.name.startswith("Morph")]
    assert list(frame["convwass_weights"]) == pytest.approx([0.25, 0.75], abs=1e-5)
    assert running_live() is None


def test_it_goes_on_when_it_cannot_be_baked_without_a_deleted_shape(press):
    operator, context = press()
    goes_on(operator, context, is_shown)
    bpy.data.objects.remove(bpy.data.objects["Cube"])
    with pytest.raises(RuntimeError, match="was deleted, so the live morph cannot be baked; Keep Shape keeps"):
        bpy.ops.convwass.bake_live_morph()
    assert operator.modal(context, TIMER) == {"PASS_THROUGH"}
    assert bpy.ops.convwass.keep_live_shape() == {"FINISHED"}


def test_disabling_the_addon_ends_it(press):
    _, context = press()
    ended = []
    context.window_manager.event_timer_remove = ended.append
    context.window_manager.windows = []
    live_morph.stop_live(context)
    assert ended and running_live() is None
    assert not any(obj.name.startswith("Live") for obj in bpy.data.objects)


def test_without_a_window_it_is_refused():
    two_shapes()
    with pytest.raises(RuntimeError, match="needs a window"):
        bpy.ops.convwass.live_morph("INVOKE_DEFAULT")


def test_one_shape_or_five_are_refused(press):
    context = window_context()
    context.scene, context.view_layer, context.selected_objects = bpy.context.scene, bpy.context.view_layer, []
    operator = Pressed(CONVWASS_OT_live_morph)
    assert operator.begin(context) == {"CANCELLED"}
    for place in range(5):
        bpy.ops.mesh.primitive_cube_add(location=(3 * place, 0, 0))
    context.selected_objects = list(bpy.data.objects)
    assert operator.begin(context) == {"CANCELLED"}
    assert "not 5" in operator.reports[-1][1]


def test_the_mouse_drags_the_handle(press):
    """In a view from the front that shows one unit on a hundred pixels, with the origin in the middle."""
    _, context = press()
    pad = running_live().scene.pad
    bpy.context.view_layer.update()
    view = SimpleNamespace(
        perspective_matrix=Matrix(((0.5, 0, 0, 0), (0, 0, 0.5, 0), (0, -0.01, 0, 0), (0, 0, 0, 1))),
        view_matrix=Matrix(((1, 0, 0, 0), (0, 0, 1, 0), (0, -1, 0, 0), (0, 0, 0, 1))),
        is_perspective=False,
        view_perspective="ORTHO",
    )
    region = SimpleNamespace(type="WINDOW", x=10, y=20, width=400, height=400, data=view)
    area = SimpleNamespace(type="VIEW_3D", x=10, y=20, width=400, height=400, regions=[region])
    context.window.screen.areas = [area]
    context.preferences = SimpleNamespace(system=SimpleNamespace(ui_scale=1.0))

    def event(kind, value, shift=0.0):
        place = pad.handle.matrix_world.translation
        x, y = 10 + 200 + 100 * place.x + shift, 20 + 200 + 100 * place.z
        return SimpleNamespace(type=kind, value=value, mouse_x=x, mouse_y=y)

    drag = HandleDrag(pad)
    assert not drag.takes(context, event("LEFTMOUSE", "PRESS", 60.0))
    assert drag.takes(context, event("LEFTMOUSE", "PRESS"))
    assert drag.takes(context, event("MOUSEMOVE", "NOTHING", 100 * pad.side / 4))
    assert pad.place[0] == pytest.approx(0.75, abs=1e-4)
    assert drag.takes(context, event("LEFTMOUSE", "RELEASE"))
    assert not drag.takes(context, event("MOUSEMOVE", "NOTHING", -50.0))
    assert pad.place[0] == pytest.approx(0.75, abs=1e-4)
    assert not drag.takes(context, SimpleNamespace(type="G", value="PRESS"))
