# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The first morph by the letter of the README, with mouse and keys only; says how many seconds each step takes."""

from __future__ import annotations

import time
from collections.abc import Iterator
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

import bpy

if TYPE_CHECKING:
    from inside import Window

# Seconds of playback that are watched.
_WATCHED = 3.0


class _Clock:
    """Says how long each step took."""

    def __init__(self, window: Window) -> None:
        self._window = window
        self._begun = self._last = time.monotonic()

    def took(self, step: str) -> None:
        now = time.monotonic()
        self._window.say(f"{now - self._last:5.1f} s  {step}")
        self._last = now

    def ended(self) -> None:
        self._window.say(f"{time.monotonic() - self._begun:5.1f} s  from the empty scene to the kept morph")


def newcomer(window: Window) -> Iterator[float]:
    """Do everything in order; failures raise AssertionError."""
    yield from _two_shapes(window)
    clock = _Clock(window)
    yield from window.into_view()
    yield from window.key("n")
    yield 0.5
    yield from window.click_tab("Convwass")
    clock.took("N, and a click on the tab Convwass")
    yield from _select_both(window)
    yield from window.picture("newcomer 1 selected")
    clock.took("a click on each of two objects")
    yield from _bake(window, clock)
    yield from _play(window)
    clock.took("Space, and it is played")
    yield from _keep(window)
    clock.took("the file is saved, and has the morph when it is opened again")
    clock.ended()


def _two_shapes(window: Window) -> Iterator[float]:
    """Start with a closed sidebar, all settings as they come, and two objects that are not selected."""
    yield from window.empty_scene()
    with window.override():
        bpy.ops.mesh.primitive_monkey_add(location=(-1.5, 0.0, 0.0))
        bpy.ops.mesh.primitive_torus_add(location=(1.5, 0.0, 0.0))
        bpy.ops.object.select_all(action="SELECT")
        bpy.ops.view3d.view_selected()
        bpy.ops.object.select_all(action="DESELECT")
    window.area.spaces.active.show_region_ui = False
    yield 1.0


def _select_both(window: Window) -> Iterator[float]:
    monkey, torus = bpy.data.objects["Suzanne"], bpy.data.objects["Torus"]
    yield from window.click(*window.on_screen(monkey.location))
    yield from window.wait(monkey.select_get, 10, "a click selects an object")
    # A torus is empty in the middle.
    from_middle = torus.location.copy()
    from_middle.x += 1.0
    yield from window.shift_click(*window.on_screen(from_middle))
    yield 0.3
    selected = {obj.name for obj in bpy.context.selected_objects}
    assert selected == {"Suzanne", "Torus"}, f"clicks select {sorted(selected)}"


def _bake(window: Window, clock: _Clock) -> Iterator[float]:
    yield from window.press("convwass.bake_morph")
    clock.took("the button Bake Morph is found and pressed")
    yield from window.wait(lambda: len(_mesh_objects()) > 2, 60, "a preview is shown")
    clock.took("the first preview is seen")
    yield from window.picture("newcomer 2 preview")
    yield from window.wait(lambda: window.morphs and not window.progress.running, 900, "the bake ends")
    clock.took("all frames are finished")
    yield from window.picture("newcomer 3 baked")


def _play(window: Window) -> Iterator[float]:
    yield from window.into_view()
    bpy.context.scene.frame_set(1)
    shown = set()
    yield from window.key("space")
    end = time.monotonic() + _WATCHED
    while time.monotonic() < end:
        shown.add(bpy.context.scene.frame_current)
        yield 0.02
    yield from window.key("space")
    yield from window.picture("newcomer 4 played")
    assert len(shown) > 3, f"Space plays nothing: only frames {sorted(shown)} were shown"


def _keep(window: Window) -> Iterator[float]:
    frames = len(window.morphs[0].objects)
    with TemporaryDirectory() as folder:
        path = f"{folder}/kept.blend"
        with window.override():
            bpy.ops.wm.save_as_mainfile(filepath=path)
            bpy.ops.wm.open_mainfile(filepath=path)
        yield 1.0
        assert len(window.morphs[0].objects) == frames, "the saved file has fewer frames"


def _mesh_objects() -> list[bpy.types.Object]:
    return [obj for obj in bpy.data.objects if obj.type == "MESH"]
