# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Enlarge grids so that they hold moving shapes, in space and in a plane."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from ...progress import Control
from .layouts import Blend

# Empty cells around moved shapes, for the blur.
_MARGIN = 4
# Margin in cells for blends in between those at which the extent of moved shapes is measured.
_SLACK_CELLS = 2


class Cells(Protocol):
    """A grid as a frozen dataclass: cells per axis, cell size, and position of the low corner."""

    shape: tuple[int, ...]
    spacing: float
    origin: NDArray[np.float64]


AnyLattice = TypeVar("AnyLattice", bound=Cells)


@dataclass(frozen=True)
class Room:
    """The space that moved shapes need.

    Attributes
    ----------
    low, high : (d,) float64
        Corners of a box around them relative to the centers of the shapes, scene units.
    slack : int
        Further empty cells around it, besides the margin for the blur.
    """

    low: NDArray[np.float64]
    high: NDArray[np.float64]
    slack: int = 0

    def in_lattice(self, lattice: AnyLattice, multiple: int) -> AnyLattice:
        """Return a lattice with the same cells and enough further ones; sides are multiples of `multiple`."""
        first, end = self._span(lattice)
        below, end = (-first).clip(min=0), np.maximum(end, lattice.shape)
        cells = (np.ceil((end + below) / multiple - 1e-9) * multiple).astype(int)
        return replace(lattice, shape=tuple(int(n) for n in cells), origin=lattice.origin - below * lattice.spacing)

    def only_in_lattice(self, lattice: AnyLattice, multiple: int) -> AnyLattice:
        """Return a lattice with the same cells, and no more of them than needed except along the longest side.

        That side is only enlarged, because some lengths are relative to it and should be the same in all blends.
        """
        first, end = self._span(lattice)
        longest = int(np.argmax(lattice.shape))
        first[longest], end[longest] = min(first[longest], 0), max(end[longest], lattice.shape[longest])
        first, end = np.floor(first / multiple) * multiple, np.ceil(end / multiple) * multiple
        cells = tuple(int(n) for n in end - first)
        return replace(lattice, shape=cells, origin=lattice.origin + first * lattice.spacing)

    def _span(self, lattice: Cells) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the first cell needed along each axis, (d,), and where the last one may end, (d,), in cells."""
        margin = _MARGIN + self.slack
        first = np.floor((self.low - lattice.origin) / lattice.spacing - margin)
        return first, (self.high - lattice.origin) / lattice.spacing + margin


def room_of_moved(
    bounds: Callable[[Sequence[float]], Iterable[NDArray[np.float64]]],
    centers: NDArray[np.float64],
    blends: Sequence[Blend],
    count: int,
    control: Control,
) -> Room | None:
    """Find the space that moved shapes need in all blends.

    Parameters
    ----------
    bounds : callable
        Returns the low and high corners, (2, d), of all moved shapes in the blend with given weights, in scene units.
    centers : (k, d)
        Centers of the shapes.
    blends : sequence of Blend
        All blends.
    count : int
        Number of evenly spread blends at which the extent is measured.
    control : Control
        Stops the work.

    Returns
    -------
    Room or None
        None if no blend mixes shapes.
    """
    mixed = [blend for blend in blends if blend.source is None]
    if not mixed:
        return None
    chosen = np.unique(np.linspace(0, len(mixed) - 1, min(len(mixed), count)).round().astype(int))
    boxes = []
    for index in chosen:
        control.check()
        weights = mixed[index].weights
        boxes += [box - np.asarray(weights) @ centers for box in bounds(weights)]
    found = np.stack(boxes)
    slack = 0 if len(chosen) == len(mixed) else _SLACK_CELLS
    return Room(found[:, 0].min(axis=0), found[:, 1].max(axis=0), slack)
