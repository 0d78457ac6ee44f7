# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Weights of what is blended, as users give them."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError


def normalized_weights(weights: ArrayLike, count: int) -> NDArray[np.float64]:
    """Return the weights of so many inputs, (count,), scaled to sum 1.

    Raises
    ------
    InputError
        The wrong number of weights, or weights that are negative, not finite, all zero or too large to be added.
    """
    values = one_for_each(weights, count)
    if not np.isfinite(values).all() or (values < 0).any():
        raise InputError("Weights must be zero or positive numbers.")
    require_positive(values)
    with np.errstate(over="ignore"):
        total = values.sum()
    if not np.isfinite(total):
        raise InputError("The weights are too large to be added; divide all of them by the same number.")
    return values / total


def one_for_each(weights: ArrayLike, count: int) -> NDArray[np.float64]:
    """Return weights as an array, (count,); raises InputError if there are more or fewer."""
    values = np.asarray(weights, dtype=np.float64)
    if values.shape != (count,):
        raise InputError(
            "There must be one weight for each of the {count} inputs, but there are {given}.",
            count=count,
            given=int(values.size),
        )
    return values


def require_positive(weights: NDArray[np.float64]) -> None:
    """Raise InputError if no weight is positive."""
    if not (weights > 0).any():
        raise InputError("All weights are zero; make at least one of them positive.")
