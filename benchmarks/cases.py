# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The morph's cases, one per process: ``python -m benchmarks.cases CASE OPTIONS`` prints one line of JSON."""

from __future__ import annotations

import json
import os
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TypeVar

import bpy
import numpy as np

from convwass_addon.applications import blending
from convwass_addon.applications.layouts import path_blends
from convwass_addon.applications.morph_settings import MorphSettings
from convwass_addon.applications.volumes import Lattice, voxelize
from convwass_addon.bridge.files import save_blend
from convwass_addon.bridge.imports import import_objects
from convwass_addon.bridge.job import MorphJob
from convwass_addon.bridge.objects import triangle_mesh
from convwass_addon.transport import barycenter

from .processes import peak_megabytes

T = TypeVar("T")

SHAPES = ("horse", "bird")
ASSETS = Path(__file__).resolve().parent.parent / "assets" / "shapes"


class Stopwatch:
    """CPU seconds by stage, summed over threads."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self._lock = threading.Lock()

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Add the time of the block to a stage."""
        start = time.thread_time()
        yield
        with self._lock:
            self.seconds[name] = self.seconds.get(name, 0.0) + time.thread_time() - start

    def timed(self, name: str, function: Callable[..., T]) -> Callable[..., T]:
        """Return the function with its time added to a stage."""

        def wrapped(*arguments, **options):
            with self.stage(name):
                return function(*arguments, **options)

        return wrapped


def read_shapes() -> list[bpy.types.Object]:
    """Start an empty scene with the two shapes."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    return [obj for name in SHAPES for obj in import_objects(ASSETS / f"{name}.ply", None)]


def single(cells: int, blur: float | None, sharpness: float) -> dict[str, object]:
    """Solve one barycenter from a cold start."""
    inputs = read_shapes()
    depsgraph = bpy.context.evaluated_depsgraph_get()
    shapes = [triangle_mesh(obj, depsgraph) for obj in inputs]
    sigma = cells / 40 if blur is None else blur
    lattice = Lattice.around(shapes, cells, sigma)
    densities = np.stack(list(voxelize(shapes, SHAPES, lattice, 0.0)))
    start = time.process_time()
    found = barycenter(densities, [0.5, 0.5], lattice.grid(sigma), sharpness=sharpness)
    return {
        "cpu": time.process_time() - start,
        "iterations": found.iterations,
        "error": found.marginal_error,
        "numerics": found.numerics,
        "peak": peak_megabytes(),
    }


def path(cells: int, frames: int) -> dict[str, object]:
    """Bake a morph from objects to a file."""
    watch = Stopwatch()
    wall, cpu = time.perf_counter(), time.process_time()
    with watch.stage("read"):
        inputs = read_shapes()
        blends = path_blends(len(inputs), frames)
        depsgraph = bpy.context.evaluated_depsgraph_get()
        settings = MorphSettings(resolution=cells)
        job = MorphJob(bpy.context.scene, depsgraph, inputs, blends, settings, {"layout": "PATH", "frames": frames}, 1)
    blending.barycenter = watch.timed("solve", blending.barycenter)
    blending.surface_enclosing = watch.timed("surface", blending.surface_enclosing)
    steps = job.steps()
    with watch.stage("voxelize"):
        next(steps)
        for _ in inputs:
            next(steps)
    for step in steps:
        with watch.stage("write"):
            job.write(step)
    with watch.stage("write"), tempfile.TemporaryDirectory() as folder:
        job.finish(hide_inputs=True)
        save_blend(Path(folder) / "morph.blend")
    return {
        **watch.seconds,
        "cpu": time.process_time() - cpu,
        "wall": time.perf_counter() - wall,
        "peak": peak_megabytes(),
    }


if __name__ == "__main__":
    case, options = sys.argv[1:]
    print(json.dumps({"single": single, "path": path}[case](**json.loads(options))), flush=True)
    # Blender 4.5 may wait for ever for a thread of its own when the process ends the ordinary way.
    os._exit(0)
