# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Spanning trees of the components of a level set along the densest gaps, rooted at the largest components."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .gaps import Gap


@dataclass(frozen=True)
class Link:
    """A gap that connects a branch of components, numbered from 0, to another component.

    Attributes
    ----------
    gap : Gap
        Between the stem and the first component of the branch.
    stem : int
        The component that the branch is attached to.
    branch : (k,) int64
        All components connected to the stem through this gap, the nearest first.
    """

    gap: Gap
    stem: int
    branch: NDArray[np.int64]


@dataclass(frozen=True)
class PieceTrees:
    """Components and the gaps between them.

    Attributes
    ----------
    links : tuple of Link
        Ordered from the roots to the tips.
    sizes : (n,) int64
        Number of cells of each component.
    roots : (n,) int64
        The root of each component's tree; isolated components are their own roots.
    kept : (n,) bool
        The largest components, which are never attached to others.
    """

    links: tuple[Link, ...]
    sizes: NDArray[np.int64]
    roots: NDArray[np.int64]
    kept: NDArray[np.bool_]

    @classmethod
    def of(cls, gaps: Sequence[Gap], sizes: NDArray[np.int64], kept: int) -> PieceTrees:
        """Connect components by gaps, densest first, but never two of the `kept` largest ones (Kruskal)."""
        is_kept = np.zeros(len(sizes), bool)
        is_kept[np.argsort(-sizes, kind="stable")[:kept]] = True
        group = np.arange(len(sizes))
        used: list[list[Gap]] = [[] for _ in sizes]
        for gap in gaps:
            one, other = (group == group[side - 1] for side in gap.sides)
            if one[gap.sides[1] - 1] or (is_kept[one].any() and is_kept[other].any()):
                continue
            group[other] = group[gap.sides[0] - 1]
            for side in gap.sides:
                used[side - 1].append(gap)
        roots = np.empty(len(sizes), np.int64)
        links: list[Link] = []
        for name in np.unique(group):
            members = np.flatnonzero(group == name)
            root = members[np.argmax(sizes[members])]
            roots[members] = root
            links += _links_from_root(int(root), used)
        return cls(tuple(links), sizes, roots, is_kept)

    def apart(self, size: float) -> NDArray[np.int64]:
        """Return the components of trees below a size that contain no kept component."""
        totals = np.bincount(self.roots, self.sizes, len(self.sizes))
        return np.flatnonzero((totals[self.roots] < size) & ~self.kept[self.roots])


def _links_from_root(root: int, used: Sequence[Sequence[Gap]]) -> list[Link]:
    """Return the links of one tree, given the gaps at every component."""
    order, parents, gaps = [root], {root: root}, {}
    for piece in order:
        for gap in used[piece]:
            for side in gap.sides:
                if side - 1 not in parents:
                    parents[side - 1], gaps[side - 1] = piece, gap
                    order.append(side - 1)
    branches: dict[int, list[int]] = {piece: [piece] for piece in order}
    for piece in reversed(order[1:]):
        branches[parents[piece]] += branches[piece]
    return [Link(gaps[piece], parents[piece], np.array(branches[piece])) for piece in order[1:]]
