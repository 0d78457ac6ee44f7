# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Exact signed distances of voxel centers from a triangle mesh, in a narrow band around it.

Every triangle measures the box of voxels around it that its part of the band lies in. In the frame of a triangle, the
height over its plane and the coordinates along and across its edges are linear in the voxel's indices, so that boxes of
one size are measured side by side with a few array operations.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ..progress import UNINTERRUPTED, Control
from .mesh import TriangleMesh
from .subdivision import with_short_edges
from .winding import lattice_winding

# Longer edges are halved first, in cells: large triangles have boxes that are mostly far from them.
_LONGEST_EDGE = 4.0
# Triangles of less area, as a share of their longest edge's square, are lines or points.
_THIN = 1e-7
# Voxels that are measured at once; what they need stays in the processor's cache.
_AT_ONCE = 1 << 16


def signed_distance(
    corners: NDArray[np.float64],
    shape: tuple[int, int, int],
    reach: float,
    inside: NDArray[np.bool_] | None = None,
    control: Control = UNINTERRUPTED,
) -> NDArray[np.float32]:
    """Return distances of the voxel centers from a surface, negative inside.

    Parameters
    ----------
    corners : (m, 3, 3) float64
        Triangles in cells: voxel (i, j, k) is the unit cube whose low corner is (i, j, k). They must keep one cell of
        distance from the walls of the grid where `inside` is not given.
    shape : (int, int, int)
        Cells per axis.
    reach : float
        Distances up to this, in cells, are exact; beyond, they are `reach` or minus `reach`.
    inside : bool, shape `shape`, optional
        Which voxel centers lie inside. By default those with a winding number above one half.
    control : Control
        Stops the work.

    Returns
    -------
    ndarray of float32, shape `shape`
        In cells.
    """
    if inside is None:
        inside = lattice_winding(corners, shape, control) > 0.5
    squares = np.full(int(np.prod(shape)), np.float32(reach) ** 2, np.float32)
    mesh = TriangleMesh(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))
    small = with_short_edges(mesh, _LONGEST_EDGE, np.iinfo(np.int64).max).mesh.corners
    for low, size, chosen in _boxes(small, shape, reach):
        control.check()
        _measure(squares, small[chosen], low, size, shape)
    distances = np.sqrt(squares, out=squares).reshape(shape)
    return np.negative(distances, out=distances, where=inside)


def _boxes(
    corners: NDArray[np.float64], shape: tuple[int, int, int], reach: float
) -> Iterator[tuple[NDArray[np.int64], tuple[int, int, int], NDArray[np.int64]]]:
    """Yield low corners, (t, 3), and the common size of the boxes around some triangles, and which these are, (t,)."""
    limits = np.array(shape)
    low = np.ceil(corners.min(axis=1) - 0.5 - reach).astype(np.int64)
    high = np.floor(corners.max(axis=1) - 0.5 + reach).astype(np.int64)
    sizes = np.minimum(high - low + 1, limits)
    # Boxes that stick out of the grid are moved into it, unless they lie outside of it.
    met = ((high >= 0) & (low < limits)).all(axis=1) & (sizes > 0).all(axis=1)
    low = np.clip(low, 0, limits - sizes)
    triangles = np.flatnonzero(met)
    keys = (sizes[triangles] * (1 << np.array([42, 21, 0]))).sum(axis=1)
    order = np.argsort(keys, kind="stable")
    for group in np.split(triangles[order], np.flatnonzero(np.diff(keys[order])) + 1):
        if not len(group):
            continue
        size = tuple(int(length) for length in sizes[group[0]])
        step = max(1, _AT_ONCE // int(np.prod(size)))
        for start in range(0, len(group), step):
            chosen = group[start : start + step]
            yield low[chosen], size, chosen


def _measure(
    squares: NDArray[np.float32],
    corners: NDArray[np.float64],
    low: NDArray[np.int64],
    size: tuple[int, int, int],
    shape: tuple[int, int, int],
) -> None:
    """Lower squared distances to what some triangles make of them, each in its box."""
    # Relative to the boxes, where single precision is enough.
    local = corners - (low + 0.5)[:, None]
    spanned = np.cross(local[:, 1] - local[:, 0], local[:, 2] - local[:, 0])
    longest = np.square(local - np.roll(local, 1, axis=1)).sum(axis=2).max(axis=1)
    flat = np.linalg.norm(spanned, axis=1) <= _THIN * longest
    normals = _unit(np.where(flat[:, None], 0.0, spanned), local[:, 1] - local[:, 0])
    # Squared distance from the triangle in its plane: 0 inside, else that from the nearest edge.
    nearest, innermost = None, None
    for place in range(3):
        start, end = local[:, place], local[:, (place + 1) % 3]
        along = _unit(end - start, _any_across(normals))
        half = 0.5 * np.linalg.norm(end - start, axis=1).astype(np.float32)[:, None, None, None]
        depth = _linear(np.cross(normals, along), start, size)
        innermost = depth.copy() if innermost is None else np.minimum(innermost, depth, out=innermost)
        beyond = np.abs(_linear(along, 0.5 * (start + end), size))
        beyond -= half
        np.maximum(beyond, 0.0, out=beyond)
        beyond *= beyond
        depth *= depth
        beyond += depth
        nearest = beyond if nearest is None else np.minimum(nearest, beyond, out=nearest)
    # Lines and points have no inside.
    innermost[flat] = -1.0
    nearest[innermost >= 0] = 0.0
    height = _linear(normals, local[:, 0], size)
    height *= height
    nearest += height
    steps = [np.arange(length) for length in size]
    first = (low[:, 0] * shape[1] + low[:, 1]) * shape[2] + low[:, 2]
    box = (steps[0][:, None, None] * shape[1] + steps[1][:, None]) * shape[2] + steps[2]
    np.minimum.at(squares, (first[:, None] + box.ravel()).ravel(), nearest.ravel())


def _linear(
    direction: NDArray[np.float64], origin: NDArray[np.float64], size: tuple[int, int, int]
) -> NDArray[np.float32]:
    """Return the coordinates of all voxels of boxes, (t, *size), along directions, (t, 3), from origins, (t, 3)."""
    a, b, c = (
        (column[:, None] * np.arange(length)).astype(np.float32)
        for column, length in zip(direction.T, size, strict=True)
    )
    a -= np.einsum("td,td->t", direction, origin).astype(np.float32)[:, None]
    return (a[:, :, None] + b[:, None, :])[:, :, :, None] + c[:, None, None, :]


def _unit(vectors: NDArray[np.float64], otherwise: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return vectors, (t, 3), at length one; where they have none, others across the second ones, of length one."""
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    known = lengths > 0
    return np.where(known, vectors / np.where(known, lengths, 1.0), _any_across(otherwise))


def _any_across(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return some unit vectors at right angles to others, (t, 3)."""
    axes = np.eye(3)[np.abs(vectors).argmin(axis=1)]
    across = np.cross(vectors, axes)
    lengths = np.linalg.norm(across, axis=1, keepdims=True)
    return np.where(lengths > 0, across / np.where(lengths > 0, lengths, 1.0), axes)
