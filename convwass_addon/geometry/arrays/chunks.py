# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Divide long arrays into chunks, to bound the memory of what is computed from each."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray


def chunks(count: int, size: int) -> Iterator[slice]:
    """Return the slices that divide `count` items into chunks of `size`, the last of which may be smaller."""
    return (slice(start, min(start + size, count)) for start in range(0, count, size))


def chunks_by_sizes(sizes: NDArray[np.number], most: float) -> Iterator[slice]:
    """Yield the slices that divide items of different sizes, (n,), into chunks that sum to at most `most`.

    A larger item is a chunk of its own.
    """
    ends = np.cumsum(sizes)
    start = 0
    while start < len(ends):
        done = ends[start - 1] if start else 0
        stop = max(start + 1, int(np.searchsorted(ends, done + most, side="right")))
        yield slice(start, stop)
        start = stop
