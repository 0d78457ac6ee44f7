# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The space that moving shapes need, in space and in a plane."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...geometry.arrays.bounds import common_bounds
from ...progress import Control
from ..workers import side_by_side
from .layouts import Blend

# Margin in cells for blends in between those at which the extent of moved shapes is measured.
_SLACK_CELLS = 2


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

    def boxes(number: int) -> list[NDArray[np.float64]]:
        control.check()
        weights = mixed[chosen[number]].weights
        return [box - np.asarray(weights) @ centers for box in bounds(weights)]

    found = [box for own in side_by_side(boxes, len(chosen)) for box in own]
    slack = 0 if len(chosen) == len(mixed) else _SLACK_CELLS
    return Room(*common_bounds(found), slack)
