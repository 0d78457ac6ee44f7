# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Morph meshes of any topology: solids as distributions, Wasserstein barycenters, surfaces.

Section 7 of Solomon et al. 2015, "Shape interpolation": every shape is the normalized indicator of its interior, blends
are barycenters, and a level set of each barycenter is the blended shape.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor
from contextlib import ExitStack
from dataclasses import dataclass

import numpy as np

from ..errors import Cancelled, InputError
from ..geometry.mesh import TriangleMesh
from ..transport import Inputs
from .blending import MorphFrame, MorphProblem, solve_blends
from .layouts import Blend
from .morph_settings import MorphSettings
from .volumes import Lattice, voxelize
from .workers import frame_workers

# Share of the progress that voxelizing takes.
_VOXEL_SHARE = 0.08
# Blends that are solved one after the other, each started from the one before: enough for the first, cold one not to
# weigh much, and few enough for the first frames to be there soon.
_RUN = 4


@dataclass(frozen=True)
class MorphStep:
    """One step of the job.

    Attributes
    ----------
    fraction : float
        Done share of the whole job.
    message : str
        What is being done.
    frame : MorphFrame or None
        A frame that has just been finished.
    """

    fraction: float
    message: str
    frame: MorphFrame | None = None


def morph(
    shapes: Sequence[TriangleMesh],
    names: Sequence[str],
    blends: Sequence[Blend],
    settings: MorphSettings,
    check: Callable[[], None] | None = None,
    *,
    workers: int | None = None,
    executor: Executor | None = None,
) -> Iterator[MorphStep]:
    """Make the blends of the shapes, one after the other.

    Parameters
    ----------
    shapes : sequence of TriangleMesh
        The inputs in one space; open, self-intersecting, disconnected and inside-out ones are welcome.
    names : sequence of str
        What messages call them.
    blends : sequence of Blend
        In an order in which neighbors are similar: each solve starts from the one before.
    settings : MorphSettings
        How.
    check : callable, optional
        Called between iterations, in whatever thread computes; what it raises (:class:`.errors.Cancelled`) ends the
        job at once.
    workers : int, optional
        Threads that compute short runs of blends side by side; by default one per processor.
    executor : concurrent.futures.Executor, optional
        Where to compute the runs instead, in other processes or on other machines; `check` is then called between runs.
        The frames are the same wherever they are computed.

    Yields
    ------
    MorphStep
        Progress, and every finished frame once.

    Raises
    ------
    InputError, ResourceError
        Before the first frame, where the inputs or the settings cannot work.
    """
    if workers is not None and workers < 1:
        raise InputError("There must be at least one worker.")
    yield MorphStep(0.0, "Laying out the grid")
    lattice = Lattice.around(shapes, settings.resolution, settings.sigma)
    densities = []
    for index, filled in enumerate(voxelize(shapes, names, lattice, settings.thickness)):
        densities.append(filled)
        yield MorphStep(_VOXEL_SHARE * (index + 1) / len(shapes), f"Voxelized {names[index]}")
    volumes = np.array([float(filled.sum(dtype=np.float64)) for filled in densities])
    problem = MorphProblem(Inputs.of(densities, lattice.grid(settings.sigma)), volumes, lattice, settings)
    del densities, filled
    with ExitStack() as stack:
        if executor is None:
            frames = _in_threads(problem, blends, check, workers, stack)
        else:
            frames = _elsewhere(problem, blends, check, executor)
        for done, frame in enumerate(frames, start=1):
            fraction = _VOXEL_SHARE + (1.0 - _VOXEL_SHARE) * done / len(blends)
            yield MorphStep(fraction, f"Blend {done} of {len(blends)}", frame)


def _in_threads(
    problem: MorphProblem,
    blends: Sequence[Blend],
    check: Callable[[], None] | None,
    workers: int | None,
    stack: ExitStack,
) -> Iterator[MorphFrame]:
    """Solve runs of blends in threads, which stop between two iterations once nobody waits for them any more."""
    abandoned = threading.Event()

    def check_both() -> None:
        if abandoned.is_set():
            raise Cancelled("Cancelled.")
        if check is not None:
            check()

    executor = stack.enter_context(frame_workers(workers))
    # Set before the threads are waited for.
    stack.callback(abandoned.set)
    for future in [executor.submit(solve_blends, problem, run, check_both) for run in _runs(blends)]:
        yield from future.result()


def _elsewhere(
    problem: MorphProblem, blends: Sequence[Blend], check: Callable[[], None] | None, executor: Executor
) -> Iterator[MorphFrame]:
    """Solve runs of blends wherever an executor of the caller's does, perhaps in other processes."""
    futures = [executor.submit(solve_blends, problem, run) for run in _runs(blends)]
    try:
        for future in futures:
            if check is not None:
                check()
            yield from future.result()
    finally:
        for future in futures:
            future.cancel()


def _runs(blends: Sequence[Blend]) -> list[Sequence[Blend]]:
    return [blends[start : start + _RUN] for start in range(0, len(blends), _RUN)]
