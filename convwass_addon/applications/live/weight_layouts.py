# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Layouts of blends on lattices: along a path, in a triangle, in a square.

A node is a tuple of integers, in steps: on a path its position, (i,), from 0 at the first shape to `steps` times the
number of legs; in a triangle its three weights, (i, j, l) of sum `steps`; in a square its position, (column, row).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ..blend_weights import one_for_each, require_positive

Node = tuple[int, ...]
# Shares below this are due to rounding.
_NOTHING = 1e-9


@dataclass(frozen=True)
class Stencil:
    """The nodes around a blend.

    Attributes
    ----------
    nodes : tuple of Node
        One to four.
    shares : tuple of float
        Interpolation weights of the nodes, positive and of sum 1.
    """

    nodes: tuple[Node, ...]
    shares: tuple[float, ...]

    @classmethod
    def of(cls, shares: dict[Node, float]) -> Stencil:
        """Leave out nodes whose share is zero up to rounding."""
        kept = {node: share for node, share in shares.items() if share > _NOTHING}
        total = sum(kept.values())
        return cls(tuple(kept), tuple(share / total for share in kept.values()))


class WeightLayout(Protocol):
    """The positions of all blends of some shapes.

    Attributes
    ----------
    count : int
        Number of shapes.
    """

    count: int

    def nodes(self, steps: int) -> list[Node]:
        """Return all nodes of a lattice with this many steps from one shape to the next."""
        ...

    def weights(self, node: Node, steps: int) -> tuple[float, ...]:
        """Return the weights of a node, which are exactly 1 at a shape."""
        ...

    def stencil(self, weights: Sequence[float], steps: int) -> Stencil:
        """Return the nodes around weights, which are not negative and of sum 1."""
        ...

    def neighbors(self, node: Node, steps: int) -> list[Node]:
        """Return the nodes that occur in a stencil together with a node."""
        ...


def layout_of(count: int) -> WeightLayout:
    """Return the layout of the blends that a pad of two to four shapes shows.

    Raises
    ------
    InputError
        The number of shapes is not two to four.
    """
    layouts = {2: PathLayout(2), 3: TriangleLayout(), 4: SquareLayout()}
    if count not in layouts:
        raise InputError("A live morph requires two, three or four shapes, not {count}.", count=count)
    return layouts[count]


def checked_weights(weights: Sequence[float], count: int) -> NDArray[np.float64]:
    """Return weights, (k,), with negative ones set to zero and scaled to sum 1.

    Raises
    ------
    InputError
        The number of weights differs from that of shapes, or they are not finite, or none is positive.
    """
    values = one_for_each(weights, count)
    if not np.isfinite(values).all():
        raise InputError("Weights must be finite numbers.")
    values = np.maximum(values, 0.0)
    require_positive(values)
    # Normalized twice, so that very large weights do not overflow.
    values /= values.max()
    return values / values.sum()


def path_weights(value: float, count: int) -> NDArray[np.float64]:
    """Return the weights, (k,), at a position on a path: 0 is the first shape, 1 the second; clamped at the ends.

    Raises
    ------
    InputError
        The position is not a number.
    """
    if math.isnan(value):
        raise InputError("The value of a morph must be a number.")
    place = min(max(float(value), 0.0), count - 1.0)
    leg = min(int(place), count - 2)
    weights = np.zeros(count)
    weights[leg], weights[leg + 1] = 1.0 - (place - leg), place - leg
    return weights


def square_weights(across: float, down: float) -> NDArray[np.float64]:
    """Return the bilinear weights, (4,), at a place in a square, 0 to 1 on both axes; the rim holds beyond it."""
    x, y = (min(max(float(value), 0.0), 1.0) for value in (across, down))
    return np.array([(1 - x) * (1 - y), x * (1 - y), (1 - x) * y, x * y])


