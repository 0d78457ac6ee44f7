# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Compute those blends of a bake again that do not fit their neighbors."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from ...geometry.mesh import TriangleMesh
from ...progress import Control, Progress, Work, within
from ...sentence import Sentence
from .bake_plan import BakePlan
from .demands import Demand
from .frame_cache import BakeCache
from .kept_blends import KeptBlends
from .layouts import Blend
from .morph_problem import MorphFrame, MorphProblem
from .moving_problem import MovingProblem
from .runs import Run, as_solved
from .solving_again import Asked
from .steady_topology import SteadyTopology, legs_of
from .surface_steps import Chain, SurfaceSteps

# Maximum number of times that the topology is decided and its blends are computed again.
_ROUNDS = 3
# A blend with no more cells than this limited by its neighbor is considered unchanged.
_HELD = 2
# Limits that concern more than this fraction of the volume spoil a blend: what they hold back is then taken from the
# whole surface. On cracks of a ball that becomes a knot, they concern up to 4 %, on the hole of a cone that becomes a
# torus up to 13 %. By transport as in the paper, nothing larger than a part that appears is held back.
_MOST_HELD, _MOST_HELD_BY_TRANSPORT = 0.2, 5e-3


class BakeReview:
    """Collects all blends of a bake, and finds those that do not fit their neighbors.

    Parameters
    ----------
    blends : sequence of Blend
        All blends that are computed; only those of a path are reviewed.
    shapes : mapping of Blend to TriangleMesh
        The unblended shapes, in scene space.
    """

    def __init__(self, blends: Sequence[Blend], shapes: Mapping[Blend, TriangleMesh]) -> None:
        legs = legs_of(blends)
        self.is_needed = bool(legs)
        self.topology, self.steps = SteadyTopology(legs), SurfaceSteps(legs, shapes)

    def add(self, frame: MorphFrame) -> None:
        """Add the next frame."""
        self.topology.add(frame)
        self.steps.add(frame)

    def is_done(self) -> bool:
        """Whether all blends fit their neighbors."""
        return not self.topology.asked() and not self.steps.chains()


class Remaking:
    """Computes blends again so that surfaces do not jump and the topology changes as rarely as possible.

    Parameters
    ----------
    plan : BakePlan
        How blends are computed.
    runs : sequence of tuple of Blend
        All runs of the bake.
    store : BakeCache or None
        Frames in this cache are not computed again.
    problem : MorphProblem, MovingProblem or None
        The problem shared by all blends; None if all frames came from the cache.
    control : Control
        Cancels the work.
    kept : KeptBlends or None
        Blends of this bake that need not be solved again.
    """

    def __init__(
        self,
        plan: BakePlan,
        runs: Sequence[Run],
        store: BakeCache | None,
        problem: MorphProblem | MovingProblem | None,
        control: Control,
        kept: KeptBlends | None = None,
    ) -> None:
        self._plan, self._runs, self._store, self._problem, self._control = plan, runs, store, problem, control
        self._kept = kept
        self._most_held = _MOST_HELD_BY_TRANSPORT if plan.settings.motion == "transport" else _MOST_HELD
        self._demands: dict[Blend, Demand] = {}
        self._surfaces: dict[Blend, TriangleMesh] = {}

    def fitted(self, review: BakeReview) -> Work[None]:
        """Yield frames that replace earlier ones, as payloads."""
        if review.is_done():
            return
        chains = [chain for chain in review.steps.chains() if review.topology.knows(chain.blends)]
        for done, chain in enumerate(chains):
            yield from within(
                self._evened(chain, review.topology), 0.5 * done / len(chains), 0.5 * (done + 1) / len(chains)
            )
        yield from within(self._steadied(review.topology), 0.5, 1.0)
        yield Progress(1.0, Sentence("Blends match their neighbors"))

    def _evened(self, chain: Chain, topology: SteadyTopology) -> Work[None]:
        """Limit the distances between successive blends of a chain, until one is within its limit anyway.

        If none is, the jump would only move to the end of the chain, so all blends stay as they are. They also do if
        the limits change much more than a part that appears.
        """
        near = self._surfaces.get(chain.beside, chain.near)
        demands: dict[Blend, Demand] = {}
        frames: list[MorphFrame] = []
        for blend in chain.blends:
            if blend in self._demands:
                break
            demand = Demand(topology.most(blend), near, chain.reach)
            frame = (yield from self._made({blend: demand}))[blend]
            held = frame.record.get("held")
            if not isinstance(held, int) or held <= _HELD:
                break
            if frame.record["held_share"] > self._most_held:
                return
            demands[blend], near = demand, frame.mesh
            frames.append(frame)
            yield Progress(
                len(frames) / len(chain.blends), Sentence("Surface of blend {blend}", {"blend": blend.frame})
            )
        else:
            return
        self._demands |= demands
        for frame in frames:
            self._surfaces[frame.blend] = frame.mesh
            topology.add(frame)
            yield Progress(1.0, Sentence("Surface of blend {blend}", {"blend": frame.blend.frame}), frame)

    def _steadied(self, topology: SteadyTopology) -> Work[None]:
        """Reduce the number of pieces and handles of blends."""
        for attempt in range(_ROUNDS):
            asked = topology.asked()
            if not asked:
                break
            wanted = {
                blend: replace(self._demands.get(blend, Demand(most)), most=most) for blend, most in asked.items()
            }
            found = yield from self._made(wanted)
            for done, (blend, most) in enumerate(asked.items()):
                message = Sentence("Topology of blend {done} of {total}", {"done": done + 1, "total": len(asked)})
                yield Progress((attempt + done / len(asked)) / _ROUNDS, message, topology.better(found[blend], most))

    def _made(self, asked: Asked) -> Work[dict[Blend, MorphFrame]]:
        """Compute frames for some demands, or load them from the cache."""
        found = self._known(asked)
        missing = {blend: demand for blend, demand in asked.items() if blend not in found}
        if not missing:
            return found
        runs = self._affected(missing)
        if self._problem is None:
            self._problem = yield from within(replace(self._plan, runs=runs).prepared(self._control), 0.0, 0.0)
        with self._plan.again(self._problem, runs, missing, self._control, self._kept) as pending:
            for solved in as_solved(pending, self._control):
                for frame in solved.frames:
                    found[frame.blend] = frame
                    if self._store is not None:
                        self._store.save_again(self._runs[solved.index], frame, missing[frame.blend])
        return found

    def _known(self, asked: Asked) -> dict[Blend, MorphFrame]:
        """Return the frames that are in the cache."""
        if self._store is None:
            return {}
        found = {
            blend: self._store.load_again(run, blend, asked[blend])
            for run in self._affected(asked).values()
            for blend in run
            if blend in asked
        }
        return {blend: frame for blend, frame in found.items() if frame is not None}

    def _affected(self, blends: Iterable[Blend]) -> dict[int, Run]:
        wanted = set(blends)
        return {index: run for index, run in enumerate(self._runs) if not wanted.isdisjoint(run)}
