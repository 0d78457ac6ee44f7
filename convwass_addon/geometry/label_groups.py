# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Group items by their labels."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def label_groups(labels: NDArray[np.integer], count: int) -> list[NDArray[np.int64]]:
    """Return for each of `count` labels, from 0, the indices of the items with this label, ascending.

    Parameters
    ----------
    labels : (n,) int
        The label of every item.
    count : int
        At least 1.
    """
    order = np.argsort(labels, kind="stable")
    return np.split(order, np.cumsum(np.bincount(labels, minlength=count))[:-1])
