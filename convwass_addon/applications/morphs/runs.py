# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Short runs of neighboring blends: the units of work for threads, processes and other machines."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, replace
from typing import Any, TypeVar

from ...errors import InputError
from ...geometry.level_sets.connectivity import Connectivity
from ...progress import Control
from ..workers import frame_workers, one_blas_thread
from .blend_problem import BlendProblem
from .blending import HandOver, Sketch, sketch_blends, solve_blends
from .layouts import Blend
from .morph_problem import MorphFrame
from .resting_problem import RestingProblem
from .spare_threads import SpareThreads

RUN_LENGTH = 4
"""Blends that are solved one after the other, each started from the one before: enough for the first, cold one not to
weigh much, and few enough for the first frames to be there soon."""

Run = tuple[Blend, ...]
Frame = TypeVar("Frame")
RunSolver = Callable[[Run, Control, HandOver], "list[Frame]"]
"""Makes the frames of a run; checks the second argument between iterations, and gives the third what reads a frame."""
Pending = dict["Future[list[MorphFrame]]", int]
"""What is still being solved: the index of the run for each future."""

# Seconds between two checks whether the user cancelled.
_PATIENCE = 0.25


class SharingExecutor(Executor):
    """Executes calls on other machines; arguments that many calls share are sent only once."""

    def share(self, value: object) -> Any:
        """Send a value that many calls take as an argument, and return what stands for it in these calls."""
        raise NotImplementedError


@dataclass(frozen=True)
class SolvedRun:
    """A finished run.

    Attributes
    ----------
    index : int
        Index of the run.
    frames : list of MorphFrame
        In the order of its blends.
    """

    index: int
    frames: list[MorphFrame]


@dataclass(frozen=True)
class SketchedRuns:
    """Runs that are being solved, with their sketches first.

    Attributes
    ----------
    sketches : dict
        The order of each sketch by its future; all sketches are submitted before the first of `frames`.
    frames : dict
        The index of the run by its future.
    """

    sketches: dict[Future[Sketch], int]
    frames: Pending


