# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Large matrix products by SciPy's BLAS: the NumPy inside Blender may have none."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import blas


def product(left: NDArray[np.float64], right: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return left @ right.

    Parameters
    ----------
    left : (n, k) float64
        In C order it is not copied.
    right : (k, m) float64
        Likewise.

    Returns
    -------
    (n, m) float64
        In C order.
    """
    # The transposed product of transposed arrays, for which nothing in C order is copied.
    return blas.dgemm(1.0, np.ascontiguousarray(right).T, np.ascontiguousarray(left).T).T