@dataclass(frozen=True)
class PathLayout:
    """Shapes in a row: every blend mixes two neighbors."""

    count: int

    def nodes(self, steps: int) -> list[Node]:
        """Return the nodes from the first shape to the last."""
        return [(place,) for place in range(steps * (self.count - 1) + 1)]

    def weights(self, node: Node, steps: int) -> tuple[float, ...]:
        """Return the weights of a node."""
        return tuple(path_weights(node[0] / steps, self.count))

    def stencil(self, weights: Sequence[float], steps: int) -> Stencil:
        """Return the two nodes around a blend; weights that are not those of neighbors count by their mean position."""
        last = steps * (self.count - 1)
        place = float(np.dot(weights, np.arange(self.count))) * steps
        index = min(max(int(place), 0), last - 1)
        return Stencil.of({(index,): 1.0 - (place - index), (index + 1,): place - index})

    def neighbors(self, node: Node, steps: int) -> list[Node]:
        """Return the node before and the one after."""
        last = steps * (self.count - 1)
        return [(place,) for place in (node[0] - 1, node[0] + 1) if 0 <= place <= last]


@dataclass(frozen=True)
class TriangleLayout:
    """All blends of three shapes."""

    count: int = 3

    def nodes(self, steps: int) -> list[Node]:
        """Return all nodes."""
        return [(i, j, steps - i - j) for i in range(steps + 1) for j in range(steps + 1 - i)]

    def weights(self, node: Node, steps: int) -> tuple[float, ...]:
        """Return the weights of a node."""
        return tuple(part / steps for part in node)

    def stencil(self, weights: Sequence[float], steps: int) -> Stencil:
        """Return the corners of the lattice triangle around a blend."""
        scaled = np.asarray(weights) * steps
        floor = np.minimum(np.floor(scaled + _NOTHING), steps).astype(int)
        rest = np.clip(scaled - floor, 0.0, 1.0)
        # The remainder determines whether this is a node, a triangle pointing up, or one pointing down.
        missing = steps - int(floor.sum())
        if missing == 0:
            return Stencil.of({tuple(floor.tolist()): 1.0})
        steps_up = np.eye(3, dtype=int) if missing == 1 else 1 - np.eye(3, dtype=int)
        shares = rest if missing == 1 else 1.0 - rest
        corners = (tuple((floor + step).tolist()) for step in steps_up)
        return Stencil.of(dict(zip(corners, shares.tolist(), strict=True)))

    def neighbors(self, node: Node, steps: int) -> list[Node]:
        """Return the neighboring nodes, at most six."""
        moves = [(1, -1, 0), (-1, 1, 0), (1, 0, -1), (-1, 0, 1), (0, 1, -1), (0, -1, 1)]
        around = [tuple(a + b for a, b in zip(node, move, strict=True)) for move in moves]
        return [one for one in around if min(one) >= 0]


@dataclass(frozen=True)
class SquareLayout:
    """Bilinear blends of four shapes: top left, top right, bottom left, bottom right."""

    count: int = 4

    def nodes(self, steps: int) -> list[Node]:
        """Return all nodes, row by row."""
        return [(column, row) for row in range(steps + 1) for column in range(steps + 1)]

    def weights(self, node: Node, steps: int) -> tuple[float, ...]:
        """Return the weights of a node."""
        return tuple(square_weights(node[0] / steps, node[1] / steps).tolist())

    def stencil(self, weights: Sequence[float], steps: int) -> Stencil:
        """Return the four nodes around a blend; weights that are not bilinear are replaced by their position."""
        axes = []
        for value in (weights[1] + weights[3], weights[2] + weights[3]):
            place = float(value) * steps
            index = min(max(int(place), 0), steps - 1)
            axes.append(((index, 1.0 - (place - index)), (index + 1, place - index)))
        columns, rows = axes
        return Stencil.of({(c, r): share * other for c, share in columns for r, other in rows})

    def neighbors(self, node: Node, steps: int) -> list[Node]:
        """Return the neighboring nodes, at most eight."""
        around = [(node[0] + x, node[1] + y) for x in (-1, 0, 1) for y in (-1, 0, 1) if x or y]
        return [one for one in around if min(one) >= 0 and max(one) <= steps]
