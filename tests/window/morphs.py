# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""First steps with morphs: bake, cancel, undo, play, drag the blend pad, save and reopen."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

import bpy

if TYPE_CHECKING:
    from inside import Window


def morphs(window: Window) -> Iterator[float]:
    """Do everything in order; failures raise AssertionError."""
    yield from _opens_the_tab(window)
    yield from _bakes_to_the_end(window)
    yield from _stops_with_escape(window)
    yield from _stops_with_the_button(window)
    yield from _presses_undo_while_it_bakes(window)
    yield from _deletes_the_shapes_while_it_bakes(window)
    yield from _opens_another_file_while_it_bakes(window)
    yield from _plays(window)
    yield from _drags_the_pad(window)
    yield from _saves_and_comes_back(window)


def _opens_the_tab(window: Window) -> Iterator[float]:
    yield from _new_scene(window)
    yield from window.open_tab("Convwass")
    yield from window.picture("1 tab")
    window.say("the tab opens")


def _bakes_to_the_end(window: Window) -> Iterator[float]:
    _settings().resolution, _settings().frames = 80, 24
    yield from window.press("convwass.bake_morph")
    began, first = time.monotonic(), None
    seen, previews = set(), 0
    pictured = False
    while window.progress.running or not seen:
        if first is None and len(_meshes()) > 2:
            first = time.monotonic() - began
        seen.add(round(window.progress.fraction, 3))
        previews = max(previews, len(_meshes()))
        if previews > 2 and not pictured:
            pictured = True
            yield from window.picture("2 baking")
        yield 0.05
    assert len(seen) > 4, f"the bar stood still: {sorted(seen)}"
    assert len(window.morphs) == 1, "there is no morph after the bake"
    bpy.context.scene.frame_set(6)
    yield from window.picture("3 baked")
    window.say(f"the first picture of a blend comes {first:.1f} s after the click has been taken in")
    window.say(f"a bake by its button: the bar showed {len(seen)} values, {len(_frames(window.morphs[0]))} frames")


def _stops_with_escape(window: Window) -> Iterator[float]:
    yield from _new_scene(window)
    _settings().resolution, _settings().frames = 96, 40
    yield from window.press("convwass.bake_morph")
    yield from window.wait(lambda: window.progress.fraction > 0.3, 120, "the bake gets to a third")
    yield from window.into_view()
    yield from window.key("Escape")
    yield from window.wait(lambda: not window.progress.running, 20, "Escape stops the bake")
    yield from window.picture("4 stopped")
    kept = _frames(window.morphs[0]) if window.morphs else []
    assert 2 <= len(kept) < 41, f"{len(kept)} frames are kept after Escape"
    window.say(f"Escape stops a bake and keeps {len(kept)} frames")


def _stops_with_the_button(window: Window) -> Iterator[float]:
    yield from _new_scene(window)
    _settings().resolution, _settings().frames = 90, 40
    yield from window.press("convwass.bake_morph")
    # Previews come first, and do not say it.
    yield from window.wait(lambda: "left" in window.progress.message, 120, "the bake says how much time is left")
    yield from window.press("convwass.stop")
    yield from window.wait(lambda: not window.progress.running, 20, "the button stops the bake")
    window.say("the button stops a bake as well")


def _deletes_the_shapes_while_it_bakes(window: Window) -> Iterator[float]:
    yield from _new_scene(window)
    shapes = list(bpy.context.selected_objects)
    _settings().resolution, _settings().frames = 64, 12
    yield from window.press("convwass.bake_morph")
    yield from window.wait(lambda: window.progress.fraction > 0.2, 60, "the bake begins")
    for obj in shapes:
        bpy.data.objects.remove(obj)
    yield from window.wait(lambda: not window.progress.running, 120, "the bake ends without its shapes")
    assert len(_frames(window.morphs[0])) == 13, (
        f"{len(_frames(window.morphs[0]))} frames after the shapes were deleted"
    )
    window.say("deleting the shapes while they are baked harms nothing")


def _opens_another_file_while_it_bakes(window: Window) -> Iterator[float]:
    yield from _new_scene(window)
    _settings().resolution, _settings().frames = 96, 24
    known = set(_kept_frames())
    yield from window.press("convwass.bake_morph")
    yield from window.wait(lambda: len(set(_kept_frames()) - known) >= 4, 90, "the first frames are finished")
    yield from _new_scene(window)
    assert not window.progress.running, "a bake runs on in a file that has been closed"
    assert not window.morphs, "a bake writes into another file"
    window.say("opening another file ends a bake and harms nothing")
    kept = {path: path.stat().st_mtime_ns for path in set(_kept_frames()) - known}
    _settings().resolution, _settings().frames = 96, 24
    yield from _baked(window)
    assert len(_frames(window.morphs[0])) == 25, "the bake that goes on is not whole"
    assert all(path.stat().st_mtime_ns == written for path, written in kept.items()), "frames were computed twice"
    window.say(f"pressing the button again goes on from {len(kept)} frames that were finished")


