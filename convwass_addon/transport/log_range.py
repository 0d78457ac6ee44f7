# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The range of float64 scalings, and logarithms that stay within it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

# Logarithm that stands for "nothing here": far below all that float64 scalings can express, still finite.
LOG_NOTHING = -1e4
# The largest scaling is exp(600): half of the range of float64 lies below one, and no row of a kernel sums to more.
HEADROOM = 600.0
# Scalings below this would only produce subnormal products, which are many times slower.
NEGLIGIBLE = 1e-290
# Densities below exp(-600) are quotients of roundings: scalings there must not leak into their neighborhood.
RELEVANT = 600.0


def floored_log(values: NDArray[np.float64], shift: float | NDArray[np.float64] = 0.0) -> None:
    """Take the logarithm of an array of any shape in place and add `shift`; LOG_NOTHING where there is nothing."""
    with np.errstate(divide="ignore"):
        np.log(values, out=values)
    # Nothing stays nothing: the floor comes last, since a large shift would lift it to where it looks like a result.
    values += shift
    np.maximum(values, LOG_NOTHING, out=values)
