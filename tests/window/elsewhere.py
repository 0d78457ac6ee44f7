# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Switch to another workspace or scene during a bake: no text remains, and the result appears where it was started."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterator
from typing import TYPE_CHECKING

import bpy

if TYPE_CHECKING:
    from inside import Window


def elsewhere(window: Window) -> Iterator[float]:
    """Do everything in order; failures raise AssertionError."""
    yield from _goes_to_another_workspace(window)
    yield from _goes_to_another_scene(window)


def _goes_to_another_workspace(window: Window) -> Iterator[float]:
    yield from _begins(window, "OBJECTS")
    yield from window.picture("1 text where it began")
    home = _window().workspace
    assert len(_written()) == 1, f"{len(_written())} workspaces have a text"
    _window().workspace = bpy.data.workspaces["Modeling"]
    yield from window.wait(lambda: home.session_uid not in _written(), 20, "the text leaves with the user")
    yield from window.picture("2 text where the user is")
    yield from window.wait(lambda: not window.progress.running, 240, "the bake ends")
    assert not _written(), "a text stays in a status bar"
    _window().workspace = home
    yield 1.0
    yield from window.picture("3 no text where it began")
    window.say("the text in the status bar goes along to another workspace, and stays in none")


def _goes_to_another_scene(window: Window) -> Iterator[float]:
    yield from _begins(window, "PLAYER")
    own, other = bpy.context.scene, bpy.data.scenes.new("Other")
    _window().scene = other
    yield from window.wait(lambda: not window.progress.running, 240, "the bake ends")
    players = [obj for obj in bpy.data.objects if "convwass_shows" in obj]
    assert len(players) == 1, f"{len(players)} players were made"
    assert players[0].users_scene == (own,), f"the player is in {players[0].users_scene}"
    assert not other.objects and other.frame_end == 250
    _window().scene = own
    yield 1.0
    yield from window.picture("4 player where it began")
    window.say("a bake that is left for another scene ends in its own, as a player")


def _begins(window: Window, output: str) -> Iterator[float]:
    """Bake two shapes with the button, long enough to switch meanwhile."""
    yield from window.empty_scene()
    with window.override():
        bpy.ops.mesh.primitive_cube_add()
        bpy.ops.mesh.primitive_torus_add(location=(3.0, 0.0, 0.0))
        bpy.ops.object.select_all(action="SELECT")
        bpy.ops.view3d.view_all()
    settings = bpy.context.scene.convwass_morph
    settings.resolution, settings.frames, settings.output = 96, 24, output
    yield from window.open_tab("Convwass")
    yield from window.press("convwass.bake_morph")
    yield from window.wait(lambda: window.progress.running and window.progress.fraction > 0.1, 60, "the bake goes on")


def _window() -> bpy.types.Window:
    return bpy.context.window_manager.windows[0]


def _written() -> set[int]:
    """Return the workspaces whose status bar has a text, according to the extension; Blender cannot tell."""
    name = next(name for name in sys.modules if name.endswith(".operators.windows"))
    return {handle.uid for handle in importlib.import_module(name)._WRITTEN}
