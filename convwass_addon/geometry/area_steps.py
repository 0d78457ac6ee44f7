# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangles that are evenly spread over the area of a surface."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def at_equal_areas(areas: NDArray[np.float64], count: int) -> NDArray[np.int64]:
    """Return triangles in the middles of `count` parts of equal area, in their order, from their areas, (m,).

    Large triangles may occur several times.
    """
    passed = np.cumsum(areas)
    middles = (np.arange(count) + 0.5) / count * passed[-1]
    return np.searchsorted(passed, middles).clip(max=len(areas) - 1)
