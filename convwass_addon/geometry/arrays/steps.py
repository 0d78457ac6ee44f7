# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Steps from 0 to 1 between two values."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray


def linear_step(values: ArrayLike, zero: float, one: float) -> NDArray[np.floating]:
    """Return 0 up to one value and 1 from another on, linear between them; falling if `zero` is the larger one."""
    return np.clip((np.asarray(values) - zero) / (one - zero), 0.0, 1.0)


def smooth_step(values: ArrayLike, zero: float, one: float) -> NDArray[np.floating]:
    """Return :func:`linear_step` with horizontal tangents at both ends, a cubic Hermite polynomial."""
    share = linear_step(values, zero, one)
    return share * share * (3.0 - 2.0 * share)
