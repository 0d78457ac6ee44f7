# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Bridge a gap between pieces of a level set along the densest way, as far as the bridge has grown."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from skimage.graph import MCP_Geometric

from .bumps import around
from .gaps import Gap

# Cells around a gap, beyond its width, among which a way across is looked for.
_MARGIN = 2
# How much more a step costs where there is half the density.
_STEEPNESS = 3.0
# Radii of a bridge that a change of the density reaches.
_REACH = 3.0
# By how much of the level a bridge that is still growing falls off from a cell to the next at its tip.
_TIP = 0.5


def way_across(
    density: NDArray[np.floating],
    labels: NDArray[np.int32],
    ends: tuple[NDArray[np.int64], NDArray[np.int64]],
    gap: Gap,
) -> NDArray[np.int64]:
    """Return the cells of a way from some pieces to others through a gap, (n, 3), which goes where it is dense.

    Parameters
    ----------
    density : (nx, ny, nz)
        Of all pieces.
    labels : (nx, ny, nz) int32
        Of the pieces, 1, 2, ...; zero elsewhere.
    ends : two of (k,) int64
        Numbers of the pieces that the way begins in, and of those that it ends in.
    gap : Gap
        Between them. Where it is wider than it says, the way ends in it.
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
    """Return a box and the density in it, raised to `wanted` at the cells of a way, (n, 3), and less around them."""
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
    """Return the most that the density over the level may be where a branch has grown to a length from its root.

    1 at that distance from the root, (3,), rising inwards; `box` says which cells of the grid to tell it for.
    """
    squared = sum((axis - at) ** 2 for axis, at in zip(np.ogrid[box], root, strict=True))
    return 1.0 + _TIP * (length - np.sqrt(squared))
