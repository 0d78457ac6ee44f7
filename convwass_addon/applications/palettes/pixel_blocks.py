# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Recolor whole images in blocks, which needs little memory beyond the image itself."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from ...progress import UNINTERRUPTED, Control, Progress, Work
from ...sentence import Sentence
from ..workers import frame_workers, thread_count
from .distinct_colors import LEVELS, color_keys, distinct_colors, present_flags
from .lookup_table import LookupTable
from .pixel_change import recolor_rows
from .pixels import PixelFormat
from .recoloring import Recoloring

# Number of pixels that each thread processes at once.
_AT_ONCE = 1 << 16
# Fractions of the work at which distinct colors have been collected, and recolored.
_NOTED, _CHANGED = 0.3, 0.7
# If distinct colors exceed this fraction of the pixels, treating each only once saves nothing.
_FEW = 0.5


@dataclass(frozen=True)
class Block:
    """Rows of an image, with additional rows above and below for the filter."""

    first: int
    last: int
    above: int
    below: int

    @property
    def seen(self) -> slice:
        """All rows, including the additional ones."""
        return slice(self.first - self.above, self.last + self.below)

    @property
    def own(self) -> slice:
        """The rows to recolor, relative to the first of all rows."""
        return slice(self.above, self.above + self.last - self.first)


def recolored_blocks(
    pixels: NDArray[np.float32],
    pixel_format: PixelFormat,
    change: Recoloring | LookupTable,
    mask: NDArray[np.float32] | None,
    out: NDArray[np.float32],
    control: Control = UNINTERRUPTED,
    workers: int | None = None,
) -> Work[None]:
    """Recolor an image, reporting progress after every block.

    Parameters
    ----------
    pixels : (height, width, 4) float32
        Red, green, blue, alpha; alpha is preserved. Pixels that are not finite are preserved.
    pixel_format : PixelFormat
        Meaning of the values.
    change : Recoloring or LookupTable
        The map to apply. A table is faster and accurate to about one 8-bit level; it covers values from 0 to 1.
    mask : (height, width) float32 or None
        Strength of the change, from 0 to 1.
    out : (height, width, 4) float32
        Output; may be `pixels` unless the edge-aware filter is on.
    control : Control
        Stops the work when cancelled.
    workers : int, optional
        Number of threads; by default one per processor.
    """
    # With a mask or filter, the result for a color depends on its place.
    is_the_same_everywhere = mask is None and not _radius(change)
    recolor = _by_distinct_colors if pixel_format.levels == LEVELS and is_the_same_everywhere else _by_pixels
    threads = thread_count(workers)
    with frame_workers(threads) as executor:
        pool = _Pool(executor, threads, control)
        yield from recolor(_Task(pixels, pixel_format, change, mask, out), pool)


@dataclass(frozen=True)
class _Task:
    """The arguments of :func:`recolored_blocks`."""

    pixels: NDArray[np.float32]
    pixel_format: PixelFormat
    change: Recoloring | LookupTable
    mask: NDArray[np.float32] | None
    out: NDArray[np.float32]


@dataclass(frozen=True)
class _Pool:
    """The threads and the control that stops them."""

    executor: Executor
    threads: int
    control: Control

    def run(self, work: Callable[[Block], None], blocks: Sequence[Block], begun: float, ended: float) -> Work[None]:
        """Process all blocks, reporting progress from `begun` to `ended`."""
        waiting = iter(blocks)
        running = deque(self.executor.submit(work, block) for block in islice(waiting, 2 * self.threads))
        done = 0
        while running:
            running.popleft().result()
            self.control.check()
            running.extend(self.executor.submit(work, block) for block in islice(waiting, 1))
            done += 1
            yield Progress(begun + (ended - begun) * done / len(blocks), Sentence("Recoloring"))


def _by_pixels(task: _Task, pool: _Pool, begun: float = 0.0) -> Work[None]:
    """Recolor every pixel separately."""

    def work(block: Block) -> None:
        part = None if task.mask is None else task.mask[block.seen]
        out = task.out[block.first : block.last]
        recolor_rows(task.pixels[block.seen], task.pixel_format, task.change, part, block.own, out)

    yield from pool.run(work, _blocks(task.pixels.shape, 2 * _radius(task.change)), begun, 1.0)


def _by_distinct_colors(task: _Task, pool: _Pool) -> Work[None]:
    """Recolor every distinct color once, and assign it to all of its pixels."""
    shape = task.pixels.shape
    present, keys = present_flags(), np.empty(shape[:2], dtype=np.uint32)

    def note(block: Block) -> None:
        keys[block.seen] = color_keys(task.pixels[block.seen])
        present[keys[block.seen]] = True

    yield from pool.run(note, _blocks(shape, 0), 0.0, _NOTED)
    if np.count_nonzero(present) > _FEW * keys.size:
        yield from _by_pixels(task, pool, _NOTED)
        return
    colors = distinct_colors(present)
    found = np.empty_like(colors.pixels)
    rows = [colors.pixels.reshape(-1, 1, 4), found.reshape(-1, 1, 4)]
    yield from pool.run(
        lambda block: recolor_rows(
            rows[0][block.seen], task.pixel_format, task.change, None, block.own, rows[1][block.seen]
        ),
        _blocks(rows[0].shape, 0),
        _NOTED,
        _CHANGED,
    )

    def give(block: Block) -> None:
        old, new = task.pixels[block.seen], found[0].take(colors.ranks[keys[block.seen]], axis=0)
        alpha = old[..., 3]
        new[..., 3] = alpha
        clear = ~(alpha > 0)
        if clear.any():
            new[clear] = old[clear]
        task.out[block.seen] = new

    yield from pool.run(give, _blocks(shape, 0), _CHANGED, 1.0)


def _radius(change: Recoloring | LookupTable) -> int:
    return change.settings.edge_radius if isinstance(change, Recoloring) else 0


def _blocks(shape: tuple[int, ...], margin: int) -> list[Block]:
    height, width = shape[:2]
    rows = max(1, _AT_ONCE // max(width, 1), 2 * margin)
    starts = range(0, height, rows)
    return [
        Block(start, min(start + rows, height), min(margin, start), min(margin, max(height - start - rows, 0)))
        for start in starts
    ]
