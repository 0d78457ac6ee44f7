# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Compute blends again under the demands of other blends, from the same barycenters."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from concurrent.futures import Executor
from contextlib import AbstractContextManager, contextmanager
from functools import partial

from ...progress import UNINTERRUPTED, Control
from ..workers import one_blas_thread
from .blending import HandOver, solve_some_blends
from .demands import Demand
from .kept_blends import KeptBlends
from .layouts import Blend
from .morph_problem import MorphFrame, MorphProblem
from .moving_problem import MovingProblem
from .runs import Pending, Run, runs_elsewhere, solved_in_threads

Asked = Mapping[Blend, Demand]
"""What is demanded of some blends."""


def solve_again(
    problem: MorphProblem | MovingProblem,
    run: Run,
    asked: Asked,
    control: Control = UNINTERRUPTED,
    kept: KeptBlends | None = None,
) -> list[MorphFrame]:
    """Compute some blends of a run again.

    Parameters
    ----------
    problem : MorphProblem or MovingProblem
        The problem of the run; the connectivity of its shapes is not needed.
    run : tuple of Blend
        The run; its blends start from each other.
    asked : mapping of Blend to Demand
        The blends, and the demand on each.
    control : Control
        Cancels the work.
    kept : KeptBlends, optional
        Blends of inputs at rest that have been solved before.

    Returns
    -------
    list of MorphFrame
        In the order of the run.
    """
    if isinstance(problem, MovingProblem):
        return problem.frames_again(run, asked, control)
    limited = [problem.demanding(asked[blend]) if blend in asked else None for blend in run]
    while limited and limited[-1] is None:
        limited.pop()
    return solve_some_blends(problem.transport, run, limited, control, kept)


def solve_again_apart(problem: MorphProblem | MovingProblem, run: Run, asked: Asked) -> list[MorphFrame]:
    """Call :func:`solve_again` in another process, with one BLAS thread."""
    with one_blas_thread():
        return solve_again(problem, run, asked)


@contextmanager
def again_in_threads(
    problem: MorphProblem | MovingProblem,
    runs: dict[int, Run],
    asked: Asked,
    control: Control,
    workers: int,
    kept: KeptBlends | None = None,
) -> Iterator[Pending]:
    """Call :func:`solve_again` for several runs in threads, if possible for every blend by itself.

    The futures of a run's blends have the same index; see :func:`.runs.solved_in_threads`.
    """

    def solve(run: Run, control: Control, _hand_over: HandOver) -> list[MorphFrame]:
        return solve_again(problem, run, asked, control, kept)

    parts = [(index, part) for index, run in runs.items() for part in _independent(problem, run, asked, kept)]
    jobs = {number: part for number, (_, part) in enumerate(parts)}
    with solved_in_threads(solve, lambda blend: float(blend in asked), jobs, control, workers) as pending:
        yield {future: parts[number][0] for future, number in pending.items()}


def _independent(problem: MorphProblem | MovingProblem, run: Run, asked: Asked, kept: KeptBlends | None) -> list[Run]:
    """Divide a run into its asked blends, unless they have to be solved from each other."""
    wanted = [blend for blend in run if blend in asked]
    if isinstance(problem, MovingProblem):
        is_divided = problem.solves_singly
    else:
        is_divided = kept is not None and all(blend in kept for blend in wanted)
    return [(blend,) for blend in wanted] if is_divided else [run]


def again_elsewhere(
    problem: MorphProblem | MovingProblem, runs: dict[int, Run], asked: Asked, executor: Executor
) -> AbstractContextManager[Pending]:
    """Call :func:`solve_again` for several runs with the caller's executor; see :func:`.runs.runs_elsewhere`."""
    return runs_elsewhere(problem, runs, executor, partial(solve_again_apart, asked=asked))
