# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Short runs of neighboring blends: what is handed to a thread, to another process, or to another machine."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, TypeVar

from ...errors import InputError
from ...geometry.mending import Connectivity
from ...progress import Control
from ..workers import frame_workers, one_blas_thread
from .blending import HandOver, Sketch, sketch_blends, solve_blends
from .layouts import Blend
from .morph_problem import MorphFrame, MorphProblem
from .moving_problem import MovingProblem, solve_moving_blends
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

# Seconds between two looks at whether the user wants to stop.
_PATIENCE = 0.25


class SharingExecutor(Executor):
    """Runs calls on other machines; what many calls have in common is sent there once."""

    def share(self, value: object) -> Any:
        """Send something there that many calls take as an argument, and return what stands for it."""
        raise NotImplementedError


@dataclass(frozen=True)
class SolvedRun:
    """A run that is finished.

    Attributes
    ----------
    index : int
        Which of the runs it is.
    frames : list of MorphFrame
        In the order of its blends.
    """

    index: int
    frames: list[MorphFrame]


@dataclass(frozen=True)
class SketchedRuns:
    """Runs that are being solved, their sketches first.

    Attributes
    ----------
    sketches : dict
        The order of the futures of sketches; all of them are begun before the first of `frames`.
    frames : dict
        What is being solved.
    """

    sketches: dict[Future[Sketch], int]
    frames: Pending


