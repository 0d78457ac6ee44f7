# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The joints of a skeleton and the bones between them, with what is known of each."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import InputError
from ...one_line import one_line


@dataclass(frozen=True)
class JointGraph:
    """A skeleton as a graph: joints, bones between them, and which joints stay where they are.

    Attributes
    ----------
    positions : (v, 3) float64
        Where the pinned joints belong, in the space of the body; those of free joints do not matter.
    edges : (e, 2) int64
        Bones, as pairs of joints.
    pinned : (v,) bool
        Joints that stay where they are.
    names : tuple of str
        What messages call the joints, one each.
    rest : (v, 3) float64
        The skeleton in its own shape, before any joint was pinned elsewhere, in any place and size: how long its bones
        are beside each other.
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
        """Check and convert arrays to a graph.

        Parameters
        ----------
        positions : (v, 3)
            Where the joints are now.
        edges : (e, 2)
            Pairs of joints, by their numbers from 0.
        pinned : (v,) bool
            Joints that stay.
        names : tuple of str, optional
            One per joint; by default their numbers.
        rest : (v, 3), optional
            Where the joints were before any was pinned elsewhere; by default where they are now.

        Raises
        ------
        InputError
            Arrays that are no graph: positions that are no numbers, bones that name joints which are not there or run
            from a joint to itself.
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
        """Lengths of the bones in the skeleton's own shape, (e,)."""
        return np.linalg.norm(self.rest[self.edges[:, 0]] - self.rest[self.edges[:, 1]], axis=1)

    @cached_property
    def neighbors(self) -> list[list[int]]:
        """The joints at the other ends of every joint's bones."""
        found: list[list[int]] = [[] for _ in self.positions]
        for tail, head in self.edges.tolist():
            found[tail].append(head)
            found[head].append(tail)
        return found

    def part(self, chosen: NDArray[np.bool_]) -> JointGraph:
        """Return the graph of some joints, (v,) bool, and the bones between them."""
        number = np.cumsum(chosen) - 1
        edges = number[self.edges[chosen[self.edges].all(axis=1)]]
        names = tuple(name for name, is_chosen in zip(self.names, chosen, strict=True) if is_chosen)
        return JointGraph(self.positions[chosen], edges, self.pinned[chosen], names, self.rest[chosen])
