# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Grids with room for shapes that move, solid and flat."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from ...progress import Control
from .layouts import Blend

# Free cells around moved shapes, for the blur.
_MARGIN = 4
# Moved shapes are looked at for so many blends, evenly spread, and room in cells for what lies between two of them.
_SAMPLED_BLENDS, _SLACK_CELLS = 33, 2


class Cells(Protocol):
    """A grid, as a frozen dataclass: cells per axis, their size, and where the low corner is."""

    shape: tuple[int, ...]
    spacing: float
    origin: NDArray[np.float64]


AnyLattice = TypeVar("AnyLattice", bound=Cells)


@dataclass(frozen=True)
class Room:
    """What moved shapes need.

    Attributes
    ----------
    low, high : (d,) float64
        Corners of a box around them relative to the centers of the shapes, scene units.
    slack : int
        Cells that are to be free around it besides the margin for the blur.
    """

    low: NDArray[np.float64]
    high: NDArray[np.float64]
    slack: int = 0

    def in_lattice(self, lattice: AnyLattice, multiple: int) -> AnyLattice:
        """Return a lattice with the same cells and as many more as the box needs; sides are multiples of `multiple`."""
        margin = _MARGIN + self.slack
        below = np.ceil((lattice.origin - self.low) / lattice.spacing + margin).clip(min=0)
        end = np.maximum((self.high - lattice.origin) / lattice.spacing + margin, lattice.shape)
        cells = (np.ceil((end + below) / multiple - 1e-9) * multiple).astype(int)
        return replace(lattice, shape=tuple(int(n) for n in cells), origin=lattice.origin - below * lattice.spacing)


def room_of_moved(
    bounds: Callable[[Sequence[float]], Iterable[NDArray[np.float64]]],
    centers: NDArray[np.float64],
    blends: Sequence[Blend],
    control: Control,
) -> Room | None:
    """Find the room that moved shapes need in all blends.

    Parameters
    ----------
    bounds : callable
        Gives the low and the high corners, (2, d), of all that moves in the blend with some weights, scene units.
    centers : (k, d)
        Of the shapes.
    blends : sequence of Blend
        All of them; of many, some are looked at.
    control : Control
        Stops the work.

    Returns
    -------
    Room or None
        None where no shapes are mixed.
    """
    mixed = [blend for blend in blends if blend.source is None]
    if not mixed:
        return None
    chosen = np.unique(np.linspace(0, len(mixed) - 1, min(len(mixed), _SAMPLED_BLENDS)).round().astype(int))
    boxes = []
    for index in chosen:
        control.check()
        weights = mixed[index].weights
        boxes += [box - np.asarray(weights) @ centers for box in bounds(weights)]
    found = np.stack(boxes)
    slack = 0 if len(chosen) == len(mixed) else _SLACK_CELLS
    return Room(found[:, 0].min(axis=0), found[:, 1].max(axis=0), slack)