def runs_of(blends: Sequence[Blend], wanted: range | None = None) -> list[Run]:
    """Cut blends into runs, always at the same places.

    Parameters
    ----------
    blends : sequence of Blend
        All of them.
    wanted : range, optional
        Indices of blends; only the runs that hold some of them are returned, and these are whole.

    Raises
    ------
    InputError
        Indices of blends that do not exist, or none at all.
    """
    if wanted is not None and not (len(wanted) and wanted[0] >= 0 and wanted[-1] < len(blends)):
        raise InputError("The frames asked for must lie between 0 and {last}.", last=len(blends) - 1)
    starts = range(0, len(blends), RUN_LENGTH)
    if wanted is not None:
        starts = starts[wanted[0] // RUN_LENGTH : wanted[-1] // RUN_LENGTH + 1]
    return [tuple(blends[start : start + RUN_LENGTH]) for start in starts]


@contextmanager
def runs_in_threads(problem: MorphProblem, runs: dict[int, Run], control: Control, workers: int) -> Iterator[Pending]:
    """Solve runs of a morph of solids in threads; see :func:`solved_in_threads`."""

    def solve(run: Run, control: Control, hand_over: HandOver) -> list[MorphFrame]:
        return solve_blends(problem, run, control, None, hand_over)

    with solved_in_threads(solve, problem.transport.effort, runs, control, workers) as pending:
        yield pending


@contextmanager
def solved_in_threads(
    solve: RunSolver,
    effort: Callable[[Blend], float],
    runs: dict[int, Run],
    control: Control,
    workers: int,
) -> Iterator[Pending]:
    """Solve runs in threads, which stop between two iterations once nobody waits for them any more.

    The longest comes first, so that it is not left over when the others are done; these come in order, since what is
    made of them begins with the first.

    Parameters
    ----------
    solve : callable
        Makes the frames of one run.
    effort : callable
        Estimates how long a blend takes beside others.
    runs : dict
        All of them.
    control : Control
        Ends the work when cancelled.
    workers : int
        How many threads.
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
    problem: MorphProblem,
    runs: dict[int, Run],
    sketched: Sequence[int],
    control: Control,
    workers: int,
) -> Iterator[SketchedRuns]:
    """Do the same for a problem with coarser levels, those of some runs before the finest of any.

    Parameters
    ----------
    problem : MorphProblem
        Without the connectivity of its shapes, which is read after the sketches.
    runs : dict
        All of them.
    sketched : sequence of int
        Indices of those that are sketched: the first blend of each, in this order, then the second of each, and so on,
        so that the whole of a morph is seen early.
    control, workers
        As for :func:`runs_in_threads`.
    """
    with _threads(control, workers) as (executor, own):
        spare = SpareThreads(executor, len(runs), workers - 1)
        yield _begun(executor, problem, runs, sketched, own, spare)


def _begun(
    executor: Executor,
    problem: MorphProblem,
    runs: dict[int, Run],
    sketched: Sequence[int],
    control: Control,
    spare: SpareThreads,
) -> SketchedRuns:
    """Hand everything to an executor in the order in which it is to be done; nothing but what waits keeps a sketch."""
    # Threads take up work in this order: where it waits for other work, another thread is at that.
    chains = {index: sketch_blends(problem, runs[index], control) for index in sketched}
    sketches: dict[int, list[Future[Sketch]]] = {index: [] for index in sketched}
    for place in range(RUN_LENGTH):
        for index in sketched:
            if place < len(runs[index]):
                sketches[index].append(executor.submit(_next_sketch, chains[index], sketches[index][-1:]))
    connectivity = [
        executor.submit(problem.shape_connectivity, index) for index in range(len(problem.transport.volumes))
    ]
    frames = {
        executor.submit(_solve_sketched, problem, run, control, spare, connectivity, sketches.get(index)): index
        for index, run in runs.items()
    }
    rounds = [own[place] for place in range(RUN_LENGTH) for own in sketches.values() if place < len(own)]
    return SketchedRuns({future: number for number, future in enumerate(rounds)}, frames)


def _next_sketch(chain: Iterator[Sketch], before: Sequence[Future[Sketch]]) -> Sketch:
    """Take the next sketch of a run, once the one before is there."""
    for one in before:
        one.result()
    return next(chain)


def _solve_sketched(
    problem: MorphProblem,
    run: Run,
    control: Control,
    spare: SpareThreads,
    connectivity: Sequence[Future[Connectivity]],
    sketches: Sequence[Future[Sketch]] | None,
) -> list[MorphFrame]:
    known = None if sketches is None else [sketch.result() for sketch in sketches]
    whole = replace(problem, connectivity=tuple(shape.result() for shape in connectivity), meshes=())
    spare.begin()
    return solve_blends(whole, run, control, known, spare.hand_over)


@contextmanager
def _threads(control: Control, workers: int) -> Iterator[tuple[Executor, Control]]:
    """Provide threads and their control, which is cancelled once the context ends."""
    own = Control(control)
    with frame_workers(workers) as executor:
        try:
            yield executor, own
        finally:
            # Before the threads are waited for.
            own.cancel()


@contextmanager
def moving_runs_in_threads(
    problem: MovingProblem, runs: dict[int, Run], control: Control, workers: int
) -> Iterator[Pending]:
    """Solve runs of a morph whose inputs move in threads; see :func:`solved_in_threads`."""
    with solved_in_threads(partial(solve_moving_blends, problem), problem.effort, runs, control, workers) as pending:
        yield pending


@contextmanager
def runs_elsewhere(
    problem: MorphProblem | MovingProblem,
    runs: dict[int, Run],
    executor: Executor,
    solve: Callable[[MorphProblem | MovingProblem, Run], list[MorphFrame]] | None = None,
) -> Iterator[Pending]:
    """Solve runs wherever an executor of the caller's does; in the end those that have not begun are cancelled.

    Other processes call `solve`, by default :func:`solve_apart`.
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


def solve_apart(problem: MorphProblem | MovingProblem, run: Run) -> list[MorphFrame]:
    """Solve a run in a process that may not be ours: BLAS keeps to one thread meanwhile."""
    solve = solve_moving_blends if isinstance(problem, MovingProblem) else solve_blends
    with one_blas_thread():
        return solve(problem, run)


def as_solved(pending: Pending, control: Control) -> Iterator[SolvedRun]:
    """Take runs out of `pending` as they are finished, in any order.

    Parameters
    ----------
    pending : dict
        What `runs_in_threads` or `runs_elsewhere` provided.
    control : Control
        Ends the waiting when cancelled.

    Raises
    ------
    Exception
        What a run raised.
    """
    for index, future in _as_completed(pending, control):
        yield SolvedRun(index, future.result())


def as_sketched(runs: SketchedRuns, control: Control) -> Iterator[MorphFrame]:
    """Take sketches out of `runs` as each is finished, and yield those that can be looked at."""
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
