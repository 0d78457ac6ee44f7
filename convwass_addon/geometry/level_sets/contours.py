# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Outlines of a density on a 2D grid by marching squares, and the level that encloses a given area."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import label
from skimage.measure import find_contours

from ...errors import InputError
from ..plane.outlines import FlatRegion, Outline, ring_area

# Largest relative error of the enclosed area, and largest number of levels tried.
_TOLERANCE = 2e-4
_TRIES = 16
# The first tries use the ranks of the cells' values, which do not resolve edges of one or two cells.
_BY_RANK = 4
# Levels differ from all cell values by this fraction, because rings could touch at cells equal to the level.
_CLEARANCE = 1e-9


@dataclass(frozen=True)
class LevelOutline:
    """An outline and its level.

    Attributes
    ----------
    outline : Outline
        In cells; cell (i, j) is the unit square whose lower corner is (i, j).
    level : float
        Level of the density.
    """

    outline: Outline
    level: float


def outline_at_level(density: NDArray[np.floating], level: float) -> LevelOutline:
    """Extract the outline of the area where a density, (nx, ny), exceeds a positive level; it is zero outside.

    Cells above the level are connected through sides only, cells below it also through corners, as in
    :mod:`.flat_mending`.

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
        # Every point lies between two cells, one of which belongs to the region.
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
    """Extract the outline that encloses an area, within 0.02 % if so much of the density is positive.

    Parameters
    ----------
    density : (nx, ny)
        Nonnegative.
    area : float
        In cells.

    Raises
    ------
    InputError
        The density has no mass, or covers less than half of the area.
    """
    positive = np.sort(density[density > 0])[::-1]
    if not len(positive) or len(positive) < 0.5 * area:
        raise InputError("Nothing of the blend is dense enough for an outline.")
    # A bracket of levels, each with the area missing there.
    low, high = (0.0, area - len(positive)), (float(positive[0]), area)
    level = float(positive[min(int(area), len(positive) - 1)])
    best = None
    for attempt in range(_TRIES):
        drawn = _outline_or_none(density, level)
        missing = area - (0.0 if drawn is None else drawn.outline.area)
        if drawn is not None and (best is None or abs(missing) < best[0]):
            best = abs(missing), drawn
        if abs(missing) < _TOLERANCE * area:
            break
        # Halve the residual at the end that stays, so that both ends converge (the Illinois method).
        if missing > 0:
            low, high = (low[0], low[1] / 2 if attempt >= _BY_RANK else low[1]), (level, missing)
        else:
            low, high = (level, missing), (high[0], high[1] / 2 if attempt >= _BY_RANK else high[1])
        level = _shifted_level(positive, level, missing) if attempt + 1 < _BY_RANK else np.nan
        if not low[0] < level < high[0]:
            level = (low[0] * high[1] - high[0] * low[1]) / (high[1] - low[1])
    if best is None:
        raise InputError("Nothing of the blend is dense enough for an outline.")
    return best[1]


def _shifted_level(positive: NDArray[np.floating], level: float, missing: float) -> float:
    """Shift a level by the change of the sorted values, (n,), over as many ranks as cells are missing."""
    last = len(positive) - 1
    rank = min(int(np.searchsorted(-positive, -level)), last)
    return level + float(positive[int(np.clip(rank + missing, 0, last))] - positive[rank])


def _outline_or_none(density: NDArray[np.floating], level: float) -> LevelOutline | None:
    try:
        return outline_at_level(density, level)
    except InputError:
        return None
