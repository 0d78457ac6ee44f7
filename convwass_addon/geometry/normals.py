# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Normals of triangles and of vertices."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def unit_vectors(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return vectors, (n, d), at length one; zero where they are."""
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    return vectors / np.where(lengths > 0, lengths, 1.0)


def triangle_normals(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return unit normals of triangles, (m, 3), by their corners, (m, 3, 3); zero for those without area."""
    return unit_vectors(_spanned(corners))


def area_normals(vertices: NDArray[np.float64], faces: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return normals of vertices times a third of the area of the triangles around them, (n, 3).

    Parameters
    ----------
    vertices : (n, 3) float64
        Positions, in any unit; the result is in its square.
    faces : (m, 3) int64
        Triangles of them.
    """
    thirds = np.repeat(_spanned(vertices[faces]) / 6.0, 3, axis=0)
    return np.stack([np.bincount(faces.ravel(), part, len(vertices)) for part in thirds.T], axis=1)


def vertex_normals(vertices: NDArray[np.float64], faces: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return unit normals of vertices, (n, 3), by the areas of the triangles around them; zero where there are none."""
    return unit_vectors(area_normals(vertices, faces))


def _spanned(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return normals of triangles, (m, 3), as long as twice their area."""
    a, b, c = np.moveaxis(corners, 1, 0)
    return np.cross(b - a, c - a)
