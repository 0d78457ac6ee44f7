# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How a map between surfaces turns and stretches what it carries, vertex by vertex."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import diags_array

from ...geometry.factorization import factorize
from ...geometry.laplacian import Laplacian
from ...geometry.mesh import TriangleMesh
from ...geometry.normals import unit_vectors, vertex_normals
from .surface_maps import PointMap

# Turns are averaged over this share of the surface's size, the square root of its area.
_REACH = 0.02
# Stretches beyond this are errors of the map.
_MOST_STRETCH = 8.0


@dataclass(frozen=True)
class MapFrames:
    """How what is given turns and stretches on its way to the mesh that receives it.

    Attributes
    ----------
    turns : (m, 3, 3) float64
        Orthogonal: takes directions at the image of a vertex to directions at the vertex. Reflections where the map
        turns the surface over, as to a mirror image; the identity where there is no image.
    stretches : (m,) float64
        How much longer lengths are at the receiver.
    side : float
        Determinant of the turns: -1 for reflections.
    """

    turns: NDArray[np.float64]
    stretches: NDArray[np.float64]
    side: float


def map_frames(points: PointMap, receiver: TriangleMesh, giver: TriangleMesh, stiffness: Laplacian) -> MapFrames:
    """Compare the triangles of the receiver with those that their corners' images span on the giver.

    Parameters
    ----------
    points : PointMap
        Of the receiver.
    receiver, giver : TriangleMesh
        The meshes.
    stiffness : Laplacian
        Of the receiver, by which turns are averaged a little.
    """
    known = points.found[receiver.faces].all(axis=1)
    faces = receiver.faces[known]
    images = points.at(giver, giver.vertices)
    here, there = receiver.vertices[faces], images[faces]
    own = np.stack([here[:, 1] - here[:, 0], here[:, 2] - here[:, 0]], axis=1)
    theirs = np.stack([there[:, 1] - there[:, 0], there[:, 2] - there[:, 0]], axis=1)
    up = np.cross(own[:, 0], own[:, 1])
    area = np.linalg.norm(up, axis=1)
    facing = unit_vectors(points.at(giver, vertex_normals(giver.vertices, giver.faces))[faces].sum(axis=1))
    spanned = np.cross(theirs[:, 0], theirs[:, 1])
    # A map that turns the surface over has most images' corners the other way round.
    side = 1.0 if np.einsum("nd,nd->", spanned, facing) >= 0 else -1.0
    # Where images lie folded over each other they tell nothing.
    folded = side * np.einsum("nd,nd->n", spanned, facing) <= 0
    their_area = np.linalg.norm(spanned, axis=1)
    # Edges in all three directions count alike, and the normals as much as they.
    sides = (
        (own[:, 0], theirs[:, 0]),
        (own[:, 1], theirs[:, 1]),
        (own[:, 1] - own[:, 0], theirs[:, 1] - theirs[:, 0]),
    )
    spreads = sum(np.einsum("ni,nj->nij", a, b) for a, b in sides)
    scale = np.sqrt(area * their_area)
    spreads += 1.5 * scale[:, None, None] * np.einsum("ni,nj->nij", unit_vectors(up), side * unit_vectors(spanned))
    spreads[folded], area[folded], their_area[folded] = 0.0, 0.0, 0.0
    columns = np.concatenate([spreads.reshape(-1, 9), area[:, None], their_area[:, None]], axis=1)
    summed = np.stack(
        [np.bincount(faces.ravel(), np.repeat(column, 3), len(receiver.vertices)) for column in columns.T]
    )
    smooth = _averaged(summed, stiffness)
    turns = nearest_turns(smooth[:9].T.reshape(-1, 3, 3), side)
    safe = np.where(smooth[10] > 0, smooth[10], 1.0)
    stretches = np.sqrt(np.where(smooth[10] > 0, smooth[9] / safe, 1.0))
    typical = float(np.sqrt(area.sum() / max(their_area.sum(), np.finfo(float).tiny))) if len(area) else 1.0
    return MapFrames(turns, np.clip(stretches, typical / _MOST_STRETCH, typical * _MOST_STRETCH), side)


def _averaged(sums: NDArray[np.float64], stiffness: Laplacian) -> NDArray[np.float64]:
    """Spread sums over faces, (k, n), a little along the surface by a step of heat."""
    used = np.flatnonzero(stiffness.areas > 0)
    areas = stiffness.areas[used]
    time = _REACH**2 * areas.sum()
    system = diags_array(areas) + time * stiffness.matrix[used][:, used]
    result = np.zeros_like(sums)
    result[:, used] = factorize(system.tocsc()).solve(np.ascontiguousarray(sums[:, used]))
    return result


def nearest_turns(spreads: NDArray[np.float64], side: float) -> NDArray[np.float64]:
    """Return the orthogonal matrices of determinant `side` that are nearest to others, (n, 3, 3); 1 for zeros."""
    sizes = np.linalg.norm(spreads, axis=(1, 2), keepdims=True)
    left, _, right = np.linalg.svd(spreads / np.where(sizes > 0, sizes, 1.0))
    left[:, :, 2] *= (side * np.sign(np.linalg.det(left @ right)))[:, None]
    turns = left @ right
    turns[sizes[:, 0, 0] == 0] = np.eye(3)
    return turns
