# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Boxes of cells on a grid, with one slice per axis."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

Box = tuple[slice, ...]

# Cells that are processed together: their arrays stay in the cache, and are so small that memory is used again instead
# of being requested from the system, which clears it.
_SLAB_CELLS = 1 << 20


def bounding_box(inside: NDArray[np.bool_]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the first cell along each of d axes, (d,), and the one after the last, (d,), of the True cells."""
    spans = []
    for axis in range(inside.ndim):
        along = np.flatnonzero(inside.any(axis=tuple(a for a in range(inside.ndim) if a != axis)))
        spans.append((along[0], along[-1] + 1))
    low, high = np.array(spans).T
    return low, high


def box_around(inside: NDArray[np.bool_], margin: int) -> Box:
    """Return the bounding box of the True cells with a margin of so many cells, within the grid."""
    low, high = bounding_box(inside)
    return grown_box(tuple(map(slice, low.tolist(), high.tolist())), inside.shape, margin)


def grown_box(box: Box, shape: tuple[int, ...], margin: int) -> Box:
    """Return a box with a margin of so many cells, within a grid."""
    return tuple(
        slice(max(span.start - margin, 0), min(span.stop + margin, size)) for span, size in zip(box, shape, strict=True)
    )


def padded_box(
    values: NDArray[np.floating], inside: NDArray[np.bool_], margin: int, outside: float
) -> tuple[NDArray[np.floating], NDArray[np.int64]]:
    """Return the values in the bounding box of the True cells with a margin, and its first cell, (d,).

    The margin may extend beyond the grid, where all values are `outside`.
    """
    low, high = bounding_box(inside)
    low, high = low - margin, high + margin
    box = np.full(high - low, outside, values.dtype)
    source = tuple(slice(max(a, 0), min(b, n)) for a, b, n in zip(low, high, values.shape, strict=True))
    box[tuple(slice(s.start - a, s.stop - a) for s, a in zip(source, low, strict=True))] = values[source]
    return box, low


def slabs(shape: tuple[int, ...], multiple: int = 1) -> Iterator[Box]:
    """Divide a grid along its first axis into boxes of about a million cells, of a multiple of so many layers."""
    layers = max(_SLAB_CELLS // int(np.prod(shape[1:])) // multiple, 1) * multiple
    for start in range(0, shape[0], layers):
        yield (slice(start, min(start + layers, shape[0])), *map(slice, shape[1:]))
