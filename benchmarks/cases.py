# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The morph's cases, one per process: ``python -m benchmarks.cases CASE OPTIONS`` prints one line of JSON."""

from __future__ import annotations

import tempfile
import threading
import time
import tracemalloc
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TypeVar

import bpy
import numpy as np
from numpy.typing import NDArray

from convwass_addon.applications.morphs import blend_solver, blending
from convwass_addon.applications.morphs.layouts import path_blends
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.bridge.files.imports import import_objects
from convwass_addon.bridge.files.output_paths import save_blend
from convwass_addon.bridge.morphs.job import MorphJob
from convwass_addon.transport import Grid, Inputs, barycenter

from .blends import ASSETS, Pair
from .processes import peak_megabytes, run_case

T = TypeVar("T")

SHAPES = ("horse", "bird")


class Stopwatch:
    """CPU seconds by stage, summed over threads; also records the threads, starts and ends of the stages."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self.threads: dict[str, set[int]] = {}
        self._first: dict[str, float] = {}
        self._last: dict[str, float] = {}
        self._lock = threading.Lock()

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Add the time of the block to the stage."""
        start, begun = time.thread_time(), time.perf_counter()
        yield
        with self._lock:
            self.threads.setdefault(name, set()).add(threading.get_ident())
            self._first[name] = min(begun, self._first.get(name, begun))
            self._last[name] = time.perf_counter()
            self.seconds[name] = self.seconds.get(name, 0.0) + time.thread_time() - start

    def span(self, name: str) -> float:
        """Return the wall seconds from the first start of a stage to its last end."""
        return self._last[name] - self._first[name]

    def timed(self, name: str, function: Callable[..., T]) -> Callable[..., T]:
        """Return the function wrapped so that its time counts for a stage."""

        def wrapped(*arguments, **options):
            with self.stage(name):
                return function(*arguments, **options)

        return wrapped


def read_shapes() -> list[bpy.types.Object]:
    """Open an empty scene and add the two shapes."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    return [obj for name in SHAPES for obj in import_objects(ASSETS / f"{name}.ply", None)]


def single(cells: int, blur: float | None, sharpness: float) -> dict[str, object]:
    """Solve one barycenter from a cold start, then again with memory tracing."""
    sigma = cells / 40 if blur is None else blur
    pair = Pair.read([ASSETS / f"{name}.ply" for name in SHAPES], cells, sigma)
    domain = pair.lattice.grid(sigma)
    start = time.process_time()
    found = barycenter(pair.densities, [0.5, 0.5], domain, sharpness=sharpness)
    report = {
        "cpu": time.process_time() - start,
        "iterations": found.iterations,
        "error": found.marginal_error,
        "numerics": found.numerics,
        "peak": peak_megabytes(),
    }
    # Tracing takes time, and a kernel already used has allocated its scratch arrays.
    del found
    held = _bytes_at_peak(pair.densities, pair.lattice.grid(sigma), sharpness)
    return {**report, "bytes_per_cell": held / domain.cells}


def _bytes_at_peak(densities: NDArray[np.float32], domain: Grid, sharpness: float) -> int:
    """Count NumPy's memory at the peak of preparing two shapes and solving one barycenter, including the shapes."""
    tracemalloc.start()
    inputs = Inputs.of(densities, domain)
    # The voxelized shapes exist while the inputs are prepared; afterwards a morph drops them.
    preparing = tracemalloc.get_traced_memory()[1] + densities.nbytes
    tracemalloc.reset_peak()
    barycenter(inputs, [0.5, 0.5], domain, sharpness=sharpness)
    return max(preparing, tracemalloc.get_traced_memory()[1])


def path(cells: int, frames: int) -> dict[str, object]:
    """Bake a morph from objects to a file."""
    watch = Stopwatch()
    wall, cpu = time.perf_counter(), time.process_time()
    with watch.stage("read"):
        inputs = read_shapes()
        blends = path_blends(len(inputs), frames)
        settings = MorphSettings(resolution=cells, motion="transport")
        job = MorphJob(inputs, blends, settings, {"layout": "PATH", "frames": frames}, 1)
    blend_solver.barycenter = watch.timed("solve", blend_solver.barycenter)
    blending.extract_surface = watch.timed("surface", blending.extract_surface)
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
        "solve_wall": watch.span("solve"),
        "workers": len(watch.threads["solve"]),
        "cpu": time.process_time() - cpu,
        "wall": time.perf_counter() - wall,
        "peak": peak_megabytes(),
    }


if __name__ == "__main__":
    run_case(single, path)
