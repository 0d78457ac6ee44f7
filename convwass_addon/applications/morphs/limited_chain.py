# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Blends that are computed again one after the other, each near the one before."""

from __future__ import annotations

from collections.abc import Container, Iterable, Mapping
from dataclasses import dataclass, field

from .demands import Demand
from .layouts import Blend
from .morph_problem import MorphFrame
from .steady_topology import SteadyTopology
from .surface_steps import Chain, MeasuredSurface


@dataclass(frozen=True)
class LimitedBlend:
    """A blend that was computed again, the demand on it, and its surface."""

    frame: MorphFrame
    demand: Demand
    surface: MeasuredSurface


@dataclass
class LimitedChain:
    """A chain whose blends are limited, until one is within its limit anyway.

    If none is, the jump would only move to the end of the chain, so all blends stay as they are: the chain is given up.
    It also is if the limits change much more than a part that appears.

    Attributes
    ----------
    chain : Chain
        The chain.
    start : MeasuredSurface
        The surface that the first blend is limited by.
    most_held : float
        The largest fraction of the volume that limits may concern.
    limited : list of LimitedBlend
        The first blends of the chain.
    unchanged : MorphFrame or None
        The blend after them, which is within its limit, if it was computed.
    is_given_up : bool
        Whether all blends stay as they are.
    """

    chain: Chain
    start: MeasuredSurface
    most_held: float
    limited: list[LimitedBlend] = field(default_factory=list)
    unchanged: MorphFrame | None = None
    is_given_up: bool = False

    @property
    def is_over(self) -> bool:
        """Whether no further blend has to be limited."""
        return self.is_given_up or self.unchanged is not None

    @property
    def next(self) -> Blend | None:
        """The blend after those that have been limited."""
        return None if self.is_given_up else self.chain.blends[len(self.limited)]

    @property
    def changed(self) -> list[Blend]:
        """The blends that have been limited."""
        return [one.frame.blend for one in self.limited]

    @property
    def blends(self) -> list[Blend]:
        """The blend before the first one, those that have been limited, and the one after them."""
        return [self.chain.beside, *self.changed, self.next]

    def surfaces(self, known: Mapping[Blend, MeasuredSurface]) -> list[MeasuredSurface]:
        """Return the surfaces of these blends; the last one is known if it was limited by another chain."""
        last = known.get(self.next) or MeasuredSurface.of_blend(self.unchanged.mesh)
        return [self.start, *(one.surface for one in self.limited), last]

    def is_overtaken_by(self, others: Iterable[LimitedChain]) -> bool:
        """Whether another chain has limited the blend that this one starts from."""
        return any(self.chain.beside in other.changed for other in others)

    def demand(self, topology: SteadyTopology) -> Demand:
        """Return the demand on the next blend."""
        near = self.limited[-1].surface if self.limited else self.start
        return Demand(topology.most(self.next), near.mesh, self.chain.reach)

    def add(self, frame: MorphFrame, demand: Demand) -> None:
        """Add the next blend, computed with this demand."""
        held = frame.record.get("held")
        if not isinstance(held, int) or held <= 0:
            self.unchanged = frame
            return
        self.limited.append(LimitedBlend(frame, demand, MeasuredSurface.of_blend(frame.mesh)))
        if frame.record["held_share"] > self.most_held or len(self.limited) == len(self.chain.blends):
            self.is_given_up = True
            self.limited.clear()

    def stop_at(self, taken: Container[Blend]) -> None:
        """Drop all blends from the first one on that another chain has."""
        first = next((i for i, blend in enumerate(self.changed) if blend in taken), len(self.limited))
        del self.limited[first:]
