# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Distances of cells to a surface that lies between the cells."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..meshes.point_tree import point_tree

# Cells within this distance of the surface tell where it is; further out, distances are less exact.
_NEAR = 0.55
# Least squared slope of the distance next to the surface.
_FLATTEST = 0.25
# Samples of the surface are at most this far from the foot of a perpendicular.
_BESIDE = 0.7


def exact_depths(depth: NDArray[np.floating], cells: NDArray[np.int64]) -> NDArray[np.float32]:
    """Return the signed distances of some cells to a surface.

    Parameters
    ----------
    depth : (nx, ny, nz)
        Signed distance to the surface in cells, positive inside. It is smooth next to the surface; further away, only
        its sign is used, and its largest magnitude, where distances end. Also (nx, ny).
    cells : (n,) int64
        Indices of cells in the flattened grid.

    Returns
    -------
    (n,) float32
        Too long by at most a hundredth of a cell from four cells on, and less exact closer to the surface.
    """
    inner = depth[(slice(1, -1),) * depth.ndim]
    near = np.argwhere((inner < _NEAR) & (inner > -_NEAR)) + 1
    if not len(near) or not len(cells):
        return depth.ravel()[cells].astype(np.float32)
    slope = _slopes(depth, near)
    steepness = np.maximum(_row_products(slope, slope)[:, None], _FLATTEST)
    surface = near - depth[tuple(near.T)][:, None] / steepness * slope
    normals = slope / np.sqrt(steepness)
    places = np.stack(np.unravel_index(cells, depth.shape), axis=1).astype(np.float64)
    away, nearest = point_tree(surface).query(places)
    # The foot of the perpendicular is somewhere beside the nearest sample.
    from_plane = np.abs(_row_products(places - surface.take(nearest, axis=0), normals.take(nearest, axis=0)))
    away = np.maximum(from_plane, np.sqrt(np.maximum(away**2 - _BESIDE**2, 0.0)))
    away = np.minimum(away, max(depth.max(), -depth.min()))
    return np.copysign(away, depth.ravel()[cells]).astype(np.float32)


def _row_products(first: NDArray[np.float64], second: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the scalar products of vectors, (n, d), with others, (n,)."""
    # Column by column: NumPy takes several times as long for sums over an axis of length three.
    return sum(one * other for one, other in zip(first.T, second.T, strict=True))


def _slopes(depth: NDArray[np.floating], cells: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return the gradient at inner cells, (n, d), by central differences."""
    steps = np.eye(depth.ndim, dtype=np.int64)
    found = [0.5 * (depth[tuple((cells + step).T)] - depth[tuple((cells - step).T)]) for step in steps]
    return np.stack(found, axis=1).astype(np.float64)
