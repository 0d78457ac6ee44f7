# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Move a surface along its normals until it encloses a volume, without turning thin parts inside out."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ..meshes.edge_means import EdgeMeans
from ..meshes.mesh import TriangleMesh
from ..meshes.normals import area_normals
from ..meshes.opposite_sides import opposite_sides
from ..meshes.point_tree import point_tree

# The volume is corrected if its relative error exceeds the first number, by at most the second in cells along the
# normals, in this many rounds: a chair halfway to a man needs a fifth of a cell.
_TOLERANCE, _MOST, _ROUNDS = 5e-4, 0.6, 6
# Moved inward by more than the first number of cells, each side of a part may lose the second fraction of the part's
# thickness.
_SLIGHT, _THINNED = 0.03, 0.35
# Rounds in which smaller insets are spread to the neighbors.
_FADING = 2
# The opposite side is sought among so many neighbors of a vertex, and first for every so many vertices.
_NEIGHBORS, _EVERY = 12, 8


def with_volume(mesh: TriangleMesh, normals: NDArray[np.float64], volume: float, cell: float) -> TriangleMesh:
    """Move a surface along normals to enclose a volume, as far as limits permit.

    All vertices move equally far, except where parts are so thin that their sides would meet.

    Parameters
    ----------
    mesh : TriangleMesh
        Closed and oriented outward.
    normals : (n, 3) float64
        Unit normals at its vertices.
    volume : float
        The volume.
    cell : float
        Unit of the largest distance, a length in the space of the mesh.
    """
    found, moved = mesh, 0.0
    least: NDArray[np.float64] | None = None
    for _ in range(_ROUNDS):
        missing = volume - found.volume
        if abs(missing) <= _TOLERANCE * volume:
            break
        growths = np.einsum("nd,nd->n", area_normals(found.vertices, found.faces), normals)
        if least is not None:
            growths = growths[least < moved]
        growth = float(growths.sum())
        if growth <= 0.0:
            # No vertex may move any farther.
            break
        moved = float(np.clip(moved + missing / growth, -_MOST * cell, _MOST * cell))
        if least is None and moved < -_SLIGHT * cell:
            least = -_largest_insets(mesh, _MOST * cell)
        offsets = np.full(len(normals), moved) if least is None else np.maximum(moved, least)
        found = TriangleMesh(mesh.vertices + offsets[:, None] * normals, mesh.faces)
    return found


def _largest_insets(mesh: TriangleMesh, most: float) -> NDArray[np.float64]:
    """Return how far vertices may move inward, (n,): less than the most where the opposite side is near."""
    normals, tree, longest = mesh.vertex_normals, point_tree(mesh.vertices), most / _THINNED
    every = np.arange(len(mesh.vertices))
    if not np.isfinite(_thicknesses(tree, normals, every[::_EVERY], longest)).any():
        return np.full(len(every), most)
    insets = np.minimum(_THINNED * _thicknesses(tree, normals, every, longest), most)
    return EdgeMeans.of(mesh).spread_minimum(insets, _FADING)


def _thicknesses(
    tree: cKDTree, normals: NDArray[np.float64], some: NDArray[np.int64], longest: float
) -> NDArray[np.float64]:
    """Return how far the opposite side is below some vertices, (k,), infinite if it is farther than the longest.

    It is approximated by the tangent planes of the nearest vertices.
    """
    places, other = opposite_sides(tree, normals, some, _NEIGHBORS, longest)
    one = some[places]
    facing = np.einsum("kd,kd->k", normals[one], normals[other])
    heights = np.einsum("kd,kd->k", tree.data[one] - tree.data[other], normals[other]) / facing
    below = (heights > 0.0) & (heights < longest)
    found = np.full(len(some), np.inf)
    np.minimum.at(found, places[below], heights[below])
    return found
