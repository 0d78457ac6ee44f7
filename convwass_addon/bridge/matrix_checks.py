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
    most, least = _scales(matrix)
    return least <= _FLATTENED * most


def require_depth(name: str, matrix: NDArray[np.float64]) -> None:
    """Raise InputError, with the name of an object, if its finite matrix, (3, 3) or (4, 4), flattens the object."""
    most, least = _scales(matrix)
    if least > _FLATTENED * most:
        return
    if least > _FLATTENED:
        raise InputError(
            "{name} has {ratio:.3g} times as large a scale along one axis as along another, so it has no volume; give "
            "it another scale in Item > Transform.",
            name=name,
            ratio=most / least,
        )
    raise InputError(
        "{name} has a scale of zero, so it has no volume; give it another scale in Item > Transform.", name=name
    )


def _scales(matrix: NDArray[np.float64]) -> tuple[float, float]:
    """Return the largest and the smallest scale of a matrix, (3, 3) or (4, 4)."""
    scales = np.linalg.svd(matrix[:3, :3], compute_uv=False)
    return float(scales[0]), float(scales[-1])
