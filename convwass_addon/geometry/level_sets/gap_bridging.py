# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Bridge gaps between components of a level set along the densest path, partially while a bridge is growing."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from skimage.graph import MCP_Geometric

from .bumps import around
from .gaps import Gap

# Margin in cells around a gap, beyond its width, in which a path is searched.
_MARGIN = 2
# Exponent of the cost of a step: how much more it costs at half the density.
_STEEPNESS = 3.0
# Extent of the change of the density, in radii of the bridge.
_REACH = 3.0
# Slope of the density at the tip of a growing bridge, per cell, as a fraction of the level.
_TIP = 0.5


def way_across(
    density: NDArray[np.floating],
    labels: NDArray[np.int32],
    ends: tuple[NDArray[np.int64], NDArray[np.int64]],
    gap: Gap,
) -> NDArray[np.int64]:
    """Return the cells, (n, 3), of the path of highest density through a gap between components.

    Parameters
    ----------
    density : (nx, ny, nz)
        The density of all components.
    labels : (nx, ny, nz) int32
        Labels 1, 2, ... of the components; zero elsewhere.
    ends : two of (k,) int64
        Labels of the components where the path begins, and of those where it ends.
    gap : Gap
        The gap. If it is wider than its record says, the path ends within it.
    """
    place = gap.place
    window = around(density.shape, place, gap.width + _MARGIN)
    inner, pieces = density[window], labels[window]
    low = np.array([span.start for span in window])
    value = float(density[place])
    search = MCP_Geometric((value / np.maximum(inner, 1e-3 * value)) ** _STEEPNESS, fully_connected=True)
    start = tuple(np.subtract(place, low))
    costs, _ = search.find_costs([start])
    halves = []
    for end in ends:
        inside = np.isin(pieces, end)
        nearest = np.unravel_index(np.argmin(np.where(inside, costs, np.inf)), inner.shape)
        halves.append(search.traceback(nearest) if inside.any() else [start])
    return np.array([*halves[0][::-1], *halves[1][1:]], np.int64) + low


def raised_along(
    density: NDArray[np.floating], way: NDArray[np.int64], wanted: float, radius: float
) -> tuple[tuple[slice, ...], NDArray[np.floating]]:
    """Return a box and its density, raised to `wanted` at the cells of a path, (n, 3), falling off around them."""
    reach = int(np.ceil(_REACH * radius))
    low = np.maximum(way.min(axis=0) - reach, 0)
    high = np.minimum(way.max(axis=0) + reach + 1, density.shape)
    box = tuple(slice(int(a), int(b)) for a, b in zip(low, high, strict=True))
    factor = np.ones(tuple(high - low), density.dtype)
    grid = np.ogrid[box]
    for cell, value in zip(way, density[tuple(way.T)], strict=True):
        if value < wanted:
            squared = sum((axis - at) ** 2 for axis, at in zip(grid, cell, strict=True))
            share = (wanted / max(float(value), 1e-6 * wanted) - 1.0) * np.exp(-squared / (2.0 * radius**2))
            np.maximum(factor, (1.0 + share).astype(density.dtype), out=factor)
    return box, density[box] * factor


def growing_tip(box: tuple[slice, ...], root: NDArray[np.int64], length: float) -> NDArray[np.float64]:
    """Return the upper limit of density / level for a branch that has grown to a length from its root.

    It is 1 at that distance from the root, (3,), and rises towards the root; `box` selects the cells.
    """
    squared = sum((axis - at) ** 2 for axis, at in zip(np.ogrid[box], root, strict=True))
    return 1.0 + _TIP * (length - np.sqrt(squared))
