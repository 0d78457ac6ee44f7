# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Which point of a mesh every pixel of its texture shows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt

PIXELS_AT_ONCE = 2_000_000
"""Pixels of boxes around triangles that are looked at together."""

# Pixels whose center lies outside of a triangle by so much of its height belong to it: none falls between two.
_SLACK = 1e-6


@dataclass(frozen=True)
class UvPixels:
    """Pixels of a square texture and the points of a mesh that they show.

    Attributes
    ----------
    size : int
        Pixels along a side.
    vertices : (p, 3) int64
        For every pixel that shows something, in the order of `places`: the corners of its triangle.
    weights : (p, 3) float32
        How much of each corner; they sum to 1.
    places : (p,) int64
        Row by row from below.
    sources : (size^2,) int64
        For every pixel an index into `places`: its own, or within the margin that of the nearest; -1 beyond it.
    """

    size: int
    vertices: NDArray[np.int64]
    weights: NDArray[np.float32]
    places: NDArray[np.int64]
    sources: NDArray[np.int64]

    def picture(self, values: NDArray[np.floating]) -> NDArray[np.float32]:
        """Return what values on vertices, (n,), look like, (size, size), rows from below; 0 beyond the margin."""
        seen = np.einsum("pk,pk->p", np.asarray(values, dtype=np.float32)[self.vertices], self.weights)
        # The last one stands for -1.
        return np.append(seen, np.float32(0.0))[self.sources].reshape(self.size, self.size)


def uv_pixels(uv: NDArray[np.floating], faces: NDArray[np.integer], size: int, margin: int) -> UvPixels:
    """Find the point of a mesh that is seen at the center of every pixel.

    Where triangles overlap in the texture the last one is seen. Triangles outside of the square from 0 to 1 are not.

    Parameters
    ----------
    uv : (m, 3, 2) array
        Where the corners of the triangles lie in the texture.
    faces : (m, 3) array of int
        Vertices at the corners.
    size : int
        Pixels along a side.
    margin : int
        Pixels that are so far from the nearest triangle, at most, show what is seen there: without it, seams show.
    """
    corners = np.asarray(uv, dtype=np.float64) * size - 0.5
    owner = np.full(size * size, -1, dtype=np.int64)
    shares = np.zeros((size * size, 3), dtype=np.float32)
    low = np.clip(np.ceil(corners.min(axis=1) - _SLACK), 0, size).astype(np.int64)
    high = np.clip(np.floor(corners.max(axis=1) + _SLACK), -1, size - 1).astype(np.int64)
    boxes = np.maximum(high - low + 1, 0)
    counts = boxes.prod(axis=1)
    ends = np.cumsum(counts)
    start = 0
    while start < len(counts):
        done = ends[start - 1] if start else 0
        stop = max(start + 1, int(np.searchsorted(ends, done + PIXELS_AT_ONCE, side="right")))
        _draw(slice(start, stop), corners, low, boxes, counts, owner, shares)
        start = stop
    places = np.flatnonzero(owner >= 0)
    sources = _with_margin(owner.reshape(size, size) >= 0, margin)
    return UvPixels(size, np.asarray(faces, dtype=np.int64)[owner[places]], shares[places], places, sources)


def _draw(
    block: slice,
    corners: NDArray[np.float64],
    low: NDArray[np.int64],
    boxes: NDArray[np.int64],
    counts: NDArray[np.int64],
    owner: NDArray[np.int64],
    shares: NDArray[np.float32],
) -> None:
    """Note triangle and barycentric coordinates at all pixels whose centers lie in one of some triangles."""
    triangles = np.arange(block.start, block.stop)
    triangle = np.repeat(triangles, counts[block])
    within = np.arange(len(triangle)) - np.repeat(np.cumsum(counts[block]) - counts[block], counts[block])
    width = boxes[triangle, 0]
    x, y = low[triangle, 0] + within % np.maximum(width, 1), low[triangle, 1] + within // np.maximum(width, 1)
    weights = _barycentric(corners[triangle], np.stack([x, y], axis=1))
    inside = (weights >= -_SLACK).all(axis=1)
    place = y[inside] * round(len(owner) ** 0.5) + x[inside]
    found = np.clip(weights[inside], 0.0, None)
    # Of indices that occur several times, the last assignment counts.
    owner[place] = triangle[inside]
    shares[place] = found / found.sum(axis=1, keepdims=True)


def _barycentric(corners: NDArray[np.float64], points: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return the coordinates of points in triangles, (p, 3); -1 in triangles without area."""
    a, b, c = corners.swapaxes(0, 1)
    ab, ac, ap = b - a, c - a, points - a
    area = ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0]
    solid = area != 0.0
    divisor = np.where(solid, area, 1.0)
    second = (ap[:, 0] * ac[:, 1] - ap[:, 1] * ac[:, 0]) / divisor
    third = (ab[:, 0] * ap[:, 1] - ab[:, 1] * ap[:, 0]) / divisor
    weights = np.stack([1.0 - second - third, second, third], axis=1)
    weights[~solid] = -1.0
    return weights


def _with_margin(covered: NDArray[np.bool_], margin: int) -> NDArray[np.int64]:
    """Return for every pixel the rank of the covered pixel it is to show, (size^2,); -1 for those that stay empty."""
    ranks = np.where(covered, np.cumsum(covered).reshape(covered.shape) - 1, -1)
    if margin > 0 and covered.any() and not covered.all():
        distances, (rows, columns) = distance_transform_edt(~covered, return_indices=True)
        ranks = np.where(distances <= margin, ranks[rows, columns], -1)
    return ranks.ravel()
