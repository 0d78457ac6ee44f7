# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The level fields of all blends of a path or sheet, from which the blends between them are mixed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from .level_fields import LevelField, MixedField, mixed
from .weight_layouts import SquareLayout, TriangleLayout, WeightLayout, checked_weights

# Stored weights are rounded to single precision.
_TOLERANCE = 1e-5


@dataclass(frozen=True)
class Between:
    """The blends from which another one is mixed.

    Attributes
    ----------
    rows : tuple of int
        Their indices.
    shares : tuple of float
        One per blend, positive, of sum 1.
    """

    rows: tuple[int, ...]
    shares: tuple[float, ...]


class BlendNodes(Protocol):
    """Solved blends, by index."""

    count: int

    def between(self, weights: NDArray[np.float64]) -> Between:
        """Return the blends around weights, which are not negative and of sum 1."""
        ...


@dataclass(frozen=True)
class PathNodes:
    """Blends along a path of shapes.

    Attributes
    ----------
    count : int
        Number of shapes.
    values : (m,) float64
        Position of each blend, increasing: 0 is the first shape, 1 the second, and so on.
    """

    count: int
    values: NDArray[np.float64]

    @classmethod
    def of(cls, weights: NDArray[np.float64]) -> PathNodes:
        """Compute positions from the weights of blends, (m, k); raises InputError if they do not increase."""
        values = np.asarray(weights) @ np.arange(weights.shape[1])
        if len(values) < 2 or (np.diff(values) <= 0).any():
            raise InputError("These blends are not a path from the first shape to the last.")
        return cls(weights.shape[1], values)

    def between(self, weights: NDArray[np.float64]) -> Between:
        """Return the two blends around a position, or the single one at an end."""
        place = float(weights @ np.arange(self.count))
        after = int(np.clip(np.searchsorted(self.values, place), 1, len(self.values) - 1))
        low, high = self.values[after - 1], self.values[after]
        share = float(np.clip((place - low) / (high - low), 0.0, 1.0))
        shares = {after - 1: 1.0 - share, after: share}
        kept = {row: own for row, own in shares.items() if own > 0.0}
        return Between(tuple(kept), tuple(kept.values()))


@dataclass(frozen=True)
class SheetNodes:
    """Blends of a complete triangular or square sheet.

    Attributes
    ----------
    layout : WeightLayout
        Layout of the sheet.
    steps : int
        Steps from one shape to the next.
    weights : (m, k) float64
        Weights of every blend.
    """

    layout: WeightLayout
    steps: int
    weights: NDArray[np.float64]

    @classmethod
    def of(cls, weights: NDArray[np.float64]) -> SheetNodes:
        """Recognize a complete sheet from the weights of its blends, (m, k), in any order; InputError if it is none."""
        rows, shapes = np.shape(weights)
        for layout in (TriangleLayout(), SquareLayout()):
            steps = next((n for n in range(1, rows) if len(layout.nodes(n)) >= rows), 0) if rows > 2 else 0
            nodes = layout.nodes(steps) if steps and layout.count == shapes else []
            if len(nodes) == rows and len(cls(layout, steps, np.asarray(weights)).rows) == rows:
                return cls(layout, steps, np.asarray(weights))
        raise InputError("These blends are not a complete sheet of three shapes in a triangle or four in a square.")

    @property
    def count(self) -> int:
        """Number of shapes."""
        return self.layout.count

    @cached_property
    def rows(self) -> dict[tuple[int, ...], int]:
        """The index of the blend at every node that has one."""
        found = {}
        for row, weights in enumerate(self.weights):
            stencil = self.layout.stencil(weights, self.steps)
            node = stencil.nodes[int(np.argmax(stencil.shares))]
            if np.allclose(self.layout.weights(node, self.steps), weights, atol=_TOLERANCE):
                found[node] = row
        return found

    def between(self, weights: NDArray[np.float64]) -> Between:
        """Return the blends around weights, at most four."""
        stencil = self.layout.stencil(weights, self.steps)
        return Between(tuple(self.rows[node] for node in stencil.nodes), stencil.shares)


@dataclass(frozen=True)
class FieldLattice:
    """Level fields of the blends of a path or sheet.

    Attributes
    ----------
    nodes : BlendNodes
        Positions of the blends.
    fields : sequence of LevelField
        One per blend.
    """

    nodes: BlendNodes
    fields: Sequence[LevelField]

    def mixed(self, weights: Sequence[float]) -> MixedField:
        """Mix the blend with any weights, (k,): negative ones count as zero, and they need not sum to 1.

        Weights outside the path or square are moved to the nearest position; see :mod:`.weight_layouts`.

        Raises
        ------
        InputError
            As for :func:`.weight_layouts.checked_weights`.
        """
        found = self.nodes.between(checked_weights(weights, self.nodes.count))
        return mixed([self.fields[row] for row in found.rows], found.shares)
