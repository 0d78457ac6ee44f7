# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Layouts of blends: along a path, on a sheet, or a single one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from ...errors import InputError
from ..blend_weights import normalized_weights


@dataclass(frozen=True)
class Blend:
    """One mixture of the input shapes.

    Attributes
    ----------
    weights : tuple of float
        One per input, sum 1.
    frame : int or None
        Scene frame relative to the first one, in an animation; None on a sheet.
    place : (float, float)
        Column and row on a sheet, in steps; (0, 0) in an animation.
    """

    weights: tuple[float, ...]
    frame: int | None = None
    place: tuple[float, float] = (0.0, 0.0)

    @property
    def source(self) -> int | None:
        """Index of the input that is shown unblended because its weight is 1."""
        return self.weights.index(1.0) if 1.0 in self.weights else None


def path_blends(count: int, frames: int, step: int = 1) -> list[Blend]:
    """Blend `count` shapes in order, with `frames` scene frames from each to the next.

    The first shape is shown at frame 0, the second at `frames`, and so on, with a blend at every `step` frames in
    between.

    Raises
    ------
    InputError
        Fewer than two shapes or frames, or a step below one.
    """
    if count < 2:
        raise InputError("A morph needs at least two shapes; select or name one more.")
    if frames < 2:
        raise InputError("There must be at least 2 frames from one shape to the next, got {frames}.", frames=frames)
    if step < 1:
        raise InputError("The step must be at least 1 frame, got {step}.", step=step)
    blends = [Blend((1.0, *[0.0] * (count - 1)), frame=0)]
    for leg in range(count - 1):
        for frame in [*range(step, frames, step), frames]:
            t = frame / frames
            weights = [0.0] * count
            weights[leg], weights[leg + 1] = 1.0 - t, t
            blends.append(Blend(tuple(weights), frame=leg * frames + frame))
    return blends


def grid_blends(count: int, steps: int) -> list[Blend]:
    """Return a bilinear sheet of four shapes, `steps` by `steps`: top left, top right, bottom left, bottom right.

    Raises
    ------
    InputError
        Not four shapes, or fewer than two steps.
    """
    if count != 4:
        raise InputError("The grid layout blends exactly four shapes, one per corner; there are {count}.", count=count)
    _check_steps(steps)
    blends = []
    for row in range(steps):
        for column in range(steps):
            x, y = column / (steps - 1), row / (steps - 1)
            weights = ((1 - x) * (1 - y), x * (1 - y), (1 - x) * y, x * y)
            blends.append(Blend(weights, place=(float(column), float(row))))
    return blends


def triangle_blends(count: int, steps: int) -> list[Blend]:
    """Return a triangular sheet of three shapes, `steps` blends along each side: bottom left, bottom right, top.

    Raises
    ------
    InputError
        Not three shapes, or fewer than two steps.
    """
    if count != 3:
        raise InputError(
            "The triangle layout blends exactly three shapes, one per corner; there are {count}.", count=count
        )
    _check_steps(steps)
    last = steps - 1
    blends = []
    for top in reversed(range(steps)):
        for right in range(steps - top):
            weights = ((last - top - right) / last, right / last, top / last)
            blends.append(Blend(weights, place=(right + top / 2.0, float(last - top))))
    return blends


def single_blend(weights: Sequence[float], count: int) -> list[Blend]:
    """Return one blend with the given weights, scaled to sum 1.

    Raises
    ------
    InputError
        The number of weights differs from that of shapes, or weights are negative or all zero.
    """
    return [Blend(tuple(normalized_weights(weights, count).tolist()))]


def pairs_of(blends: Sequence[Blend]) -> list[tuple[int, int]]:
    """Return the pairs of inputs that occur together in a blend, smaller index first."""
    active = {tuple(np.flatnonzero(blend.weights).tolist()) for blend in blends}
    return sorted({pair for together in active for pair in combinations(together, 2)})


def _check_steps(steps: int) -> None:
    if steps < 2:
        raise InputError("A sheet needs at least 2 blends along each side, got {steps}.", steps=steps)
