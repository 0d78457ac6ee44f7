# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Morph meshes of any topology: solids as distributions, Wasserstein barycenters, surfaces.

Section 7 of Solomon et al. 2015, "Shape interpolation": every shape is the normalized indicator of its interior, blends
are barycenters, and a level set of each barycenter is the blended shape.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from concurrent.futures import Executor
from contextlib import ExitStack
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...geometry.mesh import TriangleMesh
from ...geometry.orientation import orient_outward
from ...progress import UNINTERRUPTED, Control, Progress, Work, within
from ...sentence import Sentence
from ..far_meshes import refuse_far
from ..memory import check_memory, fitting_beside
from ..motions.choosing import chosen_motion
from ..motions.guides import Guide
from ..workers import frame_workers
from .frame_cache import BakeCache, FrameCache
from .glance import glance
from .layouts import Blend
from .morph_problem import MorphFrame, MorphProblem
from .morph_settings import MorphSettings
from .moving_problem import MovingProblem
from .part_labels import FaceLabels, Matching, matched, unparted
from .parts import joined, voxelized_parts
from .runs import (
    RUN_LENGTH,
    Run,
    SketchedRuns,
    SolvedRun,
    as_sketched,
    as_solved,
    moving_runs_in_threads,
    runs_elsewhere,
    runs_in_threads,
    runs_of,
    sketched_runs_in_threads,
)
from .volumes import Lattice, fitting_workers

VOXEL_SHARE = 0.08
"""Share of the progress that voxelizing takes."""

# That of previews, where there are any, and of the motion.
_PREVIEW_SHARE, _MOTION_SHARE = 0.12, 0.3


@dataclass(frozen=True)
class MorphPreview:
    """What a frame that is not finished yet will look like.

    Attributes
    ----------
    frame : MorphFrame
        Its blend, with a coarse mesh.
    """

    frame: MorphFrame


