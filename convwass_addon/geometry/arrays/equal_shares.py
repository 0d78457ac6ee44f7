# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Items that are evenly spread by weight, such as triangles over the area of a surface."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def at_equal_shares(weights: NDArray[np.float64], count: int) -> NDArray[np.int64]:
    """Return the items in the middles of `count` parts of equal weight, in their order, from all weights, (m,).

    Heavy items may occur several times.
    """
    passed = np.cumsum(weights)
    middles = (np.arange(count) + 0.5) / count * passed[-1]
    return np.searchsorted(passed, middles).clip(max=len(weights) - 1)
