# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Motions whose shapes have about the volume of similar shapes of interpolated size.

The wall of a vase that fills up to become a bottle soon becomes thick. To reach the volume of the blend, its surface
would be offset by so much that thin walls vanish.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..motions.motion import Motion, MovedShape
from .section_motion import moved_towards_mean

# Volumes that differ by up to this factor are reached by an offset of the surface, which keeps the size.
_OFFSET = 1.05


@dataclass(frozen=True)
class EvenVolumeMotion:
    """Scales moved shapes about the interpolated center where their volume is far off; a :class:`.motion.Motion`.

    Attributes
    ----------
    motion : Motion
        The motion.
    volumes : (k,) float64
        Volumes of the shapes at rest.
    centers : (k, 3) float64
        Their centers.
    way : float
        How far the motion moves shapes towards each other, from 0 to 1.
    """

    motion: Motion
    volumes: NDArray[np.float64]
    centers: NDArray[np.float64]
    way: float

    def moved(self, weights: Sequence[float]) -> list[MovedShape | None]:
        """Return every shape in a blend; see :meth:`.motion.Motion.moved`."""
        sizes, centers = (moved_towards_mean(own, weights, self.way) for own in (np.cbrt(self.volumes), self.centers))
        return [
            None if own is None else _scaled(own, size**3, center)
            for own, size, center in zip(self.motion.moved(weights), sizes, centers, strict=True)
        ]


def _scaled(shape: MovedShape, wanted: float, center: NDArray[np.float64]) -> MovedShape:
    """Scale a shape so that its volume is nearly the wanted one."""
    ratio = wanted / shape.mesh.volume
    return shape.scaled(float(np.cbrt(ratio / np.clip(ratio, 1.0 / _OFFSET, _OFFSET))), center)
