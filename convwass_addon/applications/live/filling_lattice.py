# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A lattice of level fields that is filled from coarse to fine, and mixtures of its fields that never jump.

At every node, every level of the lattice has a weight: 0 until the node and all its neighbors are filled, then rising
to 1 within a short time. Weights are interpolated between nodes. The finest level contributes its weight, the next
coarser level its weight times the remainder, and so on. Mixtures are therefore continuous in the blend's weights and in
time.
"""

from __future__ import annotations

import threading
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from .level_fields import LevelField
from .weight_layouts import Node, WeightLayout

LEVELS = (4, 8, 16)
"""Steps from one shape to the next, from coarse to fine; each level contains the nodes of the one before."""

FINEST = 32
"""Steps where neighbors of the last level still differ by more than `FAR`."""

FAR = 0.2
"""How much neighbors may differ, as a share of their mass; beyond, mixtures show both."""

# A missing share below this is due to rounding.
_NOTHING = 1e-9


@dataclass(frozen=True)
class Wanted:
    """A node that should be filled.

    Attributes
    ----------
    node : Node
        In steps of 1 / `FINEST`.
    weights : tuple of float
        Weights of its blend.
    """

    node: Node
    weights: tuple[float, ...]


@dataclass(frozen=True)
class Mixture:
    """The fields from which a blend is mixed.

    Attributes
    ----------
    fields : tuple of LevelField
        The available fields.
    shares : tuple of float
        One per field, positive.
    rest : float
        What is missing to a sum of 1.
    """

    fields: tuple[LevelField, ...]
    shares: tuple[float, ...]
    rest: float


class FillingLattice:
    """Level fields of a layout, added by one thread while another thread mixes them.

    Parameters
    ----------
    layout : WeightLayout
        Layout of the blends.
    levels : sequence of int
        Some of `LEVELS`, from coarse to fine.
    most : int
        Maximum number of nodes that fit in memory; at least the given levels must fit without refinement.
    fade : float
        Duration in seconds of the transition to a finer level.
    far : float
        The largest difference of neighbors of the last level; where it is larger, the finest level is filled between
        them.
    """

    def __init__(self, layout: WeightLayout, levels: Sequence[int], most: int, fade: float, far: float = FAR) -> None:
        self._layout, self._most, self._fade, self._far = layout, most, fade, far
        self._fields: dict[Node, LevelField] = {}
        # Time at which a node of a level and all its neighbors were filled.
        self._since: dict[tuple[int, Node], float] = {}
        # Nodes of the finest level that should be filled.
        self._refined: dict[Node, tuple[float, ...]] = {}
        self._lock = threading.Lock()
        self.levels = tuple(levels)

    def add(self, node: Node, field: LevelField, now: float) -> None:
        """Add the field of a node, given in steps of 1 / `FINEST`, at a time in seconds."""
        with self._lock:
            self._fields[node] = field
            for steps in (*self.levels, FINEST):
                own = _in_steps(node, steps)
                for one in () if own is None else (own, *self._layout.neighbors(own, steps)):
                    if self._is_surrounded(one, steps):
                        self._since.setdefault((steps, _unit(one, steps)), now)
            if self.levels[-1] == LEVELS[-1] and self._far < np.inf:
                self._refine(node)

    def extend(self, levels: Sequence[int], now: float) -> None:
        """Add finer levels."""
        with self._lock:
            self.levels = tuple(levels)
            fields = dict(self._fields)
        for node, field in fields.items():
            self.add(node, field, now)

    def next_wanted(self, hand: Sequence[float]) -> Wanted | None:
        """Return the next node to fill: the one nearest to some weights, (k,), on the coarsest incomplete level."""
        for steps in self.levels:
            missing = [one for one in self._nodes[steps] if one.node not in self._fields]
            if missing:
                return _nearest(missing, hand)
        refined = [Wanted(node, weights) for node, weights in self._refined.items() if node not in self._fields]
        return _nearest(refined, hand) if refined else None

    def mixture(self, weights: Sequence[float], now: float) -> Mixture:
        """Return the fields from which a blend is mixed at a time in seconds."""
        with self._lock:
            shares: dict[Node, float] = {}
            rest = 1.0
            for steps in (FINEST, *reversed(self.levels)):
                stencil = self._layout.stencil(weights, steps)
                units = [_unit(node, steps) for node in stencil.nodes]
                taken = rest * sum(
                    share * self._ready(steps, node, now) for node, share in zip(units, stencil.shares, strict=True)
                )
                if taken > 0.0:
                    for node, share in zip(units, stencil.shares, strict=True):
                        shares[node] = shares.get(node, 0.0) + taken * share
                rest -= taken
                if rest < _NOTHING:
                    rest = 0.0
                    break
            return Mixture(tuple(self._fields[node] for node in shares), tuple(shares.values()), rest)

    def is_whole(self, steps: int) -> bool:
        """Return whether all nodes of a level are filled."""
        return all(one.node in self._fields for one in self._nodes[steps])

    def has_taken_over(self, now: float) -> bool:
        """Return whether this lattice alone determines all blends by now."""
        first = self.levels[0]
        return all(self._ready(first, one.node, now) == 1.0 for one in self._nodes[first])

    @property
    def filled(self) -> int:
        """Number of filled nodes."""
        return len(self._fields)

    @property
    def fraction(self) -> float:
        """Fraction of the nodes to be filled, as far as they are known, that are filled."""
        wanted = {one.node for steps in self.levels for one in self._nodes[steps]} | self._refined.keys()
        return len(self._fields) / max(len(wanted), 1)

    @property
    def bytes(self) -> int:
        """Memory that the fields take, in bytes."""
        return sum(field.nbytes for field in self._fields.values())

    @cached_property
    def _nodes(self) -> dict[int, list[Wanted]]:
        return {
            steps: [Wanted(_unit(node, steps), self._layout.weights(node, steps)) for node in self._layout.nodes(steps)]
            for steps in LEVELS
        }

    def _is_surrounded(self, node: Node, steps: int) -> bool:
        around = (node, *self._layout.neighbors(node, steps))
        return all(_unit(one, steps) in self._fields for one in around)

    def _ready(self, steps: int, node: Node, now: float) -> float:
        since = self._since.get((steps, node))
        if since is None:
            return 0.0
        return 1.0 if self._fade <= 0.0 else min(max((now - since) / self._fade, 0.0), 1.0)

    def _refine(self, node: Node) -> None:
        """Request the nodes halfway to neighbors that differ too much from a node, and the nodes around them."""
        own = _in_steps(node, LEVELS[-1])
        if own is None:
            return
        for other in self._layout.neighbors(own, LEVELS[-1]):
            field = self._fields.get(_unit(other, LEVELS[-1]))
            if field is None or field.difference(self._fields[node]) <= self._far:
                continue
            middle = tuple((a + b) // 2 for a, b in zip(node, _unit(other, LEVELS[-1]), strict=True))
            self._ask_for([middle, *self._layout.neighbors(middle, FINEST)])

    def _ask_for(self, nodes: Iterable[Node]) -> None:
        coarse = sum(len(self._nodes[steps]) for steps in self.levels)
        for node in nodes:
            if node not in self._fields and coarse + len(self._refined) < self._most:
                self._refined[node] = self._layout.weights(node, FINEST)


def fitting_levels(layout: WeightLayout, most: int) -> tuple[int, ...]:
    """Return those of `LEVELS` that need at most this many nodes, at least the first."""
    nodes: set[Node] = set()
    fitting = []
    for steps in LEVELS:
        nodes |= {_unit(node, steps) for node in layout.nodes(steps)}
        if len(nodes) <= most or not fitting:
            fitting.append(steps)
    return tuple(fitting)


def count_of_nodes(layout: WeightLayout, levels: Sequence[int]) -> int:
    """Return the number of nodes of several levels, counting shared nodes once."""
    return len({_unit(node, steps) for steps in levels for node in layout.nodes(steps)})


def _unit(node: Node, steps: int) -> Node:
    """Return a node in steps of 1 / `FINEST`."""
    return tuple(place * (FINEST // steps) for place in node)


def _in_steps(node: Node, steps: int) -> Node | None:
    """Convert a node from steps of 1 / `FINEST`; None if it is not on that level."""
    size = FINEST // steps
    return None if any(place % size for place in node) else tuple(place // size for place in node)


def _nearest(wanted: Sequence[Wanted], hand: Sequence[float]) -> Wanted:
    weights: NDArray[np.float64] = np.array([one.weights for one in wanted])
    return wanted[int(np.argmin(np.abs(weights - np.asarray(hand)).sum(axis=1)))]
