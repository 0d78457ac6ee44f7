# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Quotients of arrays whose divisors may be zero."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def quotients(
    dividends: NDArray[np.floating], divisors: NDArray[np.floating], otherwise: float = 0.0
) -> NDArray[np.floating]:
    """Divide arrays that can be broadcast to one shape; where a divisor is not positive, return another number."""
    positive = divisors > 0
    return np.where(positive, dividends / np.where(positive, divisors, 1.0), otherwise)
