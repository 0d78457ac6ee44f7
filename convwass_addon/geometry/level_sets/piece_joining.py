# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Connect pieces of a level set by bridges, or remove them, such that the result changes little with the density.

In a morph, a piece is separated by a gap whose density rises and falls with time. While the gap is dense the piece is
connected by a bridge, sooner for larger pieces; while it is not, the piece is removed. In between, the piece is
clipped: it grows out as the gap becomes denser, and retracts as it becomes thinner. Each frame is processed
independently.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation

from ..arrays.label_groups import label_groups
from ..grids.boxes import Box, grown_box
from ..grids.labelling import Pieces
from .gap_bridging import growing_tip, raised_along, way_across
from .gaps import densest_gaps
from .handle_places import RAISED
from .piece_trees import PieceTrees

STRAY_SHARE = 5e-3
"""Pieces with a smaller share of the volume are removed unless a gap next to them can be bridged."""

DEEPEST_GAP = 0.2
"""Density below which no gap is bridged, as a fraction of the level."""

# A piece starts to grow when the density of its gap, as a fraction of the level, exceeds `DEEPEST_GAP`, plus up to
# `_DENSER` for small pieces, plus `_WIDER` for every cell that the gap is wider than `_NARROW`. It is complete at
# `_BAND` more; longer pieces than `_USUAL_LENGTH`, in cells, take proportionally more. From octopus to horse, by
# transport at 100 cells in 24 frames, gaps change by 0.1 per frame, so pieces grow by three cells.
_DENSER = 0.3
_BAND, _USUAL_LENGTH = 0.4, 12.0
_WIDER, _NARROW = 0.04, 3.0
# Radius of a bridge in cells.
_NECK = 2.0


@dataclass(frozen=True)
class Joining:
    """The changes made to pieces.

    Attributes
    ----------
    bridged, clipped, dropped : int
        Numbers of pieces that were connected as a whole, connected in part, and removed.
    """

    bridged: int
    clipped: int
    dropped: int

    @property
    def any(self) -> bool:
        """Whether anything changed."""
        return self.bridged + self.clipped + self.dropped > 0


def join_pieces(density: NDArray[np.floating], level: float, pieces: Pieces, most: int, volume: float) -> Joining:
    """Connect or remove pieces in place until about `most` are left.

    The largest pieces stay separate. Each other piece is connected to the piece across its densest gap, unless that gap
    is too thin.

    Parameters
    ----------
    density : (nx, ny, nz)
        The pieces are a level set of this density.
    level : float
        The level of that set.
    pieces : Pieces
        More than `most`.
    most : int
        Wanted number of pieces.
    volume : float
        Total volume of the pieces, in cells.
    """
    labels = pieces.labels
    cells = _cells_of(labels, pieces.count)
    gaps = densest_gaps(density, labels, DEEPEST_GAP * level, pieces.count - 1)
    trees = PieceTrees.of(gaps, np.array([len(own) for own in cells]), most)
    bridges, dropped = [], list(trees.apart(STRAY_SHARE * volume))
    is_gone = np.zeros(pieces.count, bool)
    is_gone[dropped] = True
    for link in trees.links:
        if is_gone[link.stem] or is_gone[link.branch[0]]:
            is_gone[link.branch] = True
            continue
        place = np.array(link.gap.place)
        far = max(np.linalg.norm(cells[piece] - place, axis=1).max() for piece in link.branch)
        share = sum(len(cells[piece]) for piece in link.branch) / volume
        grown = grown_share(share, link.gap.height / level, link.gap.width, float(far) + link.gap.width / 2)
        if grown > 0.0:
            bridges.append((link, grown))
        else:
            is_gone[link.branch] = True
    # From tips to stems, so that clipping a piece also clips those that it connects.
    for link, grown in reversed(bridges):
        way = way_across(density, labels, (link.stem + 1, link.branch[0] + 1), link.gap)
        branch = np.concatenate([cells[piece] for piece in link.branch if not is_gone[piece]])
        bridge = _Bridge(way, branch, grown)
        cells[link.branch[0]] = np.concatenate([cells[link.branch[0]], bridge.build(density, level)])
    for piece in np.flatnonzero(is_gone):
        press_down(density, level, cells[piece])
    whole = sum(grown == 1.0 for _, grown in bridges)
    return Joining(whole, len(bridges) - whole, int(is_gone.sum()))


