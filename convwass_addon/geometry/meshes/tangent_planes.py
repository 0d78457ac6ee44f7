# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Intersections of tangent planes at two points of a surface, which lie on the crease between them if there is one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

# Planes whose normals have a larger cosine count as parallel.
_PARALLEL = 0.95


def meeting_points(
    first: NDArray[np.float64],
    first_normals: NDArray[np.float64],
    second: NDArray[np.float64],
    second_normals: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return the point on both tangent planes that is nearest to the midpoint of each pair of points, (n, 3).

    Parameters
    ----------
    first, second : (n, 3) float64
        Pairs of points.
    first_normals, second_normals : (n, 3) float64
        Unit normals of the planes through them.

    Returns
    -------
    (n, 3) float64
        The midpoint itself if the planes are nearly parallel, or meet farther from it than the points are apart.
    """
    middles = 0.5 * (first + second)
    cosines = np.einsum("nd,nd->n", first_normals, second_normals)
    crossing = np.abs(cosines) < _PARALLEL
    heights = [
        np.einsum("nd,nd->n", normals, points - middles)
        for points, normals in ((first, first_normals), (second, second_normals))
    ]
    # The nearest point is the midpoint plus a combination of the normals.
    determinants = np.where(crossing, 1.0 - np.square(cosines), 1.0)
    shares = [(heights[i] - cosines * heights[1 - i]) / determinants for i in (0, 1)]
    offsets = shares[0][:, None] * first_normals + shares[1][:, None] * second_normals
    apart = np.square(second - first).sum(axis=1)
    crossing &= np.square(offsets).sum(axis=1) <= apart
    return middles + np.where(crossing[:, None], offsets, 0.0)
