# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Islands (charts) of a UV map and the seams between them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..arrays.components import component_labels
from .edges import paired_vertices, sorted_pairs

SEAM_DETOUR = 3.0
"""A point lies beyond a seam if its distance in the texture from the center of a triangle exceeds this multiple of what
its distance on the surface predicts."""


@dataclass(frozen=True)
class SharedEdges:
    """The edges shared by two triangles, once each.

    Attributes
    ----------
    faces : (e, 2) int64
        The two triangles of each edge.
    corners : (e, 2, 2) int64
        For each triangle, the indices (0 to 2) of the edge's two vertices in it, in the same order for both triangles.
    vertices : (e, 2) int64
        The two vertices of each edge.
    """

    faces: NDArray[np.int64]
    corners: NDArray[np.int64]
    vertices: NDArray[np.int64]

    @classmethod
    def of(cls, faces: NDArray[np.int64]) -> SharedEdges:
        """Find the shared edges; a non-manifold edge gives one pair for each two consecutive triangles."""
        tails, heads = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
        keys, order = sorted_pairs(tails, heads)
        same = np.flatnonzero(np.diff(keys) == 0)
        halves, vertices = np.stack([order[same], order[same + 1]], axis=1), paired_vertices(keys[same])
        owner, place = np.divmod(halves, 3)
        ends = np.stack([place, (place + 1) % 3], axis=2)
        swapped = tails[halves] != vertices[:, :1]
        ends[swapped] = ends[swapped][:, ::-1]
        return cls(owner, ends, vertices)

    def values(self, corner_values: NDArray[np.floating]) -> NDArray[np.floating]:
        """Return values given at the corners of triangles, (f, 3, d), at both ends of each edge: (e, 2, 2, d).

        The second axis is the triangle, the third the end of the edge.
        """
        return corner_values[self.faces[:, :, None], self.corners]


def chart_labels(faces: NDArray[np.int64], uvs: NDArray[np.floating], repeats: bool = False) -> NDArray[np.int64]:
    """Label triangles, (m, 3), by their island in a UV map, (m, 3, 2): (m,), starting at 0.

    Triangles that share an edge belong to the same island if their UVs agree at both of its ends, up to float32
    rounding; where the texture repeats, if they agree up to the same integers.
    """
    shared = SharedEdges.of(faces)
    ends = shared.values(uvs)
    size = float(np.abs(uvs).max(initial=0.0))
    apart = ends[:, 0] - ends[:, 1]
    if repeats:
        apart -= np.rint(apart[:, :1])
    joined = (np.abs(apart) <= 1e-6 * size).all(axis=(1, 2))
    pairs = shared.faces[joined]
    return component_labels(*pairs.T, len(faces))


def uv_sizes(corners: NDArray[np.floating], uvs: NDArray[np.floating]) -> NDArray[np.float64]:
    """Return the largest stretch from each triangle, (m, 3, 3), to its UVs, (m, 3, 2): (m,).

    0 for triangles without area.
    """
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    one, other = uvs[:, 1] - uvs[:, 0], uvs[:, 2] - uvs[:, 0]
    # The largest singular value of the plane map from the edges to the UV edges.
    length = np.linalg.norm(first, axis=1)
    safe = np.where(length > 0, length, 1.0)
    along = np.einsum("nd,nd->n", first, second) / safe
    height = np.linalg.norm(np.cross(first, second), axis=1) / safe
    sound = (length > 0) & (height > 1e-9 * safe)
    across = np.where(sound, height, 1.0)[:, None]
    column = one / safe[:, None]
    upright = (other - along[:, None] * column) / across
    a, b, c = (np.einsum("nd,nd->n", x, y) for x, y in ((column, column), (upright, upright), (column, upright)))
    largest = 0.5 * (a + b + np.sqrt(np.square(a - b) + 4.0 * np.square(c)))
    return np.where(sound, np.sqrt(np.maximum(largest, 0.0)), 0.0)
