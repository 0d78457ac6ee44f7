# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Quantiles of values that count differently, such as those of vertices by their areas."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def weighted_quantile(values: NDArray[np.float64], weights: NDArray[np.float64], share: float) -> float:
    """Return the value that a share of the weights stays below.

    Parameters
    ----------
    values, weights : (n,) float64
        One each at least; weights are not negative.
    share : float
        From 0 to 1.
    """
    order = np.argsort(values)
    reached = np.cumsum(weights[order])
    return float(values[order][min(int(np.searchsorted(reached, share * reached[-1])), len(values) - 1)])
