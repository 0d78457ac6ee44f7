# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The largest balls inside a closed surface that touch it at given points.

Each is found by shrinking a ball until no sample of the surface is inside (Ma, Bae and Choi, "3D medial axis point
approximation using nearest neighbors and the normal field", 2012).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

# Rounds of shrinking, and the fraction of a ball's radius by which the surface may finally reach into it.
_ROUNDS, _TOLERANCE = 40, 1e-3
# Least distance, in radii, between two points where a ball touches the surface.
_SEPARATION = 0.5


def ball_radii(
    points: NDArray[np.float64], normals: NDArray[np.float64], samples: cKDTree, largest: float
) -> NDArray[np.float64]:
    """Shrink a ball at each of some points until no sample of the surface is inside; return the radii, (n,).

    Parameters
    ----------
    points, normals : (n, 3) float64
        Points of the surface, and unit normals there, outward.
    samples : cKDTree
        Of the points that represent the surface.
    largest : float
        Radius of the balls at first.
    """
    radii = np.full(len(points), largest)
    active = np.arange(len(points))
    for _ in range(_ROUNDS):
        if not len(active):
            break
        centers = points[active] - radii[active, None] * normals[active]
        # Nothing farther away is inside any ball.
        distances, nearest = samples.query(centers, distance_upper_bound=float(radii[active].max()))
        hit = np.flatnonzero(nearest < samples.n)
        active, distances, nearest = active[hit], distances[hit], nearest[hit]
        reach = points[active] - samples.data[nearest]
        along = np.einsum("ni,ni->n", reach, normals[active])
        shrunk = np.einsum("ni,ni->n", reach, reach) / np.maximum(2.0 * along, np.finfo(float).tiny)
        # Very close to the contact point, a facet of a round body is not an obstacle.
        apart = np.linalg.norm(reach, axis=1) >= _SEPARATION * shrunk
        shrinks = apart & (distances < (1.0 - _TOLERANCE) * radii[active]) & (along > 0) & (shrunk < radii[active])
        active = active[shrinks]
        radii[active] = shrunk[shrinks]
    return radii
