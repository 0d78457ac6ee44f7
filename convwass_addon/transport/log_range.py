# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The range of float64 scalings, and exponentials and logarithms that stay within it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

# Logarithm that stands for zero: finite, but far below what float64 scalings can express.
LOG_NOTHING = -1e4
# The largest scaling is exp(600): half of the range of float64 lies below one, and no kernel row sums to more than 1.
HEADROOM = 600.0
# Scalings below this would only yield subnormal products, which are many times slower.
NEGLIGIBLE = 1e-290
# Densities below exp(-600) are quotients of rounding errors: scalings there must not spread to their neighborhood.
RELEVANT = 600.0


def flushed_exp(
    logs: NDArray[np.float64], shift: float | NDArray[np.float64], out: NDArray[np.float64] | None = None
) -> NDArray[np.float64]:
    """Return the exponentials of logarithms minus a shift, zero where negligible, in `out` if given."""
    values = np.subtract(logs, shift, out=out)
    np.exp(values, out=values)
    np.copyto(values, 0.0, where=values < NEGLIGIBLE)
    return values


def floored_log(values: NDArray[np.float64], shift: float | NDArray[np.float64] = 0.0) -> None:
    """Take the logarithm of an array of any shape in place and add `shift`; LOG_NOTHING where the value is zero."""
    with np.errstate(divide="ignore"):
        np.log(values, out=values)
    # Apply the floor last: a large shift would otherwise lift log(0) to the range of real results.
    values += shift
    np.maximum(values, LOG_NOTHING, out=values)
