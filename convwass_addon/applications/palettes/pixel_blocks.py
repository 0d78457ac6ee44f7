# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Recolor whole images block by block, so that a large one needs little more memory than it takes itself."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from dataclasses import dataclass
from itertools import islice

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter

from ..workers import frame_workers
from .lab_colors import lab_of_linear
from .lookup_table import LookupTable
from .pixels import PixelFormat
from .recoloring import Recoloring

# Pixels that are worked on at once, by each thread.
_AT_ONCE = 1 << 17
# Contrast in L below which the edge-aware filter averages, squared.
_EDGE = 4.0


@dataclass(frozen=True)
class Block:
    """Rows of an image, and those around them that the filter sees."""

    first: int
    last: int
    above: int
    below: int

    @property
    def seen(self) -> slice:
        """All of these rows."""
        return slice(self.first - self.above, self.last + self.below)

    @property
    def own(self) -> slice:
        """Those that are recolored, as seen from the first of all."""
        return slice(self.above, self.above + self.last - self.first)


def recolored_blocks(
    pixels: NDArray[np.float32],
    pixel_format: PixelFormat,
    change: Recoloring | LookupTable,
    mask: NDArray[np.float32] | None,
    out: NDArray[np.float32],
    check: Callable[[], None] | None = None,
    workers: int | None = None,
) -> Iterator[float]:
    """Recolor an image, and yield the share that is done.

    Parameters
    ----------
    pixels : (height, width, 4) float32
        Red, green, blue, alpha; alpha stays. Pixels that hold no finite numbers stay as they are.
    pixel_format : PixelFormat
        What they mean.
    change : Recoloring or LookupTable
        What to do; a table is quicker, and right to about a level of 255. It holds for values from 0 to 1.
    mask : (height, width) float32 or None
        From 0 to 1: how much of the change is made.
    out : (height, width, 4) float32
        Where to; may be `pixels` unless the edge-aware filter is on.
    check : callable, optional
        Called at every block; what it raises ends the work.
    workers : int, optional
        Threads; by default one per processor.
    """
    blocks = _blocks(pixels.shape, 2 * change.settings.edge_radius if isinstance(change, Recoloring) else 0)
    count, done = len(blocks), 0

    def work(block: Block) -> None:
        part = None if mask is None else mask[block.seen]
        _recolor(pixels[block.seen], pixel_format, change, part, block.own, out[block.first : block.last])

    threads = workers or os.cpu_count() or 1
    with frame_workers(threads) as executor:
        waiting, ahead = iter(blocks), 2 * threads
        running: deque[Future[None]] = deque(executor.submit(work, block) for block in islice(waiting, ahead))
        while running:
            running.popleft().result()
            if check is not None:
                check()
            running.extend(executor.submit(work, block) for block in islice(waiting, 1))
            done += 1
            yield done / count


def _blocks(shape: tuple[int, ...], margin: int) -> list[Block]:
    height, width = shape[:2]
    rows = max(1, _AT_ONCE // max(width, 1), 4 * margin)
    starts = range(0, height, rows)
    return [
        Block(start, min(start + rows, height), min(margin, start), min(margin, max(height - start - rows, 0)))
        for start in starts
    ]


def _recolor(
    pixels: NDArray[np.float32],
    pixel_format: PixelFormat,
    change: Recoloring | LookupTable,
    mask: NDArray[np.float32] | None,
    own: slice,
    out: NDArray[np.float32],
) -> None:
    """Recolor a block; `own` are the rows of it that go to `out`."""
    with np.errstate(invalid="ignore", over="ignore"):
        linear = pixel_format.linear(pixels)
    usable = np.isfinite(linear).all(axis=0) & np.isfinite(pixels[..., 3])
    np.copyto(linear, 0.0, where=~usable)
    if isinstance(change, LookupTable):
        found = change.applied_linear(linear)
        if mask is not None:
            found = linear + mask * (found - linear)
    else:
        lab = lab_of_linear(linear)
        shifts = change.shifts(lab)
        if change.settings.edge_radius:
            shifts = _along_edges(shifts, lab[0], change.settings.edge_radius)
        if mask is not None:
            shifts *= mask
        found = change.finished(linear, lab, shifts, pixel_format.highest)
    old, alpha = pixels[own], pixels[own][..., 3]
    moved = usable[own] & (alpha > 0) & (found[:, own] != linear[:, own]).any(axis=0)
    new = pixel_format.encoded(found[:, own], alpha)
    out[..., 3] = alpha
    out[..., :3] = np.where(moved[..., None], new, old[..., :3])


def _along_edges(shifts: NDArray[np.float32], guide: NDArray[np.float32], radius: int) -> NDArray[np.float32]:
    """Average changes where L is even, and keep them apart at its edges: the guided filter of He et al. 2013."""
    size = 2 * radius + 1

    def mean(values: NDArray[np.float32]) -> NDArray[np.float32]:
        return uniform_filter(values, size, mode="nearest")

    middle = mean(guide)
    variance = np.maximum(mean(guide * guide) - middle * middle, 0.0)
    found = np.empty_like(shifts)
    for values, own in zip(shifts, found, strict=True):
        average = mean(values)
        slope = (mean(guide * values) - middle * average) / (variance + _EDGE)
        own[...] = mean(slope) * guide + mean(average - slope * middle)
    return found
