# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Rasterize a UV map: the point of a mesh that every pixel of its texture shows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt

from ..arrays.chunks import chunks_by_sizes
from ..arrays.integer_ranges import integer_ranges
from ..plane.plane_angles import plane_cross

PIXELS_AT_ONCE = 2_000_000
"""Pixels of triangle bounding boxes processed together."""

# Pixels whose center lies outside a triangle by less than this fraction of its height belong to it, which avoids gaps.
_SLACK = 1e-6


@dataclass(frozen=True)
class UvPixels:
    """Pixels of a square texture and the mesh points that they show.

    Attributes
    ----------
    size : int
        Number of pixels along a side.
    vertices : (p, 3) int64
        Corners of the triangle that each covered pixel shows, in the order of `places`.
    weights : (p, 3) float32
        Barycentric coordinates; they sum to 1.
    places : (p,) int64
        Flat indices of the covered pixels, row by row from the bottom.
    sources : (size^2,) int64
        For every pixel an index into `places`: its own, within the margin that of the nearest covered pixel, else -1.
    """

    size: int
    vertices: NDArray[np.int64]
    weights: NDArray[np.float32]
    places: NDArray[np.int64]
    sources: NDArray[np.int64]

    def picture(self, values: NDArray[np.floating]) -> NDArray[np.float32]:
        """Render vertex values, (n,), to an image, (size, size), with rows from the bottom; 0 beyond the margin."""
        seen = np.einsum("pk,pk->p", np.asarray(values, dtype=np.float32)[self.vertices], self.weights)
        # Index -1 refers to the appended zero.
        return np.append(seen, np.float32(0.0))[self.sources].reshape(self.size, self.size)


def uv_pixels(uv: NDArray[np.floating], faces: NDArray[np.integer], size: int, margin: int) -> UvPixels:
    """Find the mesh point shown at the center of every pixel.

    Where triangles overlap in the texture, the last one is shown. Parts outside the unit square are ignored.

    Parameters
    ----------
    uv : (m, 3, 2) array
        UV coordinates of the triangles' corners.
    faces : (m, 3) array of int
        Vertices of the triangles.
    size : int
        Number of pixels along a side.
    margin : int
        Pixels within this distance of the nearest triangle show its point; without a margin, seams become visible.
    """
    corners = np.asarray(uv, dtype=np.float64) * size - 0.5
    owner = np.full(size * size, -1, dtype=np.int64)
    shares = np.zeros((size * size, 3), dtype=np.float32)
    low = np.clip(np.ceil(corners.min(axis=1) - _SLACK), 0, size).astype(np.int64)
    high = np.clip(np.floor(corners.max(axis=1) + _SLACK), -1, size - 1).astype(np.int64)
    boxes = np.maximum(high - low + 1, 0)
    counts = boxes.prod(axis=1)
    for block in chunks_by_sizes(counts, PIXELS_AT_ONCE):
        _rasterize(block, corners, low, boxes, counts, owner, shares)
    places = np.flatnonzero(owner >= 0)
    sources = _with_margin(owner.reshape(size, size) >= 0, margin)
    return UvPixels(size, np.asarray(faces, dtype=np.int64)[owner[places]], shares[places], places, sources)


def _rasterize(
    block: slice,
    corners: NDArray[np.float64],
    low: NDArray[np.int64],
    boxes: NDArray[np.int64],
    counts: NDArray[np.int64],
    owner: NDArray[np.int64],
    shares: NDArray[np.float32],
) -> None:
    """Store triangle and barycentric coordinates of all pixels whose centers lie in a block of triangles."""
    triangle, within = integer_ranges(0, counts[block])
    triangle += block.start
    width = boxes[triangle, 0]
    x, y = low[triangle, 0] + within % np.maximum(width, 1), low[triangle, 1] + within // np.maximum(width, 1)
    weights = _barycentric(corners[triangle], np.stack([x, y], axis=1))
    inside = (weights >= -_SLACK).all(axis=1)
    place = y[inside] * round(len(owner) ** 0.5) + x[inside]
    found = np.clip(weights[inside], 0.0, None)
    # For repeated indices, the last assignment wins.
    owner[place] = triangle[inside]
    shares[place] = found / found.sum(axis=1, keepdims=True)


def _barycentric(corners: NDArray[np.float64], points: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return barycentric coordinates of points in triangles, (p, 3); -1 in triangles without area."""
    a, b, c = corners.swapaxes(0, 1)
    ab, ac, ap = b - a, c - a, points - a
    area = plane_cross(ab, ac)
    solid = area != 0.0
    divisor = np.where(solid, area, 1.0)
    second = plane_cross(ap, ac) / divisor
    third = plane_cross(ab, ap) / divisor
    weights = np.stack([1.0 - second - third, second, third], axis=1)
    weights[~solid] = -1.0
    return weights


def _with_margin(covered: NDArray[np.bool_], margin: int) -> NDArray[np.int64]:
    """Return for every pixel the rank of the covered pixel that it shows, (size^2,); -1 for empty pixels."""
    ranks = np.where(covered, np.cumsum(covered).reshape(covered.shape) - 1, -1)
    if margin > 0 and covered.any() and not covered.all():
        distances, (rows, columns) = distance_transform_edt(~covered, return_indices=True)
        ranks = np.where(distances <= margin, ranks[rows, columns], -1)
    return ranks.ravel()
