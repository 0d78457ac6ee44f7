# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Compute blends again under the demands of other blends, from the same barycenters."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from concurrent.futures import Executor
from contextlib import AbstractContextManager, contextmanager
from functools import partial

from ...progress import Control
from ..workers import one_blas_thread
from .blend_problem import BlendProblem
from .blending import HandOver
from .demands import Demand
from .layouts import Blend
from .morph_problem import MorphFrame
from .runs import Pending, Run, runs_elsewhere, solved_in_threads

Asked = Mapping[Blend, Demand]
"""What is demanded of some blends."""


def solve_again_apart(problem: BlendProblem, run: Run, asked: Asked) -> list[MorphFrame]:
    """Compute some blends of a run again in another process, with one BLAS thread."""
    with one_blas_thread():
        return problem.frames_again(run, asked)


@contextmanager
def again_in_threads(
    problem: BlendProblem, runs: dict[int, Run], asked: Asked, control: Control, workers: int
) -> Iterator[Pending]:
    """Compute some blends of several runs again in threads, if possible every blend by itself.

    The futures of a run's blends have the same index; see :func:`.runs.solved_in_threads`.
    """

    def solve(run: Run, control: Control, _hand_over: HandOver) -> list[MorphFrame]:
        return problem.frames_again(run, asked, control)

    parts = [(index, part) for index, run in runs.items() for part in _independent(problem, run, asked)]
    jobs = {number: part for number, (_, part) in enumerate(parts)}
    with solved_in_threads(solve, lambda blend: float(blend in asked), jobs, control, workers) as pending:
        yield {future: parts[number][0] for future, number in pending.items()}


def _independent(problem: BlendProblem, run: Run, asked: Asked) -> list[Run]:
    """Divide a run into its asked blends, unless they have to be solved from each other."""
    wanted = [blend for blend in run if blend in asked]
    return [(blend,) for blend in wanted] if problem.solves_singly(wanted) else [run]


def again_elsewhere(
    problem: BlendProblem, runs: dict[int, Run], asked: Asked, executor: Executor
) -> AbstractContextManager[Pending]:
    """Compute some blends of several runs again with the caller's executor; see :func:`.runs.runs_elsewhere`."""
    return runs_elsewhere(problem, runs, executor, partial(solve_again_apart, asked=asked))
