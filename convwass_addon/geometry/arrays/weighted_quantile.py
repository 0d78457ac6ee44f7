# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Weighted quantiles, for example of values at vertices weighted by area."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def weighted_quantile(values: NDArray[np.float64], weights: NDArray[np.float64], share: float) -> float:
    """Return the value below which a fraction of the total weight lies.

    Parameters
    ----------
    values, weights : (n,) float64
        At least one value; the weights are nonnegative.
    share : float
        The fraction, 0 to 1.
    """
    order = np.argsort(values)
    reached = np.cumsum(weights[order])
    return float(values[order][min(int(np.searchsorted(reached, share * reached[-1])), len(values) - 1)])
