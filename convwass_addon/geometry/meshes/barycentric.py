# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Barycentric coordinates, and points of given ones, in triangles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .normals import dot_coordinates


def barycentric_coordinates(corners: NDArray[np.floating], points: NDArray[np.floating]) -> NDArray[np.float64]:
    """Return barycentric coordinates of points in the plane of a triangle each.

    Parameters
    ----------
    corners : (m, 3, 3)
        Triangles.
    points : (m, p, 3)
        The points of each triangle; they are projected onto its plane.

    Returns
    -------
    (m, p, 3) float64
        Of sum 1; negative beyond an edge. In triangles without area, those of points on the longest edge.
    """
    # One long array per coordinate: products of many small matrices take three times as long.
    start, second, third = (np.ascontiguousarray(corners[:, corner].T)[:, None] for corner in range(3))
    edges, offsets = (second - start, third - start), points.T - start
    one, mixed, other = (dot_coordinates(edges[i], edges[j]) for i, j in ((0, 0), (0, 1), (1, 1)))
    at_one, at_other = (dot_coordinates(edge, offsets) for edge in edges)
    area = one * other - np.square(mixed)
    sound = area > 1e-12 * (one * other)
    area = np.where(sound, area, 1.0)
    second = np.where(sound, (other * at_one - mixed * at_other) / area, 0.0)
    third = np.where(sound, (one * at_other - mixed * at_one) / area, 0.0)
    found = np.stack([1.0 - second - third, second, third]).T
    flat = ~sound[0]
    if flat.any():
        found[flat] = _along_longest_edge(corners[flat], points[flat])
    return found


def _along_longest_edge(corners: NDArray[np.floating], points: NDArray[np.floating]) -> NDArray[np.float64]:
    """Return barycentric coordinates of points, (m, p, 3), projected onto the longest edge of a triangle each.

    A point on an edge between two triangles may be given with one that has no area.
    """
    rows = np.arange(len(corners))
    edges = np.roll(corners, -1, axis=1) - corners
    squared = np.square(edges).sum(axis=2)
    first = squared.argmax(axis=1)
    longest = np.maximum(squared[rows, first], np.finfo(np.float64).tiny)
    offsets = points - corners[rows, first][:, None]
    ways = np.einsum("mpd,md->mp", offsets, edges[rows, first]) / longest[:, None]
    found = np.zeros(points.shape)
    found[rows, :, first], found[rows, :, (first + 1) % 3] = 1.0 - ways, ways
    return found


def points_of_triangles(shares: NDArray[np.float64], corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the points with given barycentric coordinates, (s, 3), in every triangle, (m, 3, 3), as (m s, 3)."""
    points = np.empty((len(corners), len(shares), 3))
    # One coordinate after the other takes half the time of np.einsum, and rounds in the same way.
    for axis in range(3):
        first, second, third = (np.multiply.outer(corners[:, k, axis], shares[:, k]) for k in range(3))
        points[:, :, axis] = first + second + third
    return points.reshape(-1, 3)


def clamped_to_triangle(shares: NDArray[np.float64]) -> NDArray[np.float64]:
    """Move barycentric coordinates, (..., 3), into the triangle by dropping negative ones."""
    positive = np.maximum(shares, 0.0)
    # NumPy takes several times as long for sums over an axis of length three.
    return positive / (positive[..., 0] + positive[..., 1] + positive[..., 2])[..., None]
