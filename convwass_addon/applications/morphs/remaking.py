# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Make those blends of a bake once more whose pieces or handles do not fit the blends about them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from ...progress import Control, Progress, Work, within
from ...sentence import Sentence
from .bake_plan import BakePlan
from .frame_cache import BakeCache
from .layouts import Blend
from .morph_problem import MorphFrame, MorphProblem
from .moving_problem import MovingProblem
from .runs import Run, as_solved
from .solving_again import Asked
from .steady_topology import SteadyTopology

# What cannot be made as asked is decided anew, so often.
_ROUNDS = 3


def decided_again(
    plan: BakePlan,
    runs: Sequence[Run],
    topology: SteadyTopology,
    store: BakeCache | None,
    problem: MorphProblem | MovingProblem | None,
    control: Control,
    begin: float,
) -> Work[None]:
    """Make blends again until their topology changes as seldom as it can.

    Parameters
    ----------
    plan : BakePlan
        How they are computed.
    runs : sequence of tuple of Blend
        All of them.
    topology : SteadyTopology
        Has heard of all frames.
    store : BakeCache or None
        Frames that are in it are not made again.
    problem : MorphProblem, MovingProblem or None
        What the blends have in common; None where all frames were in the cache.
    control : Control
        Ends the work when cancelled.
    begin : float
        Share of the progress that is done by then.

    Yields
    ------
    Progress
        The payloads are frames that take the place of earlier ones.
    """
    asked = topology.asked()
    if not asked:
        return
    share = (1.0 - begin) / _ROUNDS
    for attempt in range(_ROUNDS):
        start = begin + attempt * share
        known = {} if store is None else _known(store, runs, asked)
        wanted = {blend: most for blend, most in asked.items() if blend not in known}
        if wanted and problem is None:
            problem = yield from within(replace(plan, runs=_affected(runs, wanted)).prepared(control), start, start)
        if wanted:
            known |= _made(plan, problem, runs, wanted, store, control)
        for done, (blend, most) in enumerate(asked.items(), start=1):
            message = Sentence("Topology of blend {done} of {total}", {"done": done, "total": len(asked)})
            yield Progress(start + share * done / len(asked), message, topology.better(known[blend], most))
        asked = topology.asked()
        if not asked:
            break
    yield Progress(1.0, Sentence("Topology is steady"))


def _affected(runs: Sequence[Run], asked: Asked) -> dict[int, Run]:
    return {index: run for index, run in enumerate(runs) if not asked.keys().isdisjoint(run)}


def _known(store: BakeCache, runs: Sequence[Run], asked: Asked) -> dict[Blend, MorphFrame]:
    """Return those frames that are in the cache."""
    found = {
        blend: store.load_again(run, blend, asked[blend])
        for run in _affected(runs, asked).values()
        for blend in run
        if blend in asked
    }
    return {blend: frame for blend, frame in found.items() if frame is not None}


def _made(
    plan: BakePlan,
    problem: MorphProblem | MovingProblem,
    runs: Sequence[Run],
    asked: Asked,
    store: BakeCache | None,
    control: Control,
) -> dict[Blend, MorphFrame]:
    """Make frames, and put them into the cache."""
    found = {}
    with plan.again(problem, _affected(runs, asked), asked, control) as pending:
        for solved in as_solved(pending, control):
            for frame in solved.frames:
                found[frame.blend] = frame
                if store is not None:
                    store.save_again(runs[solved.index], frame, asked[frame.blend])
    return found
