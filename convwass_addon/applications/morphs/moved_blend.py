# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A blend of inputs that have been moved towards each other, kept to extract its surface again."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..motions.motion import MovedShape
from .coinciding_solids import CoincidingSolids
from .layouts import Blend
from .morph_problem import MorphProblem


@dataclass(frozen=True)
class MovedBlend:
    """One blend of inputs that have been moved towards each other.

    Attributes
    ----------
    blend : Blend
        The blend, without zero weights.
    problem : MorphProblem
        The moved inputs of positive weight; without parts if they coincide, so that there is nothing to transport.
    shapes : list of MovedShape
        The same inputs.
    active : (a,) int64
        Their indices among all inputs.
    occupancies : list of (nx, ny, nz) float32
        Fraction of every cell that each fills.
    solids : CoincidingSolids
        Their mean, where they coincide.
    volume : float
        Volume of the blend in cells: the weighted mean of the inputs' volumes at rest.
    """

    blend: Blend
    problem: MorphProblem
    shapes: list[MovedShape]
    active: NDArray[np.int64]
    occupancies: list[NDArray[np.float32]]
    solids: CoincidingSolids
    volume: float

    @property
    def coincides(self) -> bool:
        """Whether nothing is left to transport."""
        return self.solids.coincide

    @property
    def bytes(self) -> int:
        """Memory that its grids take, about two thirds of all."""
        grids = (*self.occupancies, self.solids.density, self.solids.agreement, self.solids.depths)
        # One number may stand for all cells.
        return sum(grid.nbytes for grid in grids if all(grid.strides))
