# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Rotation and stretch of a map between surfaces at every vertex."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import diags_array

from ...geometry.algebra.factorization import factorize
from ...geometry.algebra.quotients import quotients
from ...geometry.meshes.laplacian import Laplacian
from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.meshes.normals import unit_vectors
from .surface_maps import PointMap

# Smoothing length of the rotations, relative to the square root of the surface's area.
_REACH = 0.02
# Larger stretches are errors of the map.
_MOST_STRETCH = 8.0


@dataclass(frozen=True)
class MapFrames:
    """Rotation and stretch from the giving mesh to the receiving mesh.

    Attributes
    ----------
    turns : (m, 3, 3) float64
        Orthogonal matrices that map directions at the image of a vertex to directions at the vertex. Reflections if the
        map reverses orientation, as between mirror images; the identity for vertices without image.
    stretches : (m,) float64
        Ratio of lengths on the receiver to those on the giver.
    side : float
        Determinant of the turns: -1 for reflections.
    """

    turns: NDArray[np.float64]
    stretches: NDArray[np.float64]
    side: float


def map_frames(points: PointMap, receiver: TriangleMesh, giver: TriangleMesh, stiffness: Laplacian) -> MapFrames:
    """Compare the triangles of the receiver with those spanned by their corners' images on the giver.

    Parameters
    ----------
    points : PointMap
        Images of the receiver's vertices.
    receiver, giver : TriangleMesh
        The meshes.
    stiffness : Laplacian
        Laplacian of the receiver, for smoothing the rotations.
    """
    known = points.found[receiver.faces].all(axis=1)
    faces = receiver.faces[known]
    images = points.at(giver, giver.vertices)
    here, there = receiver.vertices[faces], images[faces]
    own = np.stack([here[:, 1] - here[:, 0], here[:, 2] - here[:, 0]], axis=1)
    theirs = np.stack([there[:, 1] - there[:, 0], there[:, 2] - there[:, 0]], axis=1)
    up = np.cross(own[:, 0], own[:, 1])
    area = np.linalg.norm(up, axis=1)
    facing = unit_vectors(points.at(giver, giver.vertex_normals)[faces].sum(axis=1))
    spanned = np.cross(theirs[:, 0], theirs[:, 1])
    # If the map reverses orientation, so do most triangles of images.
    side = 1.0 if np.einsum("nd,nd->", spanned, facing) >= 0 else -1.0
    # Folded triangles of images carry no information.
    folded = side * np.einsum("nd,nd->n", spanned, facing) <= 0
    their_area = np.linalg.norm(spanned, axis=1)
    # All three edges have equal weight, and so does the normal.
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
    stretches = np.sqrt(quotients(smooth[9], smooth[10], 1.0))
    typical = float(np.sqrt(area.sum() / max(their_area.sum(), np.finfo(float).tiny))) if len(area) else 1.0
    return MapFrames(turns, np.clip(stretches, typical / _MOST_STRETCH, typical * _MOST_STRETCH), side)


def _averaged(sums: NDArray[np.float64], stiffness: Laplacian) -> NDArray[np.float64]:
    """Smooth sums over faces, (k, n), along the surface by one heat step."""
    used = np.flatnonzero(stiffness.areas > 0)
    areas = stiffness.areas[used]
    time = _REACH**2 * areas.sum()
    system = diags_array(areas) + time * stiffness.matrix[used][:, used]
    result = np.zeros_like(sums)
    result[:, used] = factorize(system.tocsc()).solve(np.ascontiguousarray(sums[:, used]))
    return result


def nearest_turns(spreads: NDArray[np.float64], side: float) -> NDArray[np.float64]:
    """Return the nearest orthogonal matrices with determinant `side`, (n, 3, 3); the identity for zero matrices."""
    sizes = np.linalg.norm(spreads, axis=(1, 2), keepdims=True)
    left, _, right = np.linalg.svd(spreads / np.where(sizes > 0, sizes, 1.0))
    left[:, :, 2] *= (side * np.sign(np.linalg.det(left @ right)))[:, None]
    turns = left @ right
    turns[sizes[:, 0, 0] == 0] = np.eye(3)
    return turns
