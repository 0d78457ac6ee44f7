# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What a solver asks of a domain: area weights and the heat kernel, in logarithms."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .region import Region


class KernelTooNarrowError(ArithmeticError):
    """The numerics of a domain do not reach from a distribution to all of another one's mass."""


class Domain(Protocol):
    """A place where distributions live. Solvers take one and never ask which.

    Attributes
    ----------
    shape : tuple of int
        Shape of one distribution.
    weights : float or ndarray of `shape`
        Area weights a, with sum 1; a float where all are equal.
    gamma : float
        Entropic regularization, K = exp(-d^2 / gamma), in lengths of the domain rescaled to unit volume.
    unit_length : float
        The domain's unit of length in the units that its maker uses: cells, or those of the vertices.
    positions : ndarray, (*shape, d)
        Where the elements lie, in the units of the maker.
    pieces : None or ndarray of int, `shape`
        The connected piece that every element belongs to; None where the domain is in one piece. Mass cannot cross.
    dimension : int
        Of what the distributions live on.
    has_quadratic_cost : bool
        Whether transport by this kernel costs the squared distance at all distances.
    has_fast_propagation : bool
        Whether propagation starts from coarser domains, and takes longer steps under a bound of the entropy; measured
        to take a fraction of the time on meshes.
    has_fast_balance : bool
        Whether Sinkhorn's iteration takes so few rounds here that a start from coarser domains has not been measured
        to help.
    relaxation : float
        Over-relaxation that has been measured to help the plain iterations here; 1 for none.
    far_numerics : str
        What :meth:`log_apply_far` is called in records.
    """

    shape: tuple[int, ...]
    weights: float | NDArray[np.float64]
    gamma: float
    unit_length: float
    positions: NDArray[np.float64]
    pieces: NDArray[np.int64] | None
    dimension: int
    has_quadratic_cost: bool
    has_fast_propagation: bool
    has_fast_balance: bool
    relaxation: float
    far_numerics: str

    def apply(self, columns: ArrayLike) -> NDArray[np.float64]:
        """H (a * column) of every column."""

    def log_apply(self, logs: NDArray[np.float64], out: NDArray[np.float64]) -> None:
        """Write log H (a * exp(column)) to `out`; LOG_NOTHING where float64 scalings cannot express it."""

    def log_apply_far(self, logs: NDArray[np.float64], out: NDArray[np.float64]) -> None:
        """Write the same by numerics that reach further, at a higher cost, or raise KernelTooNarrowError."""

    def log_transfer(
        self, columns: Sequence[NDArray[np.float64]], sources: Sequence[Region], targets: Sequence[Region]
    ) -> list[NDArray[np.float64]]:
        """Do as log_apply: each column has the elements of its source, and is wanted at those of its target."""

    def log_transfer_far(
        self, columns: Sequence[NDArray[np.float64]], sources: Sequence[Region], targets: Sequence[Region]
    ) -> list[NDArray[np.float64]]:
        """Do as log_apply_far between regions."""

    def kernel_distance(
        self, log_values: NDArray[np.float64], log_at_source: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Distances in units of the domain at which the kernel in flat space falls from its source to these values."""

    def squared_distance(self, divergence: NDArray[np.float64]) -> NDArray[np.float64]:
        """Squared distance, in units of the domain, of transport that costs `divergence` by this kernel, debiased."""

    def cost_slope(self, distance: NDArray[np.float64]) -> NDArray[np.float64]:
        """Slope, by the distance in units of the domain, of what transport over it costs by this kernel."""

    def coarser(self) -> Domain | None:
        """Return the domain of half the resolution, if there is a useful one."""


class Multiscale(Domain, Protocol):
    """A domain whose :meth:`coarser` is not None.

    Attributes
    ----------
    fall_of_gamma : float
        The coarser domain's gamma over this one's: potentials over gamma grow by it from there to here.
    """

    fall_of_gamma: float

    def restrict(self, columns: NDArray[np.float64]) -> NDArray[np.float64]:
        """Densities on the coarser domain, (k, *its shape), of those here, (k, *shape)."""

    def prolong(self, columns: NDArray[np.float64], region: Region) -> NDArray[np.float64]:
        """Columns of the coarser domain, (k, *its shape), interpolated to a region of this one, (k, len)."""

    def refined(self, support: Region, region: Region) -> Region:
        """Elements here that a solve needs whose density on the coarser domain has a `support` within a `region`."""


def total_mass(density: NDArray[np.float64], weights: float | NDArray[np.float64]) -> float:
    """Return a^T density, the mass of a density of the domain's shape."""
    if isinstance(weights, float):
        return float(density.sum()) * weights
    return float((density * weights).sum())
