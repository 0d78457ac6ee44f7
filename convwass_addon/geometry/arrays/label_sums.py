# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Sums of vectors by label."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def label_sums(labels: NDArray[np.int64], values: NDArray[np.float64], count: int) -> NDArray[np.float64]:
    """Return the sums of the values, (k, d), of each of `count` labels, (count, d); the labels, (k,), count from 0."""
    return np.stack([np.bincount(labels, column, count) for column in values.T], axis=1)
