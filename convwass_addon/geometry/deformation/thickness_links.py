# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Links across the thin parts of a mesh, so that the two sides of a sail or a fin do not pass through each other.

Their triangles alone connect both sides only around the rim. Far from it, sides that are deformed differently cross
where the part is thinner than they differ.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ..meshes.edges import edge_lengths, mesh_edges, vertex_components
from ..meshes.mesh import TriangleMesh
from ..meshes.opposite_sides import opposite_sides
from .poisson_deformation import Links

# Parts are thin up to this many mean edge lengths; a link may lean by this many mean edge lengths.
_THIN, _LEANING = 2.0, 1.0
# Neighbors of a vertex among which the opposite one is sought.
_NEIGHBORS = 32
# Weight of a link as long as a mean edge, as of an edge between two equilateral triangles. Weights fall with the square
# of the length, down to a mean edge divided by the second number.
_WEIGHT, _SHORTEST = 0.58, 5.5


def thickness_links(mesh: TriangleMesh) -> Links:
    """Link vertices to those on the opposite side of thin parts.

    Parameters
    ----------
    mesh : TriangleMesh
        Facing outward, with edges of similar length.
    """
    ends = mesh_edges(mesh.faces)
    if not len(ends):
        return Links.none()
    edge = float(edge_lengths(mesh.vertices, ends).mean())
    pairs = _opposite_vertices(mesh, edge)
    lengths = edge_lengths(mesh.vertices, pairs)
    weights = _WEIGHT * np.minimum(edge / lengths, _SHORTEST) ** 2
    return Links(pairs, weights, np.ones(len(pairs), bool))


def _opposite_vertices(mesh: TriangleMesh, edge: float) -> NDArray[np.int64]:
    """Return the nearest vertex on the opposite side for every vertex of thin parts, (k, 2), without repetitions."""
    labels = vertex_components(mesh)
    used = np.flatnonzero(labels >= 0)
    points, normals, labels = mesh.vertices[used], mesh.vertex_normals[used], labels[used]
    reach = float(np.hypot(_THIN, _LEANING)) * edge
    one, other = opposite_sides(cKDTree(points), normals, np.arange(len(used)), _NEIGHBORS, reach)
    across = points[one] - points[other]
    height = np.einsum("kd,kd->k", across, normals[one])
    aside = np.linalg.norm(across - height[:, None] * normals[one], axis=1)
    is_near = (height > 0.0) & (height < _THIN * edge) & (aside < _LEANING * edge)
    # Normals lean at rims: across a gap, the other side may be below a vertex, but not the vertex below the other side.
    is_within = np.einsum("kd,kd->k", across, normals[other]) < 0.0
    fits = np.flatnonzero(is_near & is_within & (labels[one] == labels[other]))
    # The neighbors of a vertex are sorted by distance.
    nearest = fits[np.unique(one[fits], return_index=True)[1]]
    return np.unique(np.sort(used[np.stack([one[nearest], other[nearest]], axis=1)], axis=1), axis=0)
