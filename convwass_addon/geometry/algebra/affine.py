# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Affine transformations of points."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray


def transformed_points(points: NDArray, matrix: ArrayLike) -> NDArray[np.float64]:
    """Return points, (..., 3), transformed by an affine (4, 4) matrix."""
    own = np.asarray(matrix, dtype=np.float64)
    return points @ own[:3, :3].T + own[:3, 3]
