# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The extension is disabled during its work, and enabled again."""

from __future__ import annotations

import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

import bpy

if TYPE_CHECKING:
    from inside import Window

_EXTENSION = "bl_ext.user_default.convwass"


def disabling(window: Window) -> Iterator[float]:
    """Do everything in order; failures raise AssertionError."""
    yield from _while_it_bakes(window)
    yield from _while_it_waits_for_clicks(window)
    yield from _bakes_afterwards(window)


def _while_it_bakes(window: Window) -> Iterator[float]:
    yield from _new_scene(window)
    before = _contents()
    own = bpy.context.scene.convwass_morph
    # Must not be in the cache from another scenario, or no thread would have work.
    own.resolution, own.frames = 101, 24
    yield from window.press("convwass.bake_morph")
    progress = bpy.context.window_manager.convwass_progress
    yield from window.wait(lambda: progress.running and progress.fraction > 0.3, 120, "the bake gets to a third")
    running = _module("operators.background")._RUNNING
    assert _threads() and len(running) == 1, f"{len(running)} jobs run, and threads: {_threads()}"
    assert _contents() != before, "the bake shows nothing while it runs"
    bpy.ops.preferences.addon_disable(module=_EXTENSION)
    assert not running, "a job is known after the extension was switched off"
    yield from _nothing_is_left(window, before)
    yield from window.picture("90 off")
    window.say("switched off in the middle of a bake, nothing is left of it")
    yield from _back_again(window)


def _while_it_waits_for_clicks(window: Window) -> Iterator[float]:
    yield from _new_scene(window)
    before = _contents()
    own = bpy.context.scene.convwass_soft_map
    own.source, own.target = bpy.context.selected_objects
    with window.override():
        answer = bpy.ops.convwass.add_map_pair("INVOKE_DEFAULT")
    assert answer == {"RUNNING_MODAL"}, f"clicking pairs begins with {answer}"
    yield from window.into_view()
    waiting = _module("operators.picking")._WAITING
    assert waiting, "nothing waits for clicks"
    bpy.ops.preferences.addon_disable(module=_EXTENSION)
    assert not waiting, "something waits for clicks after the extension was switched off"
    # A remaining modal operator would consume the click.
    yield from window.click(*window.at)
    yield from _nothing_is_left(window, before)
    window.say("switched off while it waited for clicks, it waits no more")
    yield from _back_again(window)


def _bakes_afterwards(window: Window) -> Iterator[float]:
    yield from _new_scene(window)
    own = bpy.context.scene.convwass_morph
    own.resolution, own.frames = 96, 24
    yield from window.press("convwass.bake_morph")
    yield from window.wait(lambda: bool(window.morphs) and not window.progress.running, 240, "the bake ends")
    frames = [obj for obj in window.morphs[0].objects if "convwass_weights" in obj]
    assert len(frames) == 25, f"{len(frames)} frames after the extension was switched on again"
    bpy.context.scene.frame_set(12)
    yield from window.picture("91 on again")
    window.say(f"and switched on again it bakes {len(frames)} frames")


def _nothing_is_left(window: Window, before: dict[str, list[str]]) -> Iterator[float]:
    """Check that nothing of the extension remains, immediately and after Blender has continued."""
    for pause in (0.0, 1.5):
        yield pause
        assert not _threads(), f"threads go on: {_threads()}"
        assert _contents() == before, f"left in the file: {_contents()}, before: {before}"
        types = [name for name in dir(bpy.types) if name.startswith("CONVWASS_")]
        assert not types, f"classes that stay: {types}"
        assert not _handlers(), f"handlers that stay: {_handlers()}"
        assert not hasattr(bpy.types.WindowManager, "convwass_progress"), "a property stays"
        halves = [path for folder in _kept() for path in folder.glob(".convwass-*")]
        assert not halves, f"files that were not finished: {halves}"
    window.area.tag_redraw()
    yield 0.5


def _back_again(window: Window) -> Iterator[float]:
    bpy.ops.preferences.addon_enable(module=_EXTENSION)
    yield 1.0
    assert hasattr(bpy.types, "CONVWASS_OT_bake_morph"), "the extension cannot be switched on again"


def _new_scene(window: Window) -> Iterator[float]:
    yield from window.empty_scene()
    with window.override():
        bpy.ops.mesh.primitive_monkey_add()
        bpy.ops.mesh.primitive_torus_add(location=(3.0, 0.0, 0.0))
        bpy.ops.object.select_all(action="SELECT")
        bpy.ops.view3d.view_all()
    yield from window.open_tab("Convwass")


def _module(name: str) -> ModuleType:
    return sys.modules[f"{_EXTENSION}.convwass_addon.{name}"]


def _threads() -> list[str]:
    return [thread.name for thread in threading.enumerate() if thread.name.startswith("convwass")]


def _handlers() -> list[str]:
    """Return the functions of the extension that Blender would call."""
    lists = (getattr(bpy.app.handlers, name) for name in dir(bpy.app.handlers))
    calls = [call for one in lists if isinstance(one, list) for call in one]
    return [repr(call) for call in calls if "convwass" in getattr(call, "__module__", "")]


def _contents() -> dict[str, list[str]]:
    """Return the names of everything that a bake makes, and which objects are shown."""
    return {
        "objects": sorted(obj.name for obj in bpy.data.objects),
        "meshes": sorted(mesh.name for mesh in bpy.data.meshes),
        "materials": sorted(material.name for material in bpy.data.materials),
        "collections": sorted(collection.name for collection in bpy.data.collections),
        "shown": sorted(obj.name for obj in bpy.data.objects if obj.visible_get()),
    }


def _kept() -> list[Path]:
    """Return the folders of the extension's own files."""
    top = Path(bpy.utils.extension_path_user(_EXTENSION))
    return [top, *(path for path in top.rglob("*") if path.is_dir())]
