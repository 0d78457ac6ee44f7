# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The stored part of a solve: enough to solve neighboring blends in a round or two."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...transport import Barycenter
from ...transport.log_range import LOG_NOTHING
from ...transport.potentials import Potentials
from ...transport.region import Region


@dataclass(frozen=True)
class PartPotentials:
    """The finest level of the solve of one part, in single precision, which far exceeds the accuracy of the solve.

    Attributes
    ----------
    inside : (nx, ny, nz) bool
        Mask of the cells where the barycenter may have mass.
    columns : (k + 1, n) float32
        ln v at these cells for the k shapes of positive weight, and ln d of the debiasing density.
    sharpness : float
        Sharpness of the solve.
    sigma : float
        The blur that was needed, in cells.
    """

    inside: NDArray[np.bool_]
    columns: NDArray[np.float32]
    sharpness: float
    sigma: float

    def __post_init__(self) -> None:
        """Check the values.

        Raises
        ------
        ValueError
            Values that no solve can produce; the message states in a few words what is wrong.
        """
        if self.inside.ndim != 3 or not self.inside.any():
            raise ValueError("its potentials have no cells")
        if self.columns.ndim != 2 or len(self.columns) < 2 or self.columns.shape[1] != np.count_nonzero(self.inside):
            raise ValueError("its potentials do not have the size of their cells")
        if not (np.isfinite(self.columns).all() and self.columns.min() >= LOG_NOTHING):
            raise ValueError("its potentials are not numbers")
        if not (0.0 <= self.sharpness <= 1.0 and 0.0 < self.sigma < np.inf):
            raise ValueError("its potentials are of no solve")

    @classmethod
    def of(cls, solved: Barycenter, sigma: float) -> PartPotentials:
        """Store the finest level of a barycenter that was solved with a blur of `sigma` cells."""
        finest = solved.levels[-1]
        return cls(finest.region.inside, finest.columns.astype(np.float32), solved.sharpness, sigma)

    def suit(self, shape: tuple[int, ...], weights: ArrayLike) -> bool:
        """Whether the potentials can belong to a blend with these weights on a grid of this shape."""
        return self.inside.shape == tuple(shape) and len(self.columns) == np.count_nonzero(weights) + 1

    def barycenter(self, weights: ArrayLike) -> Barycenter:
        """Return a barycenter with these potentials as a start for others; its density and figures are not known."""
        columns = self.columns.astype(np.float64)
        return Barycenter(
            density=np.broadcast_to(np.float64(np.nan), self.inside.shape),
            levels=(Potentials(Region(self.inside), columns[:-1], columns[-1]),),
            weights=np.asarray(weights, dtype=np.float64),
            sharpness=self.sharpness,
            iterations=(0,),
            marginal_error=np.inf,
            debias_error=np.inf,
            mass=np.inf,
            mass_error=np.inf,
            invariant_error=np.inf,
            converged=False,
            areas=1.0 / self.inside.size,
            numerics="",
            entropy=np.inf,
            sharpening_exponent=1.0,
        )
