# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Compute those blends of a bake again that do not fit their neighbors."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import product

from ...geometry.level_sets.connectivity import Connectivity
from ...geometry.meshes.mesh import TriangleMesh
from ...progress import Control, Progress, Work, within
from ...sentence import Sentence
from .bake_plan import BakePlan
from .blend_problem import BlendProblem
from .demands import Demand
from .frame_cache import BakeCache
from .layouts import Blend
from .limited_chain import LimitedChain
from .morph_problem import MorphFrame
from .runs import Run, as_solved
from .solving_again import Asked
from .steady_topology import SteadyTopology, legs_of
from .surface_steps import JUMP, Chain, MeasuredSurface, SurfaceSteps, longest_step

# Distances to a neighbor, as multiples of the usual step, within which a blend is limited that repairs could not bring
# to its neighbors' topology.
_NEAR = (1.0, 0.35)
# Maximum number of times that the topology is decided and its blends are computed again.
_ROUNDS = 3
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
    problem : BlendProblem or None
        The problem shared by all blends; None if all frames came from the cache.
    control : Control
        Cancels the work.
    """

    def __init__(
        self,
        plan: BakePlan,
        runs: Sequence[Run],
        store: BakeCache | None,
        problem: BlendProblem | None,
        control: Control,
    ) -> None:
        self._plan, self._runs, self._store, self._problem, self._control = plan, runs, store, problem, control
        self._most_held = _MOST_HELD_BY_TRANSPORT if plan.settings.motion == "transport" else _MOST_HELD
        self._demands: dict[Blend, Demand] = {}
        self._surfaces: dict[Blend, MeasuredSurface] = {}

    def fitted(self, review: BakeReview) -> Work[None]:
        """Yield frames that replace earlier ones, as payloads."""
        if review.is_done():
            return
        chains = [chain for chain in review.steps.chains() if review.topology.knows(chain.blends)]
        yield from within(self._evened(chains, review), 0.0, 0.5)
        yield from within(self._steadied(review.topology), 0.5, 0.8)
        yield from within(self._matched(review), 0.8, 1.0)
        yield Progress(1.0, Sentence("Blends match their neighbors"))

    def _evened(self, chains: Sequence[Chain], review: BakeReview) -> Work[None]:
        """Limit the distances between successive blends of chains; where two meet, the first one has precedence."""
        left, reached = list(chains), 0.0
        while left:
            together = _starting_apart(left)
            end = max(1.0 - (len(left) - len(together)) / len(chains), reached)
            limited = yield from within(self._limited(together, review.topology), reached, end)
            reached, settled = end, set()
            for one in limited:
                # A chain that starts from a blend of an earlier one has to start again from its new surface.
                if one.chain.beside in settled or self._goes_on(one):
                    continue
                left.remove(one.chain)
                one.stop_at(self._demands)
                # Where chains meet, what one of them holds back appears between them.
                if one.limited and longest_step(one.surfaces(self._surfaces)) < review.steps.longest(one.blends):
                    settled.update(one.changed)
                    yield from within(self._accepted(one, review.topology), reached, reached)

    def _goes_on(self, chain: LimitedChain) -> bool:
        return not chain.is_over and chain.next not in self._demands

    def _limited(self, chains: Sequence[Chain], topology: SteadyTopology) -> Work[list[LimitedChain]]:
        """Limit the blends of several chains side by side, each as if it were the only one."""
        limited = [
            LimitedChain(chain, self._surfaces.get(chain.beside, chain.near), self._most_held) for chain in chains
        ]
        while True:
            going = [
                one for i, one in enumerate(limited) if self._goes_on(one) and not one.is_overtaken_by(limited[:i])
            ]
            if not going:
                return limited
            # Of chains that have come to the same blend, the first one computes it first.
            turns = {one.next: one for one in reversed(going)}
            asked = {blend: one.demand(topology) for blend, one in turns.items()}
            found = yield from self._made(asked)
            for blend, one in turns.items():
                one.add(found[blend], asked[blend])
                message = Sentence("Surface of blend {blend}", {"blend": blend.frame})
                yield Progress(1.0 - len(going) / len(limited), message)

    def _accepted(self, chain: LimitedChain, topology: SteadyTopology) -> Work[None]:
        """Yield the blends of a chain."""
        for one in chain.limited:
            blend = one.frame.blend
            self._demands[blend], self._surfaces[blend] = one.demand, one.surface
            topology.add(one.frame)
            yield Progress(0.0, Sentence("Surface of blend {blend}", {"blend": blend.frame}), one.frame)

    def _steadied(self, topology: SteadyTopology) -> Work[None]:
        """Reduce the number of pieces and handles of blends."""
        for attempt in range(_ROUNDS):
            asked = topology.asked()
            if not asked:
                break
            wanted = {
                blend: replace(self._demands.get(blend, Demand(most)), most=most, has=topology.has(blend))
                for blend, most in asked.items()
            }
            found = yield from self._made(wanted)
            for done, (blend, most) in enumerate(asked.items()):
                message = Sentence("Topology of blend {done} of {total}", {"done": done + 1, "total": len(asked)})
                better = topology.better(found[blend], most)
                if better is not None:
                    self._demands[blend] = wanted[blend]
                    self._surfaces[blend] = MeasuredSurface.of_blend(better.mesh)
                yield Progress((attempt + done / len(asked)) / _ROUNDS, message, better)

    def _matched(self, review: BakeReview) -> Work[None]:
        """Limit single blends that repairs could not bring to the topology of their neighbors by one of these."""
        unreached = review.topology.unreached()
        for done, (blend, most) in enumerate(unreached.items()):
            usual = review.steps.usual(blend)
            frame = None if usual is None else (yield from self._near_neighbor(blend, most, review.topology, usual))
            message = Sentence("Topology of blend {done} of {total}", {"done": done + 1, "total": len(unreached)})
            yield Progress(done / len(unreached), message, frame)

    def _near_neighbor(
        self, blend: Blend, most: Connectivity, topology: SteadyTopology, usual: float
    ) -> Work[MorphFrame | None]:
        """Return a blend with these counts, limited by one of its neighbors; None if it would have to jump."""
        beside = topology.beside(blend)
        missing = {
            one: self._demands.get(one, Demand(topology.most(one)))
            for one in (blend, *beside)
            if one not in self._surfaces
        }
        for one, frame in (yield from self._made(missing)).items():
            self._surfaces[one] = MeasuredSurface.of_blend(frame.mesh)

        def longest(own: MeasuredSurface) -> float:
            return max(longest_step([own, self._surfaces[other]]) for other in beside)

        allowed = max(JUMP * usual, longest(self._surfaces[blend]))
        for multiple, other in product(_NEAR, beside):
            demand = Demand(most, self._surfaces[other].mesh, multiple * usual, topology.has(blend))
            frame = (yield from self._made({blend: demand}))[blend]
            surface = MeasuredSurface.of_blend(frame.mesh)
            if topology.reaches(frame, most) and longest(surface) <= allowed:
                self._demands[blend], self._surfaces[blend] = demand, surface
                return topology.better(frame, most)
        return None

    def _made(self, asked: Asked) -> Work[dict[Blend, MorphFrame]]:
        """Compute frames for some demands, or load them from the cache."""
        found = self._known(asked)
        missing = {blend: demand for blend, demand in asked.items() if blend not in found}
        if not missing:
            return found
        runs = self._affected(missing)
        if self._problem is None:
            self._problem = yield from within(replace(self._plan, runs=runs).prepared(self._control), 0.0, 0.0)
        with self._plan.again(self._problem, runs, missing, self._control) as pending:
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


def _starting_apart(chains: Sequence[Chain]) -> list[Chain]:
    """Return the chains that do not start from the first blend of an earlier one."""
    return [chain for i, chain in enumerate(chains) if all(chain.beside != other.blends[0] for other in chains[:i])]
