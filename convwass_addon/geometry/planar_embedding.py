# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Embed parts of surfaces in the plane such that every inner vertex is a weighted mean of its neighbors.

With positive weights and a convex boundary no triangle is flipped (W. T. Tutte, "How to draw a graph", 1963). Mean
value weights keep angles approximately (M. S. Floater, "Mean value coordinates", 2003).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csc_array, csr_array, diags_array
from scipy.sparse.linalg import splu

from .mesh_discs import MeshDisc

# Least tangent of half an angle, so that no weight is zero, and least length of an edge, relative to the longest.
_LEAST_TANGENT, _LEAST_LENGTH = 1e-3, 1e-6


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
    weights, inner = _mean_value_weights(points, disc.faces), disc.inner
    found = np.zeros((len(points), 2))
    found[disc.rim] = places
    if len(inner):
        rows = weights[inner]
        totals = np.asarray(rows.sum(axis=1)).ravel()
        system = csc_array(diags_array(totals) - rows[:, inner])
        found[inner] = splu(system).solve(rows[:, disc.rim] @ places)
    return found


def on_unit_disc(points: NDArray[np.float64], disc: MeshDisc) -> NDArray[np.float64]:
    """Flatten a disc to the unit disc, (v, 2); its rim is spread along the circle by length."""
    rim = points[disc.rim]
    lengths = np.linalg.norm(np.roll(rim, -1, axis=0) - rim, axis=1)
    angles = 2.0 * np.pi * (np.cumsum(lengths) - lengths) / lengths.sum()
    return embedded(points, disc, np.stack([np.cos(angles), np.sin(angles)], axis=1))


def _mean_value_weights(points: NDArray[np.float64], faces: NDArray[np.int64]) -> csr_array:
    """Return the weight of every neighbor of every vertex, (v, v), positive."""
    rows, columns, values = [], [], []
    for corner in range(3):
        own, after, before = (faces[:, (corner + step) % 3] for step in range(3))
        sides = [points[other] - points[own] for other in (after, before)]
        lengths = [np.linalg.norm(side, axis=1) for side in sides]
        least = _LEAST_LENGTH * max(float(length.max()) for length in lengths)
        lengths = [np.maximum(length, max(least, np.finfo(float).tiny)) for length in lengths]
        cosines = np.clip(np.einsum("md,md->m", *sides) / (lengths[0] * lengths[1]), -1.0, 1.0)
        tangents = np.sqrt((1.0 - cosines) / np.maximum(1.0 + cosines, _LEAST_TANGENT**2))
        tangents = np.maximum(tangents, _LEAST_TANGENT)
        for other, length in zip((after, before), lengths, strict=True):
            rows.append(own)
            columns.append(other)
            values.append(tangents / length)
    ends = np.concatenate(rows), np.concatenate(columns)
    return csr_array(coo_array((np.concatenate(values), ends), shape=(len(points),) * 2))
