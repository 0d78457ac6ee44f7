# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs inside Blender's window: real mouse and keys for a scenario, which continues between redraws."""

from __future__ import annotations

import importlib
import os
import subprocess
import sys
import time
import traceback
from collections.abc import Callable, Iterator
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parent))

_ASSETS = Path(__file__).resolve().parents[2] / "assets" / "shapes"
# Seconds for Blender to process mouse or keys, and to redraw.
_REACTION = 0.25
# Step in pixels when searching for a button.
_SEARCH_STEP = 11
# Step in pixels when searching for the header of a panel.
_HEADER_STEP = 19
# Number of screens of the sidebar to search.
_PAGES = 2


class Window:
    """The window as a user has it: screen, mouse and keyboard.

    Methods that take time are generators of pauses: ``yield from window.click(x, y)``.
    """

    def __init__(self, pictures: Path) -> None:
        self.pictures = pictures
        self.editor = "VIEW_3D"
        self.at = 0.0, 0.0

    @property
    def area(self) -> bpy.types.Area:
        """The largest editor of the current kind, initially the 3D viewport."""
        areas = bpy.context.window_manager.windows[0].screen.areas
        return max((a for a in areas if a.type == self.editor), key=lambda a: a.width * a.height)

    @property
    def progress(self) -> bpy.types.PropertyGroup:
        """The progress of the extension's running job."""
        return bpy.context.window_manager.convwass_progress

    @property
    def morphs(self) -> list[bpy.types.Collection]:
        """The baked morphs."""
        return [collection for collection in bpy.data.collections if "convwass_morph" in collection]

    def region(self, kind: str) -> bpy.types.Region:
        """Return the viewport's region of a kind: "WINDOW" or, for the sidebar, "UI"."""
        return next(region for region in self.area.regions if region.type == kind)

    def override(self, kind: str = "WINDOW"):
        """Return a context in which operators find the viewport."""
        window = bpy.context.window_manager.windows[0]
        return bpy.context.temp_override(window=window, screen=window.screen, area=self.area, region=self.region(kind))

    def say(self, text: str) -> None:
        """Print a line in the log of the test."""
        print(f"* {text}", flush=True)

    def picture(self, name: str) -> Iterator[float]:
        """Save a picture of the screen."""
        yield 2 * _REACTION
        subprocess.run(["import", "-window", "root", str(self.pictures / f"{name}.png")], check=True)

    def open_tab(self, name: str) -> Iterator[float]:
        """Open a tab of the sidebar."""
        self.area.spaces.active.show_region_ui = True
        self.area.tag_redraw()
        yield 4 * _REACTION
        self.region("UI").active_panel_category = name
        self.area.tag_redraw()
        yield 4 * _REACTION

    def open_panel(self, name: str) -> Iterator[float]:
        """Find the header of a closed panel in the sidebar and open it with Ctrl, which closes all others."""
        kinds = [getattr(bpy.types, other) for other in dir(bpy.types) if other.startswith("CONVWASS_PT_")]
        drawn, drawing = [], {kind: kind.__dict__["draw"] for kind in kinds if "draw" in kind.__dict__}
        # With all other panels removed there is no other button to hit, and every header is on the screen.
        for kind in drawing:
            kind.draw = (lambda *_: drawn.append(True)) if kind.__name__ == name else (lambda *_: None)
        region = self.region("UI")
        region.tag_redraw()
        yield 4 * _REACTION
        # From below, because opening a panel, which closes all others, moves nothing above it.
        for below in [*range(region.height - 12, 12, -_HEADER_STEP)] * 2:
            if drawn:
                break
            yield from self.move(region.x + region.width / 3, self._height - region.y - region.height + below)
            yield from self._input("keydown", "ctrl", "click", 1, "keyup", "ctrl")
            yield _REACTION
        for kind, draw in drawing.items():
            kind.draw = draw
        region.tag_redraw()
        yield 4 * _REACTION
        assert drawn, f"the sidebar has no panel {name}"

    def empty_scene(self) -> Iterator[float]:
        """Open a new, empty file."""
        bpy.ops.wm.read_homefile(use_empty=False, app_template="")
        yield 1.5
        for obj in list(bpy.data.objects):
            bpy.data.objects.remove(obj)

    def import_shape(self, name: str) -> bpy.types.Object:
        """Import one of the sample shapes, and return it."""
        with self.override():
            bpy.ops.wm.ply_import(filepath=str(_ASSETS / f"{name}.ply"), forward_axis="Y", up_axis="Z")
        return bpy.context.object

    def move(self, x: float, y: float) -> Iterator[float]:
        """Move the mouse; y is measured from the top, as on the screen."""
        self.at = x, y
        yield from self._input("mousemove", round(x), round(y))

    def click(self, x: float, y: float, button: int = 1) -> Iterator[float]:
        """Move and click."""
        yield from self.move(x, y)
        yield from self._input("click", button)

    def shift_click(self, x: float, y: float) -> Iterator[float]:
        """Move and click while Shift is held."""
        yield from self.move(x, y)
        for words in (("keydown", "shift"), ("click", 1), ("keyup", "shift")):
            yield from self._input(*words)

    def drag(self, places: list[tuple[float, float]]) -> Iterator[float]:
        """Press the mouse at the first place, move through all others, and release it."""
        yield from self.move(*places[0])
        yield from self._input("mousedown", 1)
        for place in places[1:]:
            yield from self.move(*place)
        yield from self._input("mouseup", 1)

    def key(self, *names: str) -> Iterator[float]:
        """Press keys, such as "Escape" or "ctrl+z"; they apply at the position of the mouse."""
        yield from self._input("key", *names)

    def into_view(self, right: float = 0.4, down: float = 0.5) -> Iterator[float]:
        """Move the mouse into the viewport."""
        region = self.region("WINDOW")
        yield from self.move(region.x + right * region.width, self._height - region.y - (1 - down) * region.height)

    def on_screen(self, point: tuple[float, float, float]) -> tuple[float, float]:
        """Return the screen position of a point in the scene, from the top left."""
        from bpy_extras.view3d_utils import location_3d_to_region_2d

        region = self.region("WINDOW")
        seen = location_3d_to_region_2d(region, self.area.spaces.active.region_3d, point)
        return region.x + seen.x, self._height - region.y - seen.y

    def press(self, operator: str) -> Iterator[float]:
        """Find the sidebar's button for an operator by searching, scroll down if needed, and click it.

        Blender does not tell where its buttons are, but it can copy the call of the button under the mouse.
        """
        region = self.region("UI")
        for _ in range(_PAGES):
            x = region.x + region.width / 2
            for below in range(30, region.height, _SEARCH_STEP):
                yield from self.move(x, self._height - region.y - region.height + below)
                bpy.context.window_manager.clipboard = ""
                with self.override("UI"):
                    if bpy.ops.ui.copy_python_command_button.poll():
                        bpy.ops.ui.copy_python_command_button()
                if bpy.context.window_manager.clipboard.startswith(f"bpy.ops.{operator}("):
                    yield from self._input("click", 1)
                    return
            # Over a header, because the wheel changes values under the mouse.
            yield from self.move(region.x + 30, self._height - region.y - region.height + 20)
            yield from self._input("click", "--repeat", 15, 5)
        raise AssertionError(f"the sidebar shows no button for {operator}")

    def click_field(self, path: str, across: float = 1 / 3) -> Iterator[float]:
        """Find the sidebar's field of a property by searching, and click it; labels are on its left."""
        region = self.region("UI")
        for below in range(30, region.height, _SEARCH_STEP):
            yield from self.move(region.x + across * region.width, self._height - region.y - region.height + below)
            bpy.context.window_manager.clipboard = ""
            with self.override("UI"):
                if bpy.ops.ui.copy_data_path_button.poll():
                    bpy.ops.ui.copy_data_path_button()
            if bpy.context.window_manager.clipboard == path:
                yield from self._input("click", 1)
                return
        raise AssertionError(f"the sidebar shows no field of {path}")

    def click_tab(self, name: str) -> Iterator[float]:
        """Find a tab of the open sidebar, and click it."""
        region = self.region("UI")
        for below in range(20, region.height, _HEADER_STEP):
            yield from self.click(region.x + region.width - 8, self._height - region.y - region.height + below)
            yield _REACTION
            if region.active_panel_category == name:
                return
        raise AssertionError(f"the sidebar has no tab {name}")

    def wait(self, until: Callable[[], bool], seconds: float, what: str) -> Iterator[float]:
        """Let Blender continue until a condition holds; fail if it takes too long."""
        end = time.monotonic() + seconds
        while not until():
            if time.monotonic() > end:
                raise AssertionError(f"{what}: not within {seconds:g} s")
            yield 0.05

    @property
    def _height(self) -> int:
        return bpy.context.window_manager.windows[0].height

    def _input(self, *words: object) -> Iterator[float]:
        # Sent while Blender's own event loop runs, because some of them wait for its answer.
        sender = subprocess.Popen(["xdotool", *map(str, words)])
        while sender.poll() is None:
            yield 0.02
        yield _REACTION


def _work(window: Window, names: list[str]) -> Iterator[float]:
    yield 1.0
    for name in names:
        scenario = importlib.import_module(name)
        yield from getattr(scenario, name)(window)


def _tick() -> float:
    try:
        return next(_STEPS)
    except StopIteration:
        code = 0
    except BaseException:
        traceback.print_exc()
        error = sys.exc_info()[1]
        _WINDOW.say(f"WRONG: {error}")
        subprocess.run(["import", "-window", "root", str(_WINDOW.pictures / "wrong.png")], check=False)
        code = 1
    sys.stdout.flush()
    # Exit without asking about unsaved files.
    os._exit(code)


_PICTURES, *_NAMES = sys.argv[sys.argv.index("--") + 1 :]
_WINDOW = Window(Path(_PICTURES))
_STEPS = _work(_WINDOW, _NAMES)
bpy.app.timers.register(_tick, first_interval=1.0, persistent=True)
