# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Which piece of a level set hangs on which: trees of the densest gaps, rooted at the largest pieces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .gaps import Gap


@dataclass(frozen=True)
class Link:
    """A gap by which pieces, numbered from 0, hang on another.

    Attributes
    ----------
    gap : Gap
        Between the stem and the first piece of the branch.
    stem : int
        A piece.
    branch : (k,) int64
        All pieces that hang on the stem by this gap, the nearest first.
    """

    gap: Gap
    stem: int
    branch: NDArray[np.int64]


@dataclass(frozen=True)
class PieceTrees:
    """Pieces and the gaps between them.

    Attributes
    ----------
    links : tuple of Link
        From the roots to the tips.
    sizes : (n,) int64
        Of the pieces, in cells.
    roots : (n,) int64
        The piece that each hangs on at last; one that nothing larger is linked with is its own.
    kept : (n,) bool
        The largest pieces, which hang on nothing.
    """

    links: tuple[Link, ...]
    sizes: NDArray[np.int64]
    roots: NDArray[np.int64]
    kept: NDArray[np.bool_]

    @classmethod
    def of(cls, gaps: Sequence[Gap], sizes: NDArray[np.int64], kept: int) -> PieceTrees:
        """Join pieces by gaps, the densest first, so that no two of the `kept` largest ones are joined (Kruskal)."""
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
            links += _rooted(int(root), used)
        return cls(tuple(links), sizes, roots, is_kept)

    def apart(self, size: float) -> NDArray[np.int64]:
        """Return the pieces of trees that are smaller and hold none that is kept."""
        totals = np.bincount(self.roots, self.sizes, len(self.sizes))
        return np.flatnonzero((totals[self.roots] < size) & ~self.kept[self.roots])


def _rooted(root: int, used: Sequence[Sequence[Gap]]) -> list[Link]:
    """Return the links of one tree, given the gaps at every piece."""
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
