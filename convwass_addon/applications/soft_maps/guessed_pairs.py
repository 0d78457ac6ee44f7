# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Guess pairs for components without marked ones, such as eyes and teeth, from the rotation of their surroundings."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ...geometry.algebra.rotations import best_turn
from ...geometry.arrays.far_points import far_points
from .map_pieces import PieceMatch
from .map_sides import MapSide
from .surface_maps import PointMap

# Number of guessed pairs, and of surrounding vertices that determine the rotation.
_PAIRS, _AROUND = 8, 300


def guessed_pairs(source: MapSide, target: MapSide, match: PieceMatch, forward: PointMap) -> NDArray[np.int64]:
    """Return corresponding vertices, (k, 2), of two matched components.

    One component is rotated like the nearest vertices with known images, and aligned to the other; a few vertices far
    from each other are paired with their nearest neighbors. Returns no pairs while nothing is known nearby.

    Parameters
    ----------
    source, target : MapSide
        The whole meshes.
    match : PieceMatch
        The two components.
    forward : PointMap
        The map as far as it is known: points on the target for source vertices.
    """
    known = np.flatnonzero(forward.found)
    if len(known) < 3:
        return np.empty((0, 2), np.int64)
    own, other = source.mesh.vertices[match.source], target.mesh.vertices[match.target]
    center = own.mean(axis=0)
    near = known[np.argsort(np.linalg.norm(source.mesh.vertices[known] - center, axis=1))[:_AROUND]]
    turn = best_turn(source.mesh.vertices[near], forward.positions(target.mesh)[near])
    aligned = (own - center) @ turn.T
    spread = other - other.mean(axis=0)
    size = np.sqrt(np.square(aligned).sum(axis=1).mean())
    aligned *= np.sqrt(np.square(spread).sum(axis=1).mean()) / max(size, np.finfo(float).tiny)
    chosen = far_points(aligned, min(_PAIRS, len(aligned), len(spread)))
    nearest = cKDTree(spread).query(aligned[chosen])[1]
    _, first = np.unique(nearest, return_index=True)
    return np.stack([match.source[chosen[first]], match.target[nearest[first]]], axis=1)
