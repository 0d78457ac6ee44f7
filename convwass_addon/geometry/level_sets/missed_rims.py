# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Rims and tips of a shape that its surface at a coarse resolution does not reach.

A wing, fin or leaf is thinner than a cell at its rim, and a horn at its tip. The coarse surface ends up to two cells
before them, sometimes a little more and sometimes less, as the grid happens to lie. Closest points do not lead to the
rim from there, but to the sides before it. So every point of a rim is assigned to the vertex next to it instead.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..arrays.integer_ranges import integer_ranges
from ..meshes.edges import mesh_edges
from ..meshes.mesh import TriangleMesh
from ..meshes.point_tree import point_tree

# A shape fills at most this fraction of the space around a rim: half of it next to a plane, a quarter next to the edge
# of a box.
_RIM = 0.25
# Distance in cells between samples along edges, and most samples of an edge.
_SAMPLING, _MOST_SAMPLES = 0.5, 64
# Rims are missed if they are farther outside than the first number of cells; farther than the second, they belong to
# parts that are missing altogether.
_MISSED, FARTHEST = 0.35, 2.5
# A coarse surface ends before a rim where the shape fills less of the space than this; in between shapes of which only
# some have a wing, it may also end inside the wing.
_END = 0.65


@dataclass(frozen=True)
class MissedRims:
    """Points on rims, each assigned to a vertex of a coarse surface.

    Attributes
    ----------
    vertices : (k,) int64
        Indices of different vertices.
    points : (k, 3) float64
        For each of them, the farthest of its points along the normal.
    """

    vertices: NDArray[np.int64]
    points: NDArray[np.float64]


def missed_rims(
    shape: TriangleMesh,
    starts: NDArray[np.float64],
    normals: NDArray[np.float64],
    cell: float,
    filled: Callable[[NDArray[np.float64]], NDArray[np.floating]],
) -> MissedRims:
    """Find the rims and tips that a coarse surface of a shape does not reach, and the vertices next to them.

    Parameters
    ----------
    shape : TriangleMesh
        Oriented outward.
    starts, normals : (n, 3) float64
        Vertices of the coarse surface and unit normals.
    cell : float
        Its resolution, in the same unit.
    filled : callable
        Takes points, (p, 3), and returns the fraction of the space around each that the shape fills, (p,).
    """
    points = _samples(shape, _SAMPLING * cell)
    points = points[filled(points) < _RIM]
    nearest = point_tree(starts).query(points)[1]
    offsets = points - starts[nearest]
    heights = np.einsum("nd,nd->n", offsets, normals[nearest])
    away = np.linalg.norm(offsets, axis=1)
    near = (heights > _MISSED * cell) & (away < FARTHEST * cell) & (filled(starts[nearest]) < _END)
    missed = np.flatnonzero(near)
    # The first of every vertex is the farthest.
    ordered = missed[np.argsort(-heights[missed], kind="stable")]
    vertices, farthest = np.unique(nearest[ordered], return_index=True)
    return MissedRims(vertices, points[ordered[farthest]])


def _samples(shape: TriangleMesh, spacing: float) -> NDArray[np.float64]:
    """Return the used vertices of a mesh, and points between them along edges that are longer than a spacing."""
    # Fine meshes have few long edges, and finding all of their edges would take most of the time.
    ends = mesh_edges(shape.faces[_have_long_sides(shape, spacing)])
    # Coordinate by coordinate takes half the time.
    columns = np.ascontiguousarray(shape.vertices.T)
    first, second = (columns.take(end, axis=1) for end in ends.T)
    lengths = np.sqrt(np.square(second - first).sum(axis=0))
    counts = np.clip(np.ceil(lengths / spacing).astype(np.int64), 1, _MOST_SAMPLES) - 1
    edges, places = integer_ranges(0, counts)
    shares = (places + 1) / (counts + 1).take(edges)
    between = (1.0 - shares) * first.take(edges, axis=1) + shares * second.take(edges, axis=1)
    return np.concatenate([columns.compress(shape.is_used, axis=1), between], axis=1).T


def _have_long_sides(shape: TriangleMesh, length: float) -> NDArray[np.bool_]:
    """Return which triangles have a side that is longer than a length, (m,)."""
    corners = [shape.vertices.take(corner, axis=0) for corner in shape.faces.T]
    found = np.zeros(len(shape.faces), bool)
    for corner in range(3):
        side = corners[corner] - corners[corner - 1]
        found |= np.einsum("md,md->m", side, side) > length**2
    return found
