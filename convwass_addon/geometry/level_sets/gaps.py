# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Find where the components of a level set merge as the level falls, and how wide the gaps are there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_erosion
from skimage.segmentation import watershed

from ..grids.boxes import Box, box_around
from .bumps import around

# Cells examined on either side of a gap.
_WIDEST_GAP = 10
# Largest distance in cells of a gap from the box of the smaller components.
_LONGEST = 12


@dataclass(frozen=True)
class Gap:
    """The first contact of two components.

    Attributes
    ----------
    place : (int, int, int)
        The cell that connects them.
    width : float
        The sum of its distances from both, in cells.
    height : float
        Density at that cell.
    sides : (int, int)
        Labels of the two components.
    """

    place: tuple[int, int, int]
    width: float
    height: float
    sides: tuple[int, int]


def densest_gaps(density: NDArray[np.floating], labels: NDArray[np.int32], lowest: float, wanted: int) -> list[Gap]:
    """Find the densest gaps, at most one between components that denser gaps have not connected already.

    Parameters
    ----------
    density : (nx, ny, nz)
        The density whose level set the components are.
    labels : (nx, ny, nz) int32
        Labels 1, 2, ... of the components; zero elsewhere.
    lowest : float
        Lower limit of a gap's density.
    wanted : int
        Largest number of gaps.
    """
    count = int(labels.max())
    box = _around_smaller(labels)
    density, labels = density[box], labels[box]
    inside = labels > 0
    # Exclude the interior of components.
    rim = inside & ~binary_erosion(inside, border_value=1)
    basins = watershed(-density, np.where(rim, labels, 0), mask=(density > lowest) & (rim | ~inside))
    first, second, places, heights = (np.concatenate(part) for part in zip(*_contacts(basins, density), strict=True))
    joined = np.arange(count + 1)
    gaps = []
    for contact in np.argsort(-heights, kind="stable"):
        a, b = joined[first[contact]], joined[second[contact]]
        if a == b:
            continue
        joined[joined == b] = a
        place = tuple(int(i) for i in np.unravel_index(places[contact], density.shape))
        sides = int(first[contact]), int(second[contact])
        width = _width(labels, place, sides)
        on_grid = tuple(at + span.start for at, span in zip(place, box, strict=True))
        gaps.append(Gap(on_grid, width, float(heights[contact]), sides))
        if len(gaps) == wanted:
            break
    return gaps


def _around_smaller(labels: NDArray[np.int32]) -> Box:
    """Return the box of all components but the largest, and of the gaps around them."""
    sizes = np.bincount(labels.ravel())
    return box_around((labels > 0) & (labels != 1 + int(np.argmax(sizes[1:]))), _LONGEST)


def _contacts(basins: NDArray[np.int32], density: NDArray[np.floating]):
    """Yield pairs of basins that touch along each axis, the less dense of the two cells, and its density."""
    index = np.arange(density.size).reshape(density.shape)
    for axis in range(3):
        here = tuple(slice(None, -1) if a == axis else slice(None) for a in range(3))
        there = tuple(slice(1, None) if a == axis else slice(None) for a in range(3))
        a, b = basins[here], basins[there]
        touching = (a != b) & (a > 0) & (b > 0)
        one, other = index[here][touching], index[there][touching]
        one_is_lower = density.ravel()[one] <= density.ravel()[other]
        places = np.where(one_is_lower, one, other)
        yield a[touching], b[touching], places, density.ravel()[places]


def _width(labels: NDArray[np.int32], place: tuple[int, ...], pair: tuple[int, int]) -> float:
    window = around(labels.shape, place, _WIDEST_GAP)
    squared = sum((axis - at) ** 2 for axis, at in zip(np.ogrid[window], place, strict=True))
    nearest = [squared[labels[window] == piece].min(initial=_WIDEST_GAP**2) for piece in pair]
    return float(np.sqrt(nearest).sum())
