# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Embed parts of surfaces in the plane such that every inner vertex is a weighted mean of its neighbors.

With positive weights and a convex boundary no triangle is flipped (W. T. Tutte, "How to draw a graph", 1963). The
weights are inverse lengths of edges on the surface, or mean value weights of earlier places in the plane.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csc_array, csr_array, diags_array
from scipy.sparse.linalg import splu

from ..algebra.factorization import factorize
from ..meshes.mesh_discs import MeshDisc

# Shorter edges, relative to the longest, count as so long; least tangent of half an angle, so that no weight is zero.
_SHORTEST, _LEAST_TANGENT = 1e-6, 1e-3


def embedded(points: NDArray[np.float64], disc: MeshDisc, places: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the places of all vertices of a disc in the plane, (v, 2).

    Parameters
    ----------
    points : (v, 3) float64
        Positions of the vertices on the surface.
    disc : MeshDisc
        The part of the surface.
    places : (b, 2) float64
        Places of its rim.
    """
    weights, inner = _inverse_lengths(points, disc.faces), disc.inner
    found = np.zeros((len(points), 2))
    found[disc.rim] = places
    if len(inner):
        rows = weights[inner]
        totals = np.asarray(rows.sum(axis=1)).ravel()
        system = csc_array(diags_array(totals) - rows[:, inner])
        found[inner] = factorize(system).solve_columns(rows[:, disc.rim] @ places)
    return found


def reembedded(places: NDArray[np.float64], disc: MeshDisc) -> NDArray[np.float64]:
    """Return new places of the vertices of a disc in the plane, (v, 2), from places where some triangles are folded.

    Mean value weights of the places themselves (M. S. Floater, "Mean value coordinates", 2003) leave a vertex where it
    is if the triangles around it are not folded and its neighbors stay. The rim stays.

    Parameters
    ----------
    places : (v, 2) float64
        Where the vertices are.
    disc : MeshDisc
        The part of the surface.
    """
    weights, inner = _mean_value_weights(places, disc.faces), disc.inner
    found = places.copy()
    if len(inner):
        rows = weights[inner]
        system = csc_array(diags_array(np.asarray(rows.sum(axis=1)).ravel()) - rows[:, inner])
        found[inner] = splu(system).solve(rows[:, disc.rim] @ places[disc.rim])
    return found


def on_unit_disc(points: NDArray[np.float64], disc: MeshDisc) -> NDArray[np.float64]:
    """Flatten a disc to the unit disc, (v, 2); its rim is spread along the circle by length."""
    rim = points[disc.rim]
    lengths = np.linalg.norm(np.roll(rim, -1, axis=0) - rim, axis=1)
    angles = 2.0 * np.pi * (np.cumsum(lengths) - lengths) / lengths.sum()
    return embedded(points, disc, np.stack([np.cos(angles), np.sin(angles)], axis=1))


def _inverse_lengths(points: NDArray[np.float64], faces: NDArray[np.int64]) -> csr_array:
    """Return the inverse lengths of all edges, (v, v), those inside counted twice."""
    tails, heads = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    lengths = np.linalg.norm(points[tails] - points[heads], axis=1)
    least = max(_SHORTEST * float(lengths.max()), np.finfo(float).tiny)
    count = len(points)
    one_way = csr_array(coo_array((1.0 / np.maximum(lengths, least), (tails, heads)), shape=(count, count)))
    return csr_array(one_way + one_way.T)


def _mean_value_weights(places: NDArray[np.float64], faces: NDArray[np.int64]) -> csr_array:
    """Return the weight of every neighbor of every vertex, (v, v), positive."""
    sides = places[np.roll(faces, -1, axis=1)] - places[faces]
    lengths = np.linalg.norm(sides, axis=2)
    lengths = np.maximum(lengths, max(_SHORTEST * float(lengths.max()), np.finfo(float).tiny))
    rows, columns, values = [], [], []
    for corner in range(3):
        before = (corner + 2) % 3
        cosines = -np.einsum("md,md->m", sides[:, corner], sides[:, before])
        cosines = np.clip(cosines / (lengths[:, corner] * lengths[:, before]), -1.0, 1.0)
        tangents = np.sqrt((1.0 - cosines) / np.maximum(1.0 + cosines, _LEAST_TANGENT**2))
        tangents = np.maximum(tangents, _LEAST_TANGENT)
        rows += [faces[:, corner]] * 2
        columns += [faces[:, (corner + 1) % 3], faces[:, before]]
        values += [tangents / lengths[:, corner], tangents / lengths[:, before]]
    ends = np.concatenate(rows), np.concatenate(columns)
    return csr_array(coo_array((np.concatenate(values), ends), shape=(len(places),) * 2))
