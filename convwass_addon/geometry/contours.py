# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Outlines of a density on a plane grid by marching squares, and the level that encloses an area."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import label
from skimage.measure import find_contours

from ..errors import InputError
from .outlines import FlatRegion, Outline, ring_area

# Area that may be missing or left over, as a share; and how often levels are tried for it.
_TOLERANCE = 2e-4
_TRIES = 16
# The first of these follow the ranks of cells, which edges of a cell or two do not show.
_BY_RANK = 4
# A level is kept apart from the values of cells: rings would touch there.
_CLEARANCE = 1e-9


@dataclass(frozen=True)
class LevelOutline:
    """An outline and the level it was drawn at.

    Attributes
    ----------
    outline : Outline
        In cells; cell (i, j) is the unit square whose low corner is (i, j).
    level : float
        Of the density.
    """

    outline: Outline
    level: float


def outline_at_level(density: NDArray[np.floating], level: float) -> LevelOutline:
    """Draw the outline where a density, (nx, ny), surrounded by zeros, exceeds a positive level.

    Cells that touch at a corner only are apart, and cells below the level that do are joined, as :mod:`.flat_mending`
    counts them.

    Raises
    ------
    InputError
        Nothing exceeds the level.
    """
    padded = np.pad(np.asarray(density, dtype=np.float64), 1)
    if (padded == level).any():
        level *= 1.0 - _CLEARANCE
    labels, count = label(padded > level)
    if not count:
        raise InputError("Nothing of the blend is dense enough for an outline.")
    outers: list[NDArray[np.float64] | None] = [None] * count
    holes: list[list[NDArray[np.float64]]] = [[] for _ in range(count)]
    for points in find_contours(padded, level, fully_connected="low", positive_orientation="high"):
        # Every point lies on an edge between two cells, one of which belongs to the region.
        below, above = np.floor(points[0]).astype(int), np.ceil(points[0]).astype(int)
        owner = max(labels[tuple(below)], labels[tuple(above)]) - 1
        ring = points[:-1] - 0.5
        if ring_area(ring) > 0:
            outers[owner] = ring
        else:
            holes[owner].append(ring)
    regions = [FlatRegion(outer, tuple(own)) for outer, own in zip(outers, holes, strict=True) if outer is not None]
    return LevelOutline(Outline(tuple(sorted(regions, key=lambda region: -ring_area(region.outer)))), level)


def outline_enclosing(density: NDArray[np.floating], area: float) -> LevelOutline:
    """Draw the outline that encloses an area, within 0.02 %.

    Parameters
    ----------
    density : (nx, ny)
        Not negative.
    area : float
        In cells.

    Raises
    ------
    InputError
        The density has no mass, or covers less than the area.
    """
    positive = np.sort(density[density > 0])[::-1]
    if not len(positive) or len(positive) < 0.5 * area:
        raise InputError("Nothing of the blend is dense enough for an outline.")
    # Levels on either side, and the areas that are missing there.
    low, high = (0.0, area - len(positive)), (float(positive[0]), area)
    level = float(positive[min(int(area), len(positive) - 1)])
    best = None
    for attempt in range(_TRIES):
        drawn = _drawn(density, level)
        missing = area - (0.0 if drawn is None else drawn.outline.area)
        if drawn is not None and (best is None or abs(missing) < best[0]):
            best = abs(missing), drawn
        if abs(missing) < _TOLERANCE * area:
            break
        # The side that stays counts half, so that both sides come nearer (the Illinois method).
        if missing > 0:
            low, high = (low[0], low[1] / 2 if attempt >= _BY_RANK else low[1]), (level, missing)
        else:
            low, high = (level, missing), (high[0], high[1] / 2 if attempt >= _BY_RANK else high[1])
        level = _changed(positive, level, missing) if attempt + 1 < _BY_RANK else np.nan
        if not low[0] < level < high[0]:
            level = (low[0] * high[1] - high[0] * low[1]) / (high[1] - low[1])
    if best is None:
        raise InputError("Nothing of the blend is dense enough for an outline.")
    return best[1]


def _changed(positive: NDArray[np.floating], level: float, missing: float) -> float:
    """Change a level by as much as falling values, (n,), change over as many cells as are missing, from there."""
    last = len(positive) - 1
    rank = min(int(np.searchsorted(-positive, -level)), last)
    return level + float(positive[int(np.clip(rank + missing, 0, last))] - positive[rank])


def _drawn(density: NDArray[np.floating], level: float) -> LevelOutline | None:
    try:
        return outline_at_level(density, level)
    except InputError:
        return None