def _cells_of(labels: NDArray[np.int32], count: int) -> list[NDArray[np.int64]]:
    """Return the cells, (n, 3), of every piece from 1 to `count`."""
    inside = np.flatnonzero(labels)
    groups = label_groups(labels.ravel()[inside] - 1, count)
    return [np.stack(np.unravel_index(inside[own], labels.shape), axis=-1) for own in groups]


def grown_share(share: float, height: float, width: float, length: float) -> float:
    """Return which fraction of a piece is included: 0 if it is removed, 1 if it is complete, and continuous in between.

    Parameters
    ----------
    share : float
        The piece's share of the volume.
    height : float
        Density of its gap, as a fraction of the level.
    width : float
        Width of the gap, in cells; a wide bridge would change much if it moved to another position.
    length : float
        Length of the piece with its bridge, in cells; a long one takes longer to grow.
    """
    smallness = 1.0 - min((share / STRAY_SHARE) ** (1.0 / 3.0), 1.0)
    least = DEEPEST_GAP + _DENSER * smallness
    band = min(max(_BAND * length / _USUAL_LENGTH, _BAND), 0.9 - least)
    by_gap = (height - _WIDER * max(width - _NARROW, 0.0) - least) / band
    return float(np.clip(max(by_gap, share / STRAY_SHARE - 1.0), 0.0, 1.0))


def press_down(density: NDArray[np.floating], level: float, cells: NDArray[np.int64]) -> None:
    """Lower the density of a piece, (n, 3), to half of the level in place, so that lower levels do not include it."""
    _limit(density, level, cells, lambda box: np.full(tuple(span.stop - span.start for span in box), 0.5 * level))


def _limit(
    density: NDArray[np.floating],
    level: float,
    cells: NDArray[np.int64],
    most: Callable[[Box], NDArray[np.floating]],
) -> None:
    """Limit the density of cells, (n, 3), and of empty cells next to them, to values given for a box, in place."""
    box = grown_box(tuple(map(slice, cells.min(axis=0), cells.max(axis=0) + 1)), density.shape, 1)
    inner = density[box]
    inside = np.zeros(inner.shape, bool)
    inside[tuple((cells - [span.start for span in box]).T)] = True
    touched = inside | (binary_dilation(inside) & (inner <= level))
    inner[touched] = np.minimum(inner, most(box).astype(density.dtype))[touched]


@dataclass(frozen=True)
class _Bridge:
    """A bridge across a gap.

    Attributes
    ----------
    way : (n, 3) int64
        Cells from the stem, which is complete, to the branch, which grows from it.
    branch : (m, 3) int64
        Cells of the branch.
    grown : float
        Fraction of the bridge and the branch that is included.
    """

    way: NDArray[np.int64]
    branch: NDArray[np.int64]
    grown: float

    def build(self, density: NDArray[np.floating], level: float) -> NDArray[np.int64]:
        """Raise the bridge, clip the branch, and return the cells that the bridge adds, (k, 3)."""
        box, raised = raised_along(density, self.way, RAISED * level, _NECK)
        if self.grown < 1.0:
            raised = np.minimum(raised, self._most(box, level)).astype(density.dtype)
        is_raised = raised > density[box]
        is_new = is_raised & (density[box] <= level) & (raised > level / 2)
        density[box] = np.where(is_raised, raised, density[box])
        if self.grown < 1.0:
            _limit(density, level, self.branch, lambda about: np.maximum(self._most(about, level), level / 2))
        return np.argwhere(is_new) + [span.start for span in box]

    def _most(self, box: Box, level: float) -> NDArray[np.float64]:
        length = float(np.linalg.norm(self.branch - self.way[0], axis=1).max()) + 1.0
        return level * growing_tip(box, self.way[0], self.grown * length)
