# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Bounds: the smallest and the largest coordinates."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray


def bounds_of(points: NDArray[np.floating]) -> NDArray[np.floating]:
    """Return the bounds of points, (n, d), as (2, d)."""
    return np.stack([points.min(axis=0), points.max(axis=0)])


def common_bounds(bounds: Sequence[NDArray[np.floating]] | NDArray[np.floating]) -> NDArray[np.floating]:
    """Return the bounds, (2, d), of everything with these bounds, (k, 2, d)."""
    return bounds_of(np.concatenate(bounds))
