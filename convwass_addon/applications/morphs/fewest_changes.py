# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A sequence of counts between bounds that changes as little as possible, by dynamic programming."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np


def fewest_changes(least: Sequence[int], most: Sequence[int], first: int, last: int) -> list[int]:
    """Choose counts c_1, ..., c_n between bounds that minimize |c_1 - first| + sum |c_i+1 - c_i| + |last - c_n|.

    Of several such sequences, one with the largest sum is returned.

    Parameters
    ----------
    least, most : (n,) int
        Bounds of every count, the first not above the second.
    first, last : int
        The counts before and after the sequence.
    """
    lower, upper = np.array([*least, last]), np.array([*most, last])
    values = np.arange(min(first, lower.min()), max(first, upper.max()) + 1)
    # A change costs more than the largest possible total shortfall below the upper bounds.
    weight = len(lower) * len(values)
    changes = weight * np.abs(np.subtract.outer(values, values))
    forbidden = np.iinfo(np.int64).max // 4
    costs = np.where(values == first, 0, forbidden)
    before = []
    for low, high in zip(lower, upper, strict=True):
        reached = costs[:, None] + changes
        before.append(reached.argmin(axis=0))
        costs = np.where((low <= values) & (values <= high), reached.min(axis=0) + high - values, forbidden)
    place, chosen = int(costs.argmin()), []
    for back in reversed(before):
        chosen.append(int(values[place]))
        place = int(back[place])
    return chosen[:0:-1]
