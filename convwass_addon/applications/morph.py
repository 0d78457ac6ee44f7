# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Morph meshes of any topology: solids as distributions, Wasserstein barycenters, surfaces.

Section 7 of Solomon et al. 2015, "Shape interpolation": every shape is the normalized indicator of its interior, blends
are barycenters, and a level set of each barycenter is the blended shape.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import Executor
from contextlib import ExitStack
from dataclasses import dataclass, replace

from ..errors import InputError
from ..geometry.mesh import TriangleMesh
from .blending import MorphFrame, MorphProblem
from .frame_cache import BakeCache, FrameCache
from .layouts import Blend
from .morph_settings import MorphSettings
from .parts import FaceLabels, Matching, joined, matched, part_volumes, unparted
from .runs import Run, SolvedRun, as_solved, runs_elsewhere, runs_in_threads, runs_of
from .volumes import Lattice, fitting_workers, voxelize

VOXEL_SHARE = 0.08
"""Share of the progress that voxelizing takes."""


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
    labels: Sequence[FaceLabels] | None = None,
    workers: int | None = None,
    executor: Executor | None = None,
    cache: FrameCache | None = None,
    wanted: range | None = None,
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
    labels : sequence of FaceLabels, optional
        Parts of the shapes; those of the same name travel together.
    workers : int, optional
        Threads that compute short runs of blends side by side; by default one per processor, as far as memory allows.
    executor : concurrent.futures.Executor, optional
        Where to compute the runs instead, in other processes or on other machines (:func:`.cluster.cluster_workers`);
        `check` is then called by the one who waits for them, and runs that have begun are left to end by themselves.
        The frames are the same wherever they are computed.
    cache : FrameCache, optional
        Frames that are in it are not computed again, and those that are computed are put into it at once.
    wanted : range, optional
        Indices of blends to make; all of a run is made where one of its blends is wanted, so that frames do not depend
        on how a morph was split.

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
    matching = unparted(len(shapes)) if labels is None else matched(labels, names)
    runs = runs_of(blends, wanted)
    store = None if cache is None else cache.of(shapes, names, labels, settings)
    missing = {index: run for index, run in enumerate(runs) if store is None or not store.holds(run)}
    with ExitStack() as stack:
        solved: Iterator[SolvedRun] = iter(())
        if missing:
            problem = yield from prepared_problem(shapes, names, matching, settings, min(workers or 1, len(missing)))
            problem = replace(problem, keeps_potentials=store is not None)
            if executor is None:
                most = workers or fitting_workers(problem.lattice, shapes, matching.count, os.cpu_count() or 1)
                pending = stack.enter_context(runs_in_threads(problem, missing, check, most))
            else:
                pending = stack.enter_context(runs_elsewhere(problem, missing, executor))
            # Threads keep what they need of it.
            del problem
            solved = as_solved(pending, check)
        total = sum(map(len, runs))
        for done, frame in enumerate(_in_order(runs, missing, solved, store), start=1):
            fraction = VOXEL_SHARE + (1.0 - VOXEL_SHARE) * done / total
            yield MorphStep(fraction, f"Blend {done} of {total}", frame)


def prepared_problem(
    shapes: Sequence[TriangleMesh], names: Sequence[str], matching: Matching, settings: MorphSettings, workers: int
) -> Generator[MorphStep, None, MorphProblem]:
    """Yield the steps of voxelizing the shapes for so many threads, and return what all runs have in common."""
    yield MorphStep(0.0, "Laying out the grid")
    lattice = Lattice.around(shapes, settings.resolution, settings.sigma, workers, matching.count)
    volumes = []
    for index, filled in enumerate(voxelize(shapes, names, lattice, settings.thickness)):
        corners = lattice.to_cells(shapes[index], index)
        volumes.append(part_volumes(filled, corners, matching.faces[index], matching.count))
        yield MorphStep(VOXEL_SHARE * (index + 1) / len(shapes), f"Voxelized {names[index]}")
    return MorphProblem.of(joined(matching, volumes), lattice, settings)


def _in_order(
    runs: Sequence[Run], missing: dict[int, Run], solved: Iterator[SolvedRun], store: BakeCache | None
) -> Iterator[MorphFrame]:
    """Yield the frames of all runs in their order, from the cache or as they are solved, which may be in any order."""
    ready: dict[int, list[MorphFrame]] = {}
    for index, run in enumerate(runs):
        if index not in missing:
            yield from store.load(run)
            continue
        while index not in ready:
            done = next(solved)
            if store is not None:
                store.save(run=runs[done.index], frames=done.frames)
            ready[done.index] = done.frames
        yield from ready.pop(index)