def _presses_undo_while_it_bakes(window: Window) -> Iterator[float]:
    yield from _new_scene(window)
    bpy.ops.ed.undo_push(message="before")
    bpy.context.object.location.x += 0.1
    bpy.ops.ed.undo_push(message="moved")
    _settings().resolution, _settings().frames = 64, 12
    yield from window.press("convwass.bake_morph")
    yield from window.wait(lambda: window.progress.fraction > 0.2, 60, "the bake begins")
    yield from window.into_view()
    yield from window.key("ctrl+z")
    yield from window.wait(lambda: not window.progress.running, 90, "the bake ends after an undo")
    yield from window.picture("5 undone")
    window.say("undo while a bake runs harms nothing")


def _plays(window: Window) -> Iterator[float]:
    yield from _new_scene(window)
    _settings().resolution, _settings().frames = 48, 12
    yield from _baked(window)
    yield from window.press("convwass.make_player")
    yield 1.0
    yield from window.wait(lambda: not window.progress.running, 60, "the player is made")
    assert bpy.context.object.name.endswith("Player"), "the button makes no player"
    yield from window.picture("6 player")
    window.say("a player is made by its button")


def _drags_the_pad(window: Window) -> Iterator[float]:
    yield from _new_scene(window, count=3)
    _settings().layout, _settings().steps, _settings().resolution = "TRIANGLE", 5, 48
    yield from _baked(window)
    yield from window.press("convwass.make_blend_pad")
    yield from window.wait(lambda: any(obj.type == "EMPTY" for obj in bpy.data.objects), 60, "the pad is made")
    with window.override():
        bpy.ops.view3d.view_axis(type="FRONT")
        bpy.ops.view3d.view_all()
    yield 2.0
    empty = next(obj for obj in bpy.data.objects if obj.type == "EMPTY")
    for obj in bpy.context.selected_objects:
        obj.select_set(False)
    empty.select_set(True)
    bpy.context.view_layer.objects.active = empty
    before = _evaluated_sizes()
    x, y = window.on_screen(empty.matrix_world.translation)
    yield from window.picture("7 pad")
    yield from window.move(x, y)
    yield from window.key("g")
    for step in range(1, 5):
        yield from window.move(x + 20 * step, y - 8 * step)
    yield from window.click(x + 80, y - 32)
    yield from window.picture("8 pad dragged")
    assert _evaluated_sizes() != before, "dragging the pad's handle changes nothing"
    window.say("the blend follows the handle of the pad")


def _saves_and_comes_back(window: Window) -> Iterator[float]:
    names = sorted(obj.name for obj in bpy.data.objects)
    sizes = _evaluated_sizes()
    with TemporaryDirectory() as folder:
        path = str(Path(folder) / "pad ä.blend")
        bpy.ops.wm.save_as_mainfile(filepath=path)
        bpy.ops.wm.open_mainfile(filepath=path)
        yield 2.0
    assert sorted(obj.name for obj in bpy.data.objects) == names
    assert _evaluated_sizes() == sizes, "the file shows something else after opening"
    yield from window.open_tab("Convwass")
    yield from window.picture("9 opened again")
    window.say("saved, opened again, the same")


def _new_scene(window: Window, count: int = 2) -> Iterator[float]:
    """Start with some selected shapes side by side."""
    yield from window.empty_scene()
    makers = (bpy.ops.mesh.primitive_monkey_add, bpy.ops.mesh.primitive_torus_add, bpy.ops.mesh.primitive_cone_add)
    with window.override():
        for place, make in enumerate(makers[:count]):
            make(location=(3.0 * place, 0.0, 0.0))
        bpy.ops.object.select_all(action="SELECT")
        bpy.ops.view3d.view_all()
    yield from window.open_tab("Convwass")


def _baked(window: Window) -> Iterator[float]:
    before = len(window.morphs)
    yield from window.press("convwass.bake_morph")
    yield from window.wait(lambda: len(window.morphs) > before and not window.progress.running, 120, "the bake ends")
    yield 1.0


def _settings() -> bpy.types.PropertyGroup:
    return bpy.context.scene.convwass_morph


def _kept_frames() -> list[Path]:
    """Return the frames that the extension stores in case a bake is interrupted."""
    return list(Path(bpy.utils.extension_path_user("bl_ext.user_default.convwass", path="frames")).glob("*.frame"))


def _meshes() -> list[bpy.types.Object]:
    return [obj for obj in bpy.data.objects if obj.type == "MESH"]


def _frames(morph: bpy.types.Collection) -> list[bpy.types.Object]:
    return [obj for obj in morph.objects if "convwass_weights" in obj]


def _evaluated_sizes() -> list[int]:
    """Return the number of vertices of every visible mesh, including geometry nodes."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    depsgraph.update()
    shown = [obj.evaluated_get(depsgraph) for obj in _meshes() if obj.visible_get()]
    return [len(obj.to_mesh().vertices) for obj in shown]
