# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Pair triangles that form good quads.

Uses no SciPy, because the modules that write frames need it and are imported when Blender starts.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .normals import unit_vectors

# The corners of a quad are between 30 and 150 degrees, and the normals of its triangles at most 25 degrees apart.
_SKEWED, _BENT = float(np.cos(np.radians(30.0))), float(np.cos(np.radians(25.0)))
# Rounds of choosing pairs that are best for both partners; triangles left after that remain single.
_ROUNDS = 8


def quad_pairs(vertices: NDArray[np.float64], faces: NDArray[np.int64]) -> NDArray[np.int64]:
    """Pair triangles that share an edge, the most rectangular quads first.

    Parameters
    ----------
    vertices : (n, 3) float64
        Positions in any space.
    faces : (m, 3) int64
        Triangles.

    Returns
    -------
    (q, 4) int64
        Corners of the quads, as corner indices of the triangles: 3 f + c is corner c of triangle f. Quads are oriented
        like the triangles; no triangle is in two quads.
    """
    sides = _common_edges(faces)
    corners = np.stack([sides[0], _following(sides[1], 2), _following(sides[0], 1), _following(sides[0], 2)], axis=1)
    worst = _skews(vertices[faces.ravel()[corners]])
    good = np.flatnonzero(worst < _SKEWED)
    order = good[np.argsort(worst[good], kind="stable")]
    corners, one, other = corners[order], sides[0, order] // 3, sides[1, order] // 3
    found = []
    for _ in range(_ROUNDS):
        if not len(corners):
            break
        ranks = np.arange(len(corners))
        best = np.full(len(faces), len(corners))
        np.minimum.at(best, one, ranks)
        np.minimum.at(best, other, ranks)
        chosen = (best[one] == ranks) & (best[other] == ranks)
        found.append(corners[chosen])
        taken = np.zeros(len(faces), bool)
        taken[one[chosen]] = taken[other[chosen]] = True
        left = ~(taken[one] | taken[other])
        corners, one, other = corners[left], one[left], other[left]
    return np.concatenate([np.empty((0, 4), np.int64), *found])


def _common_edges(faces: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the half-edge pairs, (2, e), of edges shared by exactly two consistently oriented triangles."""
    # Not by `edge_use`, whose module imports SciPy: panels import this one.
    tails, heads = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    keys = (np.minimum(tails, heads) << 32) | np.maximum(tails, heads)
    order = np.argsort(keys, kind="stable")
    same = keys[order[1:]] == keys[order[:-1]]
    # Exclude edges of more than two triangles.
    alone = same & ~np.append(False, same[:-1]) & ~np.append(same[1:], False)
    one, other = order[:-1][alone], order[1:][alone]
    opposite = tails[one] == heads[other]
    return np.stack([one[opposite], other[opposite]])


def _following(sides: NDArray[np.int64], steps: int) -> NDArray[np.int64]:
    """Return the corners `steps` further in the same triangles."""
    return sides - sides % 3 + (sides % 3 + steps) % 3


def _skews(quads: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the largest absolute cosine of the corner angles of quads, (q, 4, 3); one for bent quads."""
    edges = np.roll(quads, -1, axis=1) - quads
    units = edges / np.maximum(np.linalg.norm(edges, axis=2, keepdims=True), np.finfo(float).tiny)
    skews = np.abs(np.einsum("qcd,qcd->qc", units, np.roll(units, 1, axis=1))).max(axis=1)
    # The diagonal from the first to the third corner separates the triangles.
    one, other = (unit_vectors(np.cross(edges[:, first], edges[:, first + 1])) for first in (0, 2))
    return np.where(np.einsum("qd,qd->q", one, other) > _BENT, skews, 1.0)
