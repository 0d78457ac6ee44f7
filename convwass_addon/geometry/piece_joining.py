# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Join the pieces of a level set by bridges, or let them go, so that little changes where its density changes little.

In a morph, a piece hangs on by a gap whose density rises and falls with time. It is bridged while the gap is dense, the
sooner the larger the piece is, and dropped while it is not. Between, it is clipped: it grows out of what it hangs on
as the gap gets denser, and draws back into it as the gap gets thinner. No other frame has to be known for that.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation

from .gap_bridging import growing_tip, raised_along, way_across
from .gaps import densest_gaps
from .handle_removal import RAISED
from .labelling import Pieces
from .piece_trees import PieceTrees

STRAY_SHARE = 5e-3
"""Pieces of a smaller share of the volume are dropped where no gap leads to them that can be bridged."""

DEEPEST_GAP = 0.2
"""Share of the level below which no gap is bridged."""

# How much denser a gap must be for the smallest piece than for a stray; how much denser again for a piece of this
# length in cells to be whole; and how much denser for every cell that a gap is wider than this. From octopus to horse,
# by transport at 100 cells and in 24 frames, gaps change by .1 a frame: pieces then grow by three cells.
_DENSER = 0.3
_BAND, _USUAL_LENGTH = 0.4, 12.0
_WIDER, _NARROW = 0.04, 3.0
# Radius of a bridge in cells.
_NECK = 2.0


@dataclass(frozen=True)
class Joining:
    """What was done about pieces.

    Attributes
    ----------
    bridged, clipped, dropped : int
        How many were joined with others as they are, how many in part, and how many have gone.
    """

    bridged: int
    clipped: int
    dropped: int

    @property
    def any(self) -> bool:
        """Whether anything was changed."""
        return self.bridged + self.clipped + self.dropped > 0


def join_pieces(density: NDArray[np.floating], level: float, pieces: Pieces, most: int, volume: float) -> Joining:
    """Bridge gaps between pieces and drop others, so that about `most` are left; the density is changed in place.

    The largest pieces are kept apart. All others are joined to the piece that the densest gap leads to, unless that is
    too thin.

    Parameters
    ----------
    density : (nx, ny, nz)
        What the pieces are a level set of.
    level : float
        Of the set.
    pieces : Pieces
        More than `most`.
    most : int
        How many are to be left.
    volume : float
        Of all pieces together, in cells.
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
    # From the tips to the stems, so that what is clipped takes along all that hangs on it.
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
    names = labels.ravel()[inside]
    order = np.argsort(names, kind="stable")
    cells = np.stack(np.unravel_index(inside[order], labels.shape), axis=-1)
    return np.split(cells, np.cumsum(np.bincount(names, minlength=count + 1)[1:])[:-1])


def grown_share(share: float, height: float, width: float, length: float) -> float:
    """Return how much of a piece has grown out: 0 where it is dropped, 1 where it is whole, continuous between.

    Parameters
    ----------
    share : float
        Of the volume, that the piece has.
    height : float
        Density of its gap over the level.
    width : float
        Of the gap, in cells. A wide bridge makes a long jump when it goes over to another place.
    length : float
        Of the piece with its bridge, in cells: a long one takes longer to grow.
    """
    smallness = 1.0 - min((share / STRAY_SHARE) ** (1.0 / 3.0), 1.0)
    least = DEEPEST_GAP + _DENSER * smallness
    band = min(max(_BAND * length / _USUAL_LENGTH, _BAND), 0.9 - least)
    by_gap = (height - _WIDER * max(width - _NARROW, 0.0) - least) / band
    return float(np.clip(max(by_gap, share / STRAY_SHARE - 1.0), 0.0, 1.0))


def press_down(density: NDArray[np.floating], level: float, cells: NDArray[np.int64]) -> None:
    """Press a piece, (n, 3), down to half of the level in place, so that no lower level brings it back."""
    _limit(density, level, cells, lambda box: np.full(tuple(span.stop - span.start for span in box), 0.5 * level))


def _limit(
    density: NDArray[np.floating],
    level: float,
    cells: NDArray[np.int64],
    most: Callable[[tuple[slice, ...]], NDArray[np.floating]],
) -> None:
    """Press cells, (n, 3), and those outside that touch them down to densities given for a box, in place."""
    box = tuple(slice(max(a - 1, 0), b + 2) for a, b in zip(cells.min(axis=0), cells.max(axis=0), strict=True))
    inner = density[box]
    inside = np.zeros(inner.shape, bool)
    inside[tuple((cells - [span.start for span in box]).T)] = True
    touched = inside | (binary_dilation(inside) & (inner <= level))
    clipped_box = tuple(slice(span.start, span.start + size) for span, size in zip(box, inner.shape, strict=True))
    inner[touched] = np.minimum(inner, most(clipped_box).astype(density.dtype))[touched]


@dataclass(frozen=True)
class _Bridge:
    """A bridge across a gap.

    Attributes
    ----------
    way : (n, 3) int64
        Cells from the stem, which stays, to the branch, which grows out of it.
    branch : (m, 3) int64
        Cells of the branch.
    grown : float
        How much of both has grown out.
    """

    way: NDArray[np.int64]
    branch: NDArray[np.int64]
    grown: float

    def build(self, density: NDArray[np.floating], level: float) -> NDArray[np.int64]:
        """Raise the bridge, clip the branch, and return the cells that the bridge has made, (k, 3)."""
        box, raised = raised_along(density, self.way, RAISED * level, _NECK)
        if self.grown < 1.0:
            raised = np.minimum(raised, self._most(box, level)).astype(density.dtype)
        is_raised = raised > density[box]
        is_new = is_raised & (density[box] <= level) & (raised > level / 2)
        density[box] = np.where(is_raised, raised, density[box])
        if self.grown < 1.0:
            _limit(density, level, self.branch, lambda about: np.maximum(self._most(about, level), level / 2))
        return np.argwhere(is_new) + [span.start for span in box]

    def _most(self, box: tuple[slice, ...], level: float) -> NDArray[np.float64]:
        length = float(np.linalg.norm(self.branch - self.way[0], axis=1).max()) + 1.0
        return level * growing_tip(box, self.way[0], self.grown * length)
