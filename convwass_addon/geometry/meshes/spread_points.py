# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Distribute points over triangles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..arrays.equal_shares import at_equal_shares
from .closest_points import ClosestPoints
from .normals import triangle_areas


def spread_points(corners: NDArray[np.float64], count: int) -> ClosestPoints:
    """Distribute points over triangles, (m, 3, 3), by area; deterministic.

    Barycentric coordinates follow the R2 low-discrepancy sequence (Roberts 2018), whose steps are powers of the inverse
    plastic number.
    """
    numbers, triangles = np.arange(count), at_equal_shares(triangle_areas(corners), count)
    plastic = 1.32471795724474602596
    u, v = (0.5 + numbers[:, None] / np.array([plastic, plastic**2])).T % 1.0
    beyond = u + v > 1.0
    u, v = np.where(beyond, 1.0 - u, u), np.where(beyond, 1.0 - v, v)
    return ClosestPoints(triangles, np.stack([1.0 - u - v, u, v], axis=1), np.zeros(count))
