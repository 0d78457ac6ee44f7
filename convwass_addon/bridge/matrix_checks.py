# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks of matrices from the space of an object to another one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError

# Ratio of the smallest to the largest scale at which an object counts as flattened; single precision gives 1e-7.
_FLATTENED = 1e-6


def require_finite(name: str, matrix: NDArray[np.float64]) -> None:
    """Raise InputError, with the name of an object, if its matrix is not finite."""
    if not np.isfinite(matrix).all():
        raise InputError("{name}: its location, rotation or scale is not a number (NaN or infinite).", name=name)


def is_flattening(matrix: NDArray[np.float64]) -> bool:
    """Return whether a finite matrix, (3, 3) or (4, 4), flattens what it transforms."""
    scales = np.linalg.svd(matrix[:3, :3], compute_uv=False)
    return bool(scales[-1] <= _FLATTENED * scales[0])
