# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Blends that are computed again one after the other, each near the one before."""

from __future__ import annotations

from collections.abc import Container
from dataclasses import dataclass, field

from ...geometry.mesh import TriangleMesh
from .demands import Demand
from .layouts import Blend
from .morph_problem import MorphFrame
from .steady_topology import SteadyTopology
from .surface_steps import Chain

# A blend with no more cells than this limited by its neighbor is considered unchanged.
_HELD = 2


@dataclass
class LimitedChain:
    """A chain whose blends are limited, until one is within its limit anyway.

    If none is, the jump would only move to the end of the chain, so all blends stay as they are. They also do if the
    limits change much more than a part that appears.

    Attributes
    ----------
    chain : Chain
        The chain.
    near : TriangleMesh
        The surface that the next blend is limited by.
    most_held : float
        The largest fraction of the volume that limits may concern.
    demands : dict
        The demands on the first blends of the chain.
    frames : list of MorphFrame
        These blends.
    is_over : bool
        Whether no further blend has to be limited.
    """

    chain: Chain
    near: TriangleMesh
    most_held: float
    demands: dict[Blend, Demand] = field(default_factory=dict)
    frames: list[MorphFrame] = field(default_factory=list)
    is_over: bool = False

    @property
    def next(self) -> Blend:
        """The next blend to limit, unless the chain is over."""
        return self.chain.blends[len(self.frames)]

    def demand(self, topology: SteadyTopology) -> Demand:
        """Return the demand on the next blend."""
        return Demand(topology.most(self.next), self.near, self.chain.reach)

    def add(self, frame: MorphFrame, demand: Demand) -> None:
        """Add the next blend, computed with this demand."""
        held = frame.record.get("held")
        if not isinstance(held, int) or held <= _HELD:
            self.is_over = True
            return
        self.demands[frame.blend], self.near = demand, frame.mesh
        self.frames.append(frame)
        if frame.record["held_share"] > self.most_held or len(self.frames) == len(self.chain.blends):
            self._give_up()

    def stop_at(self, taken: Container[Blend]) -> None:
        """Drop all blends from the first one on that another chain has."""
        first = next((i for i, frame in enumerate(self.frames) if frame.blend in taken), len(self.frames))
        for frame in self.frames[first:]:
            del self.demands[frame.blend]
        del self.frames[first:]

    def _give_up(self) -> None:
        self.demands.clear()
        self.frames.clear()
        self.is_over = True
