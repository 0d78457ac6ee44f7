# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The volumes of blends: either volumes are interpolated linearly, or lengths are."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray


def interpolated_volumes(weights: ArrayLike, parts: Sequence[ArrayLike], growth: str) -> NDArray[np.float64]:
    """Return the volumes of the parts of a blend, (p,).

    Parameters
    ----------
    weights : (k,)
        Weights of the shapes, of sum 1.
    parts : (p, k)
        Volumes of every part of every shape, in any unit.
    growth : str
        With "volume", volumes V_i are interpolated, sum_i w_i V_i. With "size", lengths are: the whole blend has
        (sum_i w_i V_i^(1/3))^3, in the same proportion among its parts. The blend of a shape and a copy of twice its
        length is then 1.5 times as long, like the exact barycenter.
    """
    found = np.array([float(np.dot(weights, part)) for part in parts])
    if growth == "size":
        whole = float(np.dot(weights, np.cbrt(np.sum(parts, axis=0)))) ** 3
        found *= whole / found.sum()
    return found