def morph(
    shapes: Sequence[TriangleMesh],
    names: Sequence[str],
    blends: Sequence[Blend],
    settings: MorphSettings,
    control: Control = UNINTERRUPTED,
    *,
    labels: Sequence[FaceLabels] | None = None,
    guides: Sequence[Guide] = (),
    workers: int | None = None,
    executor: Executor | None = None,
    cache: FrameCache | None = None,
    wanted: range | None = None,
    previews: bool = False,
    looked_at: int = 0,
) -> Work[None]:
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
    control : Control
        Ends the job when cancelled; checked between iterations, in whatever thread computes.
    labels : sequence of FaceLabels, optional
        Parts of the shapes; those of the same name travel together.
    guides : sequence of mappings from int to int, optional
        Points that belong together: for some of the shapes, by their numbers, a vertex of each. They guide the motion.
    workers : int, optional
        Threads that compute short runs of blends side by side; by default one per processor, as far as memory allows.
    executor : concurrent.futures.Executor, optional
        Where to compute the runs instead, in other processes or on other machines;
        `control` is then checked by the one who waits for them, and runs that have begun are left to end by themselves.
        The frames are the same wherever they are computed.
    cache : FrameCache, optional
        Frames that are in it are not computed again, and those that are computed are put into it at once.
    wanted : range, optional
        Indices of blends to make; all of a run is made where one of its blends is wanted, so that frames do not depend
        on how a morph was split.
    previews : bool
        Whether to solve the coarse levels of all blends first, and yield what can be seen of them; not where an
        executor of the caller's computes, nor on a grid that has no coarser one, nor of more runs than there is memory
        for. The frames are the same.
    looked_at : int
        Number of the blend that is being looked at, of those that are made: previews near to it come first.

    Yields
    ------
    Progress
        The payloads are every finished :class:`.morph_problem.MorphFrame`, once and in the order of the blends, and
        every :class:`MorphPreview`.

    Raises
    ------
    InputError, ResourceError
        Before the first frame, where the inputs or the settings cannot work.
    """
    if workers is not None and workers < 1:
        raise InputError("There must be at least one worker.")
    for shape, name in zip(shapes, names, strict=True):
        if not len(shape.faces):
            raise InputError("{name} has no faces with an area; choose an object with a surface.", name=name)
        refuse_far(shape)
    matching = unparted(len(shapes)) if labels is None else matched(labels, names)
    runs = runs_of(blends, wanted)
    store = None if cache is None else cache.of(shapes, names, labels, settings, guides)
    missing = {index: run for index, run in enumerate(runs) if store is None or not store.holds(run)}
    with ExitStack() as stack:
        solved: Iterator[SolvedRun] = iter(())
        begun = VOXEL_SHARE
        if missing:
            side_by_side = min(workers or 1, len(missing))
            threads = workers or os.cpu_count() or 1
            if previews and executor is None:
                yield from _glanced(shapes, names, _looked_at(missing, looked_at), settings, matching, control)
            problem = yield from sketchable_problem(shapes, names, matching, settings, side_by_side, threads, control)
            outward = [orient_outward(shape) for shape in shapes]
            pairs = pairs_of(blends)
            work = chosen_motion(outward, names, pairs, settings.motion, settings.coherence, guides, control)
            choice = yield from within(work, begun, begun + _MOTION_SHARE)
            keeps = store is not None and store.keeps_potentials
            problem = replace(problem, keeps_potentials=keeps, motion=choice.record())
            most = workers or fitting_workers(problem.lattice, shapes, matching.count, threads)
            if choice.motion is not None:
                begun += _MOTION_SHARE
                still = _with_connectivity(problem, min(most, len(shapes)))
                moving = MovingProblem.of(still, choice.motion, blends, names, matching, control)
                check_memory(moving.lattice.memory(shapes, 1, matching.count), settings.resolution)
                if previews and executor is None:
                    yield from _moved_previews(moving, missing, begun, control)
                    begun += _PREVIEW_SHARE
                if executor is None:
                    fitting = workers or fitting_workers(moving.lattice, shapes, matching.count, threads)
                    pending = stack.enter_context(moving_runs_in_threads(moving, missing, control, fitting))
                else:
                    pending = stack.enter_context(runs_elsewhere(moving, missing, executor))
            elif previews and executor is None and problem.transport.sketch_depth:
                needed = problem.lattice.memory(shapes, most, matching.count)
                chosen = _previewed(missing, looked_at, problem.transport.sketch_bytes, needed)
                sketched = stack.enter_context(sketched_runs_in_threads(problem, missing, chosen, control, most))
                pending = sketched.frames
                yield from _previews(sketched, control)
                begun += _PREVIEW_SHARE
            else:
                problem = _with_connectivity(problem, min(most, len(shapes)))
                if executor is None:
                    pending = stack.enter_context(runs_in_threads(problem, missing, control, most))
                else:
                    pending = stack.enter_context(runs_elsewhere(problem, missing, executor))
            # Threads keep what they need of it.
            del problem
            solved = as_solved(pending, control)
        total = sum(map(len, runs))
        for done, frame in enumerate(in_order(runs, missing, solved, store), start=1):
            fraction = begun + (1.0 - begun) * done / total
            yield Progress(fraction, Sentence("Blend {done} of {total}", {"done": done, "total": total}), frame)


def pairs_of(blends: Sequence[Blend]) -> list[tuple[int, int]]:
    """Return which inputs occur together in some blend, the smaller number first."""
    active = {tuple(np.flatnonzero(blend.weights).tolist()) for blend in blends}
    return sorted({pair for together in active for pair in combinations(together, 2)})


def _moved_previews(problem: MovingProblem, runs: dict[int, Run], begun: float, control: Control) -> Work[None]:
    """Show the moved inputs in place of blends that are not finished yet."""
    blends = [blend for run in runs.values() for blend in run if blend.source is None]
    for done, blend in enumerate(blends, start=1):
        control.check()
        message = Sentence("Preview {done} of {total}", {"done": done, "total": len(blends)})
        yield Progress(begun + _PREVIEW_SHARE * done / len(blends), message, MorphPreview(problem.preview(blend)))


def _looked_at(runs: dict[int, Run], number: int) -> Blend | None:
    """Return the blend nearest to one of a number that is no shape as it is, if there is any."""
    blends = {index * RUN_LENGTH + place: blend for index, run in runs.items() for place, blend in enumerate(run)}
    mixed = [index for index, blend in blends.items() if blend.source is None]
    return blends[min(mixed, key=lambda index: abs(index - number))] if mixed else None


def _glanced(
    shapes: Sequence[TriangleMesh],
    names: Sequence[str],
    blend: Blend | None,
    settings: MorphSettings,
    matching: Matching,
    control: Control,
) -> Work[None]:
    """Show one blend at once, more coarsely than the other previews."""
    seen = None if blend is None else glance(shapes, names, blend, settings, matching, control)
    if seen is not None:
        yield Progress(0.0, Sentence("First glance"), MorphPreview(seen))


def _previewed(runs: dict[int, Run], looked_at: int, bytes_each: int, needed: int) -> list[int]:
    """Choose the runs to sketch, as many as there is memory for beside the job, the nearest to a blend first."""
    nearest = sorted(runs, key=lambda index: abs(index - looked_at // RUN_LENGTH))
    fitting = fitting_beside(needed, bytes_each, sum(map(len, runs.values())))
    return nearest[: np.searchsorted(np.cumsum([len(runs[index]) for index in nearest]), fitting, side="right")]


def _previews(runs: SketchedRuns, control: Control) -> Work[None]:
    total = len(runs.sketches)
    for done, frame in enumerate(as_sketched(runs, control), start=1):
        message = Sentence("Preview {done} of {total}", {"done": done, "total": total})
        yield Progress(VOXEL_SHARE + _PREVIEW_SHARE * done / total, message, MorphPreview(frame))


def prepared_problem(
    shapes: Sequence[TriangleMesh],
    names: Sequence[str],
    matching: Matching,
    settings: MorphSettings,
    workers: int,
    threads: int = 1,
    control: Control = UNINTERRUPTED,
) -> Work[MorphProblem]:
    """Report the voxelizing of the shapes, and return what all runs have in common.

    Memory must do for so many `workers`; up to so many `threads` voxelize, as far as it does for them too.
    """
    problem = yield from sketchable_problem(shapes, names, matching, settings, workers, threads, control)
    return _with_connectivity(problem, min(threads, len(shapes)))


def sketchable_problem(
    shapes: Sequence[TriangleMesh],
    names: Sequence[str],
    matching: Matching,
    settings: MorphSettings,
    workers: int,
    threads: int = 1,
    control: Control = UNINTERRUPTED,
) -> Work[MorphProblem]:
    """Do the same, and leave out what only finished blends need."""
    yield Progress(0.0, Sentence("Laying out the grid"))
    lattice = Lattice.around(shapes, settings.resolution, settings.sigma, workers, matching.count)
    control.check()

    def volumes_of(index: int) -> list[NDArray[np.float32]]:
        return voxelized_parts(shapes[index], names[index], index, lattice, settings.thickness, matching, control)

    volumes = []
    with frame_workers(fitting_workers(lattice, shapes, matching.count, min(threads, len(shapes)))) as executor:
        for index, own in enumerate(executor.map(volumes_of, range(len(shapes)))):
            volumes.append(own)
            message = Sentence("Voxelized {name}", {"name": names[index]})
            yield Progress(VOXEL_SHARE * (index + 1) / len(shapes), message)
    return MorphProblem.for_sketches(joined(matching, volumes), lattice, settings)


def _with_connectivity(problem: MorphProblem, threads: int) -> MorphProblem:
    with frame_workers(threads) as executor:
        return problem.with_connectivity(executor)


def in_order(
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
