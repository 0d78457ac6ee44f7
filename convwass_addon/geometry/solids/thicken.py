# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Occupancies of surfaces that enclose nothing: of the solid within a distance of the triangles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter
from scipy.spatial import cKDTree

from ...progress import UNINTERRUPTED, Control
from .occupancy import occupancy

LEAST_CELLS = 20.0
"""Surfaces that enclose fewer cells than this count as sheets."""

LEAST_THICKNESS = 2.0
"""Thickness of sheets in cells: thinner ones do not survive a morph."""

# Spacing in cells of the points that sample the surface.
_SPACING = 0.35


def solid_or_shell_occupancy(
    corners: NDArray[np.float64], shape: tuple[int, int, int], control: Control = UNINTERRUPTED
) -> NDArray[np.float32]:
    """Return the occupancy of a solid; of a surface that encloses next to nothing, of a shell around it.

    Parameters
    ----------
    corners : (m, 3, 3) float64
        Triangles in cells, as for :func:`.occupancy.occupancy`.
    shape : (int, int, int)
        Cells per axis.
    control : Control
        Stops the work.
    """
    filled = occupancy(corners, shape, control)
    return filled if filled.sum() >= LEAST_CELLS else shell_occupancy(corners, shape, LEAST_THICKNESS)


def shell_occupancy(corners: NDArray[np.float64], shape: tuple[int, int, int], thickness: float) -> NDArray[np.float32]:
    """Fraction of every voxel within half of `thickness` of the triangles.

    Parameters
    ----------
    corners : (m, 3, 3) float64
        Triangles in cells, as for :func:`.occupancy.occupancy`.
    shape : (int, int, int)
        Cells per axis.
    thickness : float
        In cells, at least one.

    Returns
    -------
    ndarray of float32, shape `shape`
        Values in [0, 1], with a ramp one cell wide.
    """
    points = surface_points(corners)
    reach = int(np.ceil(thickness / 2 + 1))
    near = np.zeros(shape, bool)
    cells = np.unique(np.clip(np.floor(points).astype(np.int64), 0, np.array(shape) - 1), axis=0)
    near[tuple(cells.T)] = True
    near = maximum_filter(near.view(np.uint8), 2 * reach + 1, mode="constant").view(bool)
    index = np.argwhere(near)
    distance = cKDTree(points).query(index + 0.5)[0]
    filled = np.zeros(shape, np.float32)
    filled[near] = np.clip(0.5 + thickness / 2 - distance, 0.0, 1.0)
    return filled


def surface_points(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Sample triangles given in cells, (m, 3, 3), with about a third of a cell between points, (p, 3)."""
    lengths = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    steps = np.maximum(np.ceil(lengths / _SPACING).astype(int), 1)
    found = []
    for count in np.unique(steps):
        i, j = np.meshgrid(np.arange(count + 1), np.arange(count + 1), indexing="ij")
        keep = i + j <= count
        u, v = i[keep] / count, j[keep] / count
        weights = np.stack([1.0 - u - v, u, v], axis=1)
        found.append((weights @ corners[steps == count]).reshape(-1, 3))
    return np.concatenate(found)
