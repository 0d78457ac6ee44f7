# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Distinct numbers of a large array."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def sorted_distinct(numbers: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return distinct nonnegative numbers in order; NumPy's unique takes several times as long for many of them."""
    ordered = np.sort(numbers)
    return ordered[np.diff(ordered, prepend=-1) > 0]
