# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Cases of ``run.py bench files``: ``python -m benchmarks.file_cases CASE OPTIONS`` prints a report as JSON."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import bpy
import numpy as np

import convwass_addon
from convwass_addon.bridge.files.imports import import_objects
from convwass_addon.bridge.files.output_paths import save_blend

from .blends import ASSETS
from .processes import peak_megabytes, run_case

_SHAPES = ("horse", "cow")
# Operators that turn a morph into an output, with their arguments.
_MAKE: dict[str, tuple[str, dict[str, Any]]] = {
    "player, nearest blend": ("make_player", {"between": "NEAREST"}),
    "player, interpolated": ("make_player", {"between": "INTERPOLATED"}),
    "alembic": ("make_cache", {"kind": "alembic"}),
    "usd": ("make_cache", {"kind": "usd"}),
    "volume": ("make_volume", {}),
}


def bake(cells: int, frames: int, target: str) -> dict[str, object]:
    """Bake a morph by transport and save it."""
    convwass_addon.register()
    bpy.ops.wm.read_factory_settings(use_empty=True)
    for name in _SHAPES:
        for obj in import_objects(ASSETS / f"{name}.ply", None):
            obj.select_set(True)
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", frames=frames, resolution=cells, fit_range=True)
    save_blend(Path(target))
    return {}


def store(baked: str, output: str) -> dict[str, object]:
    """Create an output of a baked morph, save it, and report sizes."""
    convwass_addon.register()
    bpy.ops.wm.open_mainfile(filepath=baked)
    begun = time.process_time()
    target = Path(baked).with_name(f"{output}.blend")
    folder = target.with_suffix("")
    if output in _MAKE:
        operator, arguments = _MAKE[output]
        if operator != "make_player":
            arguments = {**arguments, "folder": str(folder)}
        getattr(bpy.ops.convwass, operator)(**arguments)
    save_blend(target)
    seconds = time.process_time() - begun
    beside = sum(file.stat().st_size for file in folder.rglob("*") if file.is_file())
    return {"file": str(target), "blend": target.stat().st_size / 1e6, "beside": beside / 1e6, "save": seconds}


def play(stored: str) -> dict[str, object]:
    """Open a file without the add-on, and show all of its frames."""
    begun = time.process_time()
    bpy.ops.wm.open_mainfile(filepath=stored)
    scene = bpy.context.scene
    _show(scene, scene.frame_start)
    opened = time.process_time() - begun
    times = []
    for frame in range(scene.frame_start + 1, scene.frame_end + 1):
        begun = time.process_time()
        _show(scene, frame)
        times.append(time.process_time() - begun)
    return {"open": opened, "frame": 1e3 * float(np.median(times)), "memory": peak_megabytes()}


def _show(scene: bpy.types.Scene, frame: int) -> None:
    """Go to a frame, and evaluate the surface of what is visible there."""
    scene.frame_set(frame)
    depsgraph = bpy.context.evaluated_depsgraph_get()
    for shown in depsgraph.object_instances:
        if shown.object.type == "MESH" and not shown.object.hide_render:
            shown.object.data.calc_loop_triangles()


def empty() -> dict[str, object]:
    """Report the memory of a Blender that has opened nothing."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    return {"memory": peak_megabytes()}


if __name__ == "__main__":
    run_case(bake, store, play, empty)
