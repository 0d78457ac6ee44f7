# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The smallest angle of triangles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def smallest_angle_cosines(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the cosine of the smallest angle of triangles, (m, 3, 3), (m,); zero if all corners coincide.

    The smallest angle is opposite the shortest side, so the law of cosines needs only the lengths of the sides.
    """
    # One contiguous array per coordinate: sums over rows of three numbers are slow.
    a, b, c = (np.ascontiguousarray(corners[:, corner].T) for corner in range(3))
    one, two, three = (_squared(side) for side in (b - a, c - b, a - c))
    least = np.minimum(np.minimum(one, two), three)
    others = one + two + three - least
    largest = np.maximum(np.maximum(one, two), three)
    products = np.sqrt(np.maximum((others - largest) * largest, np.finfo(float).tiny))
    return np.minimum((others - least) / (2.0 * products), 1.0)


def smallest_angles(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the smallest angle of triangles, (m, 3, 3), in radians, (m,)."""
    return np.arccos(smallest_angle_cosines(corners))


def _squared(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the squared lengths, (m,), of vectors given by coordinates, (3, m)."""
    x, y, z = vectors
    return x * x + y * y + z * z
