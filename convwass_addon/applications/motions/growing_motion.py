# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Motions between inputs of different size, scaled so that their volume grows evenly instead of their lengths."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .motion import Motion, MovedShape


def growth(weights: ArrayLike, volumes: ArrayLike) -> float:
    """Return by how much similar shapes with interpolated lengths must be scaled to have the interpolated volume.

    With volumes V_i and weights w_i, lengths grow like sum_i w_i V_i^(1/3), but the volume of a blend is sum_i w_i V_i.

    Parameters
    ----------
    weights : (k,)
        Weights of sum 1.
    volumes : (k,)
        Volumes of the shapes, in any unit.

    Returns
    -------
    float
        1 for equal volumes, else more: 1.01 at the middle between volumes of 1 and 2, 1.12 between 1 and 10.
    """
    weights, volumes = np.asarray(weights, np.float64), np.asarray(volumes, np.float64)
    return float(np.cbrt(weights @ volumes) / (weights @ np.cbrt(volumes)))


@dataclass(frozen=True)
class GrowingMotion:
    """A motion whose shapes are scaled about the interpolated center, so that their volume grows evenly.

    Otherwise, a blend of a small and a large shape encloses less than its volume, and its surface would have to be
    offset by many cells.

    Attributes
    ----------
    motion : Motion
        The motion, which interpolates lengths.
    volumes : (k,) float64
        Volumes of the inputs, in any unit.
    centers : (k, 3) float64
        Centers of the inputs in scene space.
    """

    motion: Motion
    volumes: NDArray[np.float64]
    centers: NDArray[np.float64]

    def moved(self, weights: Sequence[float]) -> list[MovedShape | None]:
        """Return the moved inputs; see :meth:`.motion.Motion.moved`."""
        scale, center = growth(weights, self.volumes), np.asarray(weights) @ self.centers
        return [None if shape is None else shape.scaled(scale, center) for shape in self.motion.moved(weights)]