def runs_of(blends: Sequence[Blend], wanted: range | None = None) -> list[Run]:
    """Divide blends into runs, always at the same positions.

    Parameters
    ----------
    blends : sequence of Blend
        All blends.
    wanted : range, optional
        Indices of blends; runs that contain one of them are returned as a whole.

    Raises
    ------
    InputError
        The indices are empty or out of range.
    """
    if wanted is not None and not (len(wanted) and wanted[0] >= 0 and wanted[-1] < len(blends)):
        raise InputError("The frames asked for must lie between 0 and {last}.", last=len(blends) - 1)
    starts = range(0, len(blends), RUN_LENGTH)
    if wanted is not None:
        starts = starts[wanted[0] // RUN_LENGTH : wanted[-1] // RUN_LENGTH + 1]
    return [tuple(blends[start : start + RUN_LENGTH]) for start in starts]


def runs_in_threads(
    problem: BlendProblem, runs: dict[int, Run], control: Control, workers: int
) -> AbstractContextManager[Pending]:
    """Solve runs of a morph between solids in threads; see :func:`solved_in_threads`."""
    return solved_in_threads(problem.frames, problem.effort, runs, control, workers)


@contextmanager
def solved_in_threads(
    solve: RunSolver,
    effort: Callable[[Blend], float],
    runs: dict[int, Run],
    control: Control,
    workers: int,
) -> Iterator[Pending]:
    """Solve runs in threads, which stop after the current iteration when the context is left.

    The longest run starts first, so that it is not left over when the others are finished. The others start in order,
    since frames are passed on in order.

    Parameters
    ----------
    solve : callable
        Computes the frames of one run.
    effort : callable
        Estimates the relative time that a blend takes.
    runs : dict
        All runs, by index.
    control : Control
        Cancels the work.
    workers : int
        Number of threads.
    """
    with _threads(control, workers) as (executor, own):
        spare = SpareThreads(executor, len(runs), workers - 1)
        longest = max(runs, key=lambda index: sum(map(effort, runs[index])))
        order = sorted(runs, key=lambda index: (index != longest, index))
        yield {executor.submit(_begin, solve, runs[index], own, spare): index for index in order}


def _begin(solve: RunSolver, run: Run, control: Control, spare: SpareThreads) -> list[Frame]:
    spare.begin()
    return solve(run, control, spare.hand_over)


@contextmanager
def sketched_runs_in_threads(
    problem: RestingProblem, runs: dict[int, Run], sketched: Sequence[int], control: Control, workers: int
) -> Iterator[SketchedRuns]:
    """Like :func:`runs_in_threads` for a problem with coarser levels, which are solved first for some runs.

    Parameters
    ----------
    problem : RestingProblem
        Without the connectivity of its shapes, which is determined after the sketches.
    runs : dict
        All runs, by index.
    sketched : sequence of int
        Indices of the runs to sketch: first the first blend of each, in this order, then the second of each, and so on,
        so that previews cover the whole morph early.
    control, workers
        As for :func:`runs_in_threads`.
    """
    with _threads(control, workers) as (executor, own):
        spare = SpareThreads(executor, len(runs), workers - 1)
        yield _begun(executor, problem, runs, sketched, own, spare)


def _begun(
    executor: Executor,
    problem: RestingProblem,
    runs: dict[int, Run],
    sketched: Sequence[int],
    control: Control,
    spare: SpareThreads,
) -> SketchedRuns:
    """Submit all work in the order of execution; a sketch is freed when nothing waits for it any more."""
    # Threads start work in this order, so whatever a thread waits for is already running in another one.
    still = problem.still
    chains = {index: sketch_blends(still, runs[index], control) for index in sketched}
    sketches: dict[int, list[Future[Sketch]]] = {index: [] for index in sketched}
    for place in range(RUN_LENGTH):
        for index in sketched:
            if place < len(runs[index]):
                sketches[index].append(executor.submit(_next_sketch, chains[index], sketches[index][-1:]))
    connectivity = [
        executor.submit(still.shape_connectivity, index, control) for index in range(len(still.transport.volumes))
    ]
    frames = {
        executor.submit(_solve_sketched, problem, run, control, spare, connectivity, sketches.get(index)): index
        for index, run in runs.items()
    }
    rounds = [own[place] for place in range(RUN_LENGTH) for own in sketches.values() if place < len(own)]
    return SketchedRuns({future: number for number, future in enumerate(rounds)}, frames)


def _next_sketch(chain: Iterator[Sketch], before: Sequence[Future[Sketch]]) -> Sketch:
    """Solve the next sketch of a run, after the previous one."""
    for one in before:
        one.result()
    return next(chain)


def _solve_sketched(
    problem: RestingProblem,
    run: Run,
    control: Control,
    spare: SpareThreads,
    connectivity: Sequence[Future[Connectivity]],
    sketches: Sequence[Future[Sketch]] | None,
) -> list[MorphFrame]:
    known = None if sketches is None else [sketch.result() for sketch in sketches]
    whole = replace(problem.still, connectivity=tuple(shape.result() for shape in connectivity), meshes=())
    spare.begin()
    return solve_blends(whole, run, control, known, spare.hand_over, problem.kept)


@contextmanager
def _threads(control: Control, workers: int) -> Iterator[tuple[Executor, Control]]:
    """Provide threads and a control for them, which is cancelled when the context is left."""
    own = Control(control)
    with frame_workers(workers) as executor:
        try:
            yield executor, own
        finally:
            # Leaving the executor's context waits for its threads, so cancel them first.
            own.cancel()


@contextmanager
def runs_elsewhere(
    problem: BlendProblem,
    runs: dict[int, Run],
    executor: Executor,
    solve: Callable[[BlendProblem, Run], list[MorphFrame]] | None = None,
) -> Iterator[Pending]:
    """Solve runs with the caller's executor; when the context is left, runs that have not started are cancelled.

    Other processes call `solve`, which is :func:`solve_apart` by default.
    """
    shared = executor.share(problem) if isinstance(executor, SharingExecutor) else problem
    pending: Pending = {}
    try:
        for index, run in runs.items():
            pending[executor.submit(solve or solve_apart, shared, run)] = index
        yield pending
    finally:
        for future in pending:
            future.cancel()


def solve_apart(problem: BlendProblem, run: Run) -> list[MorphFrame]:
    """Solve a run in another process, with one BLAS thread."""
    with one_blas_thread():
        return problem.frames(run)


def as_solved(pending: Pending, control: Control) -> Iterator[SolvedRun]:
    """Yield runs as they are finished, in any order, and remove them from `pending`.

    Parameters
    ----------
    pending : dict
        From `runs_in_threads` or `runs_elsewhere`.
    control : Control
        Stops waiting when cancelled.

    Raises
    ------
    Exception
        The exception that a run raised.
    """
    for index, future in _as_completed(pending, control):
        yield SolvedRun(index, future.result())


def as_sketched(runs: SketchedRuns, control: Control) -> Iterator[MorphFrame]:
    """Yield sketches that have a preview as they are finished, and remove them from `runs`."""
    for _, future in _as_completed(runs.sketches, control):
        frame = future.result().frame
        if frame.mesh is not None or frame.blend.source is not None:
            yield frame


def _as_completed(pending: dict[Future, int], control: Control) -> Iterator[tuple[int, Future]]:
    while pending:
        done, _ = wait(pending, _PATIENCE, FIRST_COMPLETED)
        control.check()
        for future in sorted(done, key=pending.__getitem__):
            yield pending.pop(future), future
