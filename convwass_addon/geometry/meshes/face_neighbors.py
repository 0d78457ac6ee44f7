# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangles that are neighbors across an edge, and patches of those that agree."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..arrays.components import component_labels
from .edges import EdgeUse


@dataclass(frozen=True)
class FaceNeighbors:
    """Pairs of triangles at edges that only they have.

    Attributes
    ----------
    sides : (2, e) int64
        The edges as sides of both triangles, numbered as in `EdgeUse`.
    agree : (e,) bool
        Whether the orientations of the triangles agree.
    """

    sides: NDArray[np.int64]
    agree: NDArray[np.bool_]

    @classmethod
    def of(cls, use: EdgeUse) -> FaceNeighbors:
        """Find the edges of some triangles that have two."""
        paired = use.start[use.count == 2]
        sides = np.stack([use.side[paired], use.side[paired + 1]])
        return cls(sides, use.forward[paired] != use.forward[paired + 1])

    @cached_property
    def faces(self) -> NDArray[np.int64]:
        """The two triangles of every edge, (2, e)."""
        return self.sides // 3

    def among(self, chosen: NDArray[np.bool_]) -> FaceNeighbors:
        """Return neighbors that were found among the chosen triangles alone, with the numbers of all, (m,)."""
        rows = np.flatnonzero(chosen)
        left_out = rows - np.arange(len(rows))
        return FaceNeighbors(self.sides + 3 * left_out[self.faces], self.agree)

    def unless_same(self, triangles: NDArray[np.int64]) -> FaceNeighbors:
        """Return the pairs of different triangles: not those with the same three corners, given by (m, 3)."""
        # Faster than indexing with an array.
        one, other = np.sort(triangles, axis=1).take(self.faces, axis=0)
        return self._those((one != other).any(axis=1))

    def agreeing(self) -> FaceNeighbors:
        """Return the neighbors whose orientations agree."""
        return self._those(self.agree)

    def and_across(self, seams: FaceNeighbors) -> FaceNeighbors:
        """Return these and others; edges may be repeated."""
        return FaceNeighbors(np.hstack([self.sides, seams.sides]), np.hstack([self.agree, seams.agree]))

    def labels(self, count: int) -> NDArray[np.int64]:
        """Return labels of so many triangles, (count,), the same for all that neighbors connect."""
        return component_labels(*self.faces, count)

    def _those(self, chosen: NDArray[np.bool_]) -> FaceNeighbors:
        return FaceNeighbors(self.sides[:, chosen], self.agree[chosen])
