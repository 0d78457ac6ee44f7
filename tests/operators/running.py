# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Run operators, also as in a window, which a context stands in for, and list what they leave behind."""

from __future__ import annotations

import inspect
import itertools
import threading
import time
from types import MethodType, SimpleNamespace

import bpy
import pytest

from convwass_addon.operators import background

TIMER = SimpleNamespace(type="TIMER", value="NOTHING")
ESCAPE = SimpleNamespace(type="ESC", value="PRESS")


def call(operator, /, *how, **arguments):
    return getattr(bpy.ops.convwass, operator)(*how, **arguments)


def inventory():
    """Return all that an operator could leave behind: data-blocks, and on every object groups and modifiers.

    Blender links brushes from its own libraries whenever it likes.
    """
    own_blocks = (block for block in bpy.data.user_map() if block.library is None and block.id_type != "LIBRARY")
    blocks = {(block.id_type, block.name) for block in own_blocks}
    own = {
        obj.name: (obj.vertex_groups.keys(), obj.modifiers.keys(), sorted(obj.data.attributes.keys()))
        for obj in bpy.data.objects
        if obj.type == "MESH"
    }
    return blocks, own


class Pressed:
    """An operator between two events: its own methods, and default arguments but for those that are given."""

    def __init__(self, kind, **arguments):
        self.reports = []
        self._kind = kind
        self.arguments = arguments
        self._defaults = getattr(bpy.ops.convwass, kind.bl_idname.split(".")[1]).get_rna_type().properties

    def report(self, kind, message):
        self.reports.append((next(iter(kind)), message))

    def __getattr__(self, name):
        if name in self.arguments:
            return self.arguments[name]
        found = inspect.getattr_static(self._kind, name, None)
        if inspect.isfunction(found):
            return MethodType(found, self)
        if name in self._defaults:
            return self._defaults[name].default
        if found is not None:
            return found
        raise AttributeError(name)


def window_context():
    """Return a context with a window, a timer and a place for the progress."""
    manager = SimpleNamespace(
        convwass_progress=SimpleNamespace(running=False, stopping=False),
        event_timer_add=lambda seconds, window: "timer",
        event_timer_remove=lambda timer: None,
        modal_handler_add=lambda operator: None,
    )
    window = SimpleNamespace(
        screen=SimpleNamespace(areas=[]),
        modal_operators=[],
        cursor_modal_set=lambda cursor: None,
        cursor_modal_restore=lambda: None,
    )
    return SimpleNamespace(
        window_manager=manager,
        window=window,
        workspace=SimpleNamespace(status_text_set=lambda text: None, session_uid=0),
        scene=bpy.context.scene,
        object=bpy.context.object,
        collection=bpy.context.collection,
        view_layer=bpy.context.view_layer,
        preferences=bpy.context.preferences,
        evaluated_depsgraph_get=bpy.context.evaluated_depsgraph_get,
    )


def pretend_window(monkeypatch, module=background):
    """Let a module of operators take this Blender for one with a window."""
    fake = SimpleNamespace(app=SimpleNamespace(background=False), ops=bpy.ops, types=bpy.types)
    monkeypatch.setattr(module, "bpy", fake)


def started(pressed, context):
    """Start an operator as in a Blender with a window; return whether it continues in the background."""
    with pytest.MonkeyPatch.context() as patch:
        pretend_window(patch)
        return pressed.invoke(context, None) == {"RUNNING_MODAL"}


def is_computing():
    """Tell whether the thread of a job is still at work."""
    return any(thread.name == "convwass" for thread in threading.enumerate())


def wait_for_the_thread():
    """Wait until the thread of a job has ended."""
    while is_computing():
        time.sleep(0.01)


def write_one_at_a_time(monkeypatch):
    """Let a second pass whenever an operator looks at the clock, so that it writes one report per timer event."""
    clock = itertools.count(0.0, 1.0)
    monkeypatch.setattr(background, "time", SimpleNamespace(monotonic=lambda: next(clock)))


def show_other_scene(context):
    """Let the user go to another scene, which is empty; return it."""
    other = bpy.data.scenes.new("Other")
    bpy.context.window.scene = other
    context.scene, context.view_layer = other, other.view_layers[0]
    return other


def until(pressed, context, wanted=lambda: False, event=TIMER):
    """Send events, of a timer by default, until a condition holds; return the result of the last one."""
    deadline = time.monotonic() + 60
    while time.monotonic() < deadline:
        result = pressed.modal(context, event)
        if wanted() or result != {"PASS_THROUGH"}:
            return result
        time.sleep(0.005)
    pytest.fail("it takes too long")
