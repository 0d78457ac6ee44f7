# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Choose points that are far from each other."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def far_points(points: NDArray[np.float64], count: int, equal: float = 0.0) -> NDArray[np.int64]:
    """Return the indices of points chosen by farthest-point sampling, (count,).

    The first one is the farthest from the mean, and each of the others the farthest from those before it.

    Parameters
    ----------
    points : (n, d)
        At least `count` points.
    count : int
        How many to choose.
    equal : float
        Squared distances with a smaller relative difference count as equal; the first of such points is chosen.
    """
    apart = np.square(points - points.mean(axis=0)).sum(axis=1)
    chosen: list[int] = []
    for _ in range(count):
        chosen.append(int(np.argmax(apart >= (1.0 - equal) * apart.max())))
        own = np.square(points - points[chosen[-1]]).sum(axis=1)
        apart = own if len(chosen) == 1 else np.minimum(apart, own)
    return np.array(chosen, np.int64)
