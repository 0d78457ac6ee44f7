# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Barycentric coordinates, and points of given ones, in triangles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


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
        Of sum 1; negative beyond an edge. (1, 0, 0) in triangles without area.
    """
    edges = corners[:, 1:] - corners[:, :1]
    offsets = points - corners[:, :1]
    (one, mixed), (_, other) = np.moveaxis(edges @ np.swapaxes(edges, 1, 2), 0, 2)
    at_one, at_other = np.moveaxis(offsets @ np.swapaxes(edges, 1, 2), 2, 0)
    area = (one * other - np.square(mixed))[:, None]
    sound = area > 1e-12 * (one * other)[:, None]
    area = np.where(sound, area, 1.0)
    second = np.where(sound, (other[:, None] * at_one - mixed[:, None] * at_other) / area, 0.0)
    third = np.where(sound, (one[:, None] * at_other - mixed[:, None] * at_one) / area, 0.0)
    return np.stack([1.0 - second - third, second, third], axis=2)


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
    return positive / positive.sum(axis=-1, keepdims=True)
