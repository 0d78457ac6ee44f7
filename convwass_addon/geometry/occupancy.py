# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Filled fraction of every voxel of a mesh: exact lengths along rays, combined as the median over three axes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..progress import UNINTERRUPTED, Control
from .rays import Crossings, crossings
from .winding import lattice_winding

# Rays per voxel and axis, along each side of the voxel's face.
_RAYS = 4
_NUDGE = (1.23e-5, 2.77e-5)
# Empty voxels around the bounding box of the mesh.
_MARGIN = 1


def occupancy(
    corners: NDArray[np.float64], shape: tuple[int, int, int], control: Control = UNINTERRUPTED
) -> NDArray[np.float32]:
    """Return the filled fraction of every voxel.

    Voxels that the surface crosses get the median of the fractions measured along the three axes: on an open mesh the
    rays of one axis may leak, and the median rejects that axis. The winding number decides all other voxels.

    Parameters
    ----------
    corners : (m, 3, 3) float64
        Outward triangles in cells, at least one cell from the boundary of the grid.
    shape : (int, int, int)
        Cells per axis.
    control : Control
        Stops the work when cancelled.

    Returns
    -------
    ndarray of float32, shape `shape`
        Values in [0, 1]. A sheet thinner than a voxel keeps its volume.
    """
    # The inside lies within the bounding box of the mesh.
    low, high = _box(corners, shape)
    box = tuple(slice(a, b) for a, b in zip(low, high, strict=True))
    filled = np.zeros(shape, np.float32)
    filled[box] = _filled(corners - low, tuple(int(n) for n in high - low), control)
    return filled


def _box(corners: NDArray[np.float64], shape: tuple[int, int, int]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the first voxel along each axis, (3,), and the one after the last, with a margin within the grid."""
    if not len(corners):
        return np.zeros(3, np.int64), np.ones(3, np.int64)
    low = np.floor(corners.min(axis=(0, 1))).astype(np.int64) - _MARGIN
    high = np.ceil(corners.max(axis=(0, 1))).astype(np.int64) + _MARGIN
    return np.maximum(low, 0), np.minimum(high, shape)


def _filled(corners: NDArray[np.float64], shape: tuple[int, int, int], control: Control) -> NDArray[np.float32]:
    filled = (lattice_winding(corners, shape, control) > 0.5).astype(np.float32)
    touched = np.zeros(shape, bool)
    lengths = [_axis_coverage(corners, shape, axis, touched, control) for axis in range(3)]
    one, two, three = (length[touched] for length in lengths)
    middle = np.maximum(np.minimum(one, two), np.minimum(np.maximum(one, two), three))
    filled[touched] = np.clip(middle / _RAYS**2, 0.0, 1.0)
    return filled


def _axis_coverage(
    corners: NDArray[np.float64],
    shape: tuple[int, int, int],
    axis: int,
    touched: NDArray[np.bool_],
    control: Control,
) -> NDArray[np.float32]:
    """Covered length per voxel along one axis, summed over its rays; marks voxels that the surface crosses."""
    a, b = (axis + 1) % 3, (axis + 2) % 3
    sheared = np.stack(
        [
            _RAYS * corners[..., a] - 0.5 + _NUDGE[0],
            _RAYS * corners[..., b] - 0.5 + _NUDGE[1],
            corners[..., axis],
        ],
        axis=-1,
    )
    rows = shape[b] * _RAYS
    chunks = []
    for chunk in crossings(sheared):
        control.check()
        chunks.append(chunk)
    found = _changes(chunks, rows)
    control.check()
    ray, height, step = found
    layer = np.floor(height).astype(np.int64)
    voxel = (layer * shape[a] + ray // rows // _RAYS) * shape[b] + ray % rows // _RAYS
    plane = shape[a] * shape[b]
    above = step * (height - layer)
    # A change at some height fills the rest of its voxel and all voxels above.
    cover = np.bincount(
        np.concatenate([voxel, voxel + plane]), np.concatenate([step - above, above]), (shape[axis] + 1) * plane
    )
    cover = cover.reshape(shape[axis] + 1, shape[a], shape[b])[:-1]
    result = np.empty(cover.shape, np.float32)
    so_far = np.zeros(cover.shape[1:])
    for here, target in zip(cover, result, strict=True):
        so_far += here
        target[...] = so_far
    # (axis, a, b) back to (x, y, z).
    order = np.argsort([axis, a, b])
    hit = np.zeros(shape[axis] * plane, bool)
    hit[voxel] = True
    touched |= hit.reshape(shape[axis], shape[a], shape[b]).transpose(order)
    return result.transpose(order)


def _changes(chunks: list[Crossings], rows: int) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.float64]]:
    """Crossings where a ray changes between outside (winding 0) and inside (not 0): ray, height, and +1 or -1."""
    ray = np.concatenate([c.column * rows + c.row for c in chunks]) if chunks else np.empty(0, np.int64)
    height = np.concatenate([c.height for c in chunks]) if chunks else np.empty(0)
    sign = np.concatenate([c.sign for c in chunks]) if chunks else np.empty(0, np.int64)
    order = np.lexsort((height, ray))
    ray, height, sign = ray[order], height[order], sign[order]
    after = np.cumsum(sign)
    first = np.flatnonzero(np.r_[True, ray[1:] != ray[:-1]]) if len(ray) else np.empty(0, np.int64)
    lengths = np.diff(np.r_[first, len(ray)])
    after -= np.repeat(after[first] - sign[first], lengths)
    step = (after != 0).astype(np.float64) - (after - sign != 0)
    change = step != 0
    return ray[change], height[change], step[change]
