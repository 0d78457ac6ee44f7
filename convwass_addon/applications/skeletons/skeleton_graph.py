# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The joints and bones of a skeleton."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import InputError
from ...one_line import one_line


@dataclass(frozen=True)
class JointGraph:
    """A skeleton as a graph of joints and bones, some of whose joints are pinned.

    Attributes
    ----------
    positions : (v, 3) float64
        Positions of the pinned joints in the space of the body; those of free joints are ignored.
    edges : (e, 2) int64
        Bones, as pairs of joints.
    pinned : (v,) bool
        Joints with fixed positions.
    names : tuple of str
        Names of the joints for messages.
    rest : (v, 3) float64
        The skeleton in its original shape, before any joint was moved by pinning, in any place and size. It defines the
        proportions of the bones.
    """

    positions: NDArray[np.float64]
    edges: NDArray[np.int64]
    pinned: NDArray[np.bool_]
    names: tuple[str, ...]
    rest: NDArray[np.float64]

    __repr__ = one_line("positions", "edges", "pinned")

    @classmethod
    def from_arrays(
        cls,
        positions: ArrayLike,
        edges: ArrayLike,
        pinned: ArrayLike,
        names: tuple[str, ...] | None = None,
        rest: ArrayLike | None = None,
    ) -> JointGraph:
        """Validate and convert arrays to a graph.

        Parameters
        ----------
        positions : (v, 3)
            Current positions of the joints.
        edges : (e, 2)
            Pairs of joints, by index from 0.
        pinned : (v,) bool
            Joints with fixed positions.
        names : tuple of str, optional
            One per joint; by default their indices.
        rest : (v, 3), optional
            Positions before any joint was moved by pinning; by default the current ones.

        Raises
        ------
        InputError
            Invalid arrays: positions that are not finite, or bones that refer to missing joints or connect a joint with
            itself.
        """
        points = np.asarray(positions, dtype=np.float64)
        pairs = np.asarray(edges)
        pairs = pairs.astype(np.int64) if pairs.size else np.empty((0, 2), np.int64)
        is_pinned = np.asarray(pinned, dtype=bool)
        if points.ndim != 2 or points.shape[1:] != (3,) or pairs.ndim != 2 or pairs.shape[1] != 2:
            raise InputError("A skeleton needs joints of shape (v, 3) and bones of shape (e, 2).")
        known = tuple(map(str, range(len(points)))) if names is None else tuple(names)
        if is_pinned.shape != (len(points),) or len(known) != len(points):
            raise InputError(
                "A skeleton needs a name and a pin, set or not, for each of its {count} joints.", count=len(points)
            )
        own = points if rest is None else np.asarray(rest, dtype=np.float64)
        if own.shape != points.shape:
            raise InputError("A skeleton needs joints of shape (v, 3) and bones of shape (e, 2).")
        is_number = np.isfinite(points).all(axis=1) & np.isfinite(own).all(axis=1)
        if not is_number.all():
            bad = np.flatnonzero(~is_number)[0]
            raise InputError("The joint {name} has coordinates that are not numbers.", name=known[bad])
        if pairs.size and (pairs.min() < 0 or pairs.max() >= len(points)):
            raise InputError("The bones name joints that do not exist.")
        loops = pairs[pairs[:, 0] == pairs[:, 1], 0]
        if len(loops):
            raise InputError("A bone runs from the joint {name} to itself; leave it out.", name=known[loops[0]])
        return cls(points, np.unique(np.sort(pairs, axis=1), axis=0), is_pinned, known, own)

    @property
    def lengths(self) -> NDArray[np.float64]:
        """Lengths of the bones in the original shape, (e,)."""
        return np.linalg.norm(self.rest[self.edges[:, 0]] - self.rest[self.edges[:, 1]], axis=1)

    @cached_property
    def neighbors(self) -> list[list[int]]:
        """The adjacent joints of every joint."""
        found: list[list[int]] = [[] for _ in self.positions]
        for tail, head in self.edges.tolist():
            found[tail].append(head)
            found[head].append(tail)
        return found

    def bones_along(self, chain: NDArray[np.int64]) -> list[int]:
        """Return the indices of the bones between consecutive joints of a chain."""
        return [self._bone_of[min(ends), max(ends)] for ends in pairwise(chain.tolist())]

    @cached_property
    def _bone_of(self) -> dict[tuple[int, int], int]:
        return {tuple(edge): index for index, edge in enumerate(self.edges.tolist())}

    def part(self, chosen: NDArray[np.bool_]) -> JointGraph:
        """Return the subgraph of some joints, (v,) bool."""
        number = np.cumsum(chosen) - 1
        edges = number[self.edges[chosen[self.edges].all(axis=1)]]
        names = tuple(name for name, is_chosen in zip(self.names, chosen, strict=True) if is_chosen)
        return JointGraph(self.positions[chosen], edges, self.pinned[chosen], names, self.rest[chosen])
