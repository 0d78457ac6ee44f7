# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Ranges of integers of different lengths, one after the other in an array."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def integer_ranges(
    begin: NDArray[np.int64] | int, lengths: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return for each integer in some ranges the number of its range, and the integer itself, (lengths.sum(),) each.

    Parameters
    ----------
    begin : (n,) int64, or int
        The first integer of every range, or of all.
    lengths : (n,) int64
        How many integers each range has.
    """
    owner = np.repeat(np.arange(len(lengths)), lengths)
    return owner, np.arange(len(owner)) + np.repeat(begin - (np.cumsum(lengths) - lengths), lengths)
