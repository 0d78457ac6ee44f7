# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The interface between solvers and domains: area weights and the heat kernel, in logarithms."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .region import Region


class KernelTooNarrowError(ArithmeticError):
    """The numerics of a domain cannot reach all mass of one distribution from another."""


class Domain(Protocol):
    """A space on which distributions are defined. Solvers use only this interface.

    Attributes
    ----------
    shape : tuple of int
        Shape of one distribution.
    weights : float or ndarray of `shape`
        Area weights a, of sum 1; a float where all are equal.
    gamma : float
        Entropic regularization, K = exp(-d^2 / gamma), in lengths of the domain rescaled to unit volume.
    unit_length : float
        The domain's unit of length in its input units: cells, or the units of the vertices.
    positions : ndarray, (*shape, d)
        Positions of the elements in the input units.
    pieces : None or ndarray of int, `shape`
        The connected component of every element; None if the domain is connected. Mass cannot cross components.
    dimension : int
        Dimension of the space itself: 2 for a surface in 3D.
    has_quadratic_cost : bool
        Whether transport with this kernel costs the squared distance even at long distances.
    has_fast_propagation : bool
        Whether propagation starts from coarser domains and takes longer steps under an entropy bound, which was
        measured to be several times faster on meshes.
    has_fast_balance : bool
        Whether Sinkhorn's iteration converges so fast that starting from coarser domains did not help in measurements.
    relaxation : float
        Over-relaxation that was measured to speed up the plain iterations here; 1 for none.
    far_numerics : str
        Name of :meth:`log_apply_far` in records.
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
        """Like :meth:`log_apply`, slower but with a longer range; raises KernelTooNarrowError where that fails too."""

    def log_transfer(
        self, columns: Sequence[NDArray[np.float64]], sources: Sequence[Region], targets: Sequence[Region]
    ) -> list[NDArray[np.float64]]:
        """Like log_apply; each column is given on the elements of its source and returned on those of its target."""

    def log_transfer_far(
        self, columns: Sequence[NDArray[np.float64]], sources: Sequence[Region], targets: Sequence[Region]
    ) -> list[NDArray[np.float64]]:
        """Like log_apply_far, between regions."""

    def kernel_distance(
        self, log_values: NDArray[np.float64], log_at_source: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Distances, in units of the domain, at which the flat-space kernel falls from its source to these values."""

    def squared_distance(self, divergence: NDArray[np.float64]) -> NDArray[np.float64]:
        """Convert the debiased cost of transport with this kernel to a squared distance, in units of the domain."""

    def cost_slope(self, distance: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the derivative of the transport cost of this kernel by the distance (in units of the domain)."""

    def coarser(self) -> Domain | None:
        """Return the domain of half the resolution, or None if it would be of no use."""


class Multiscale(Domain, Protocol):
    """A domain whose :meth:`coarser` is not None.

    Attributes
    ----------
    fall_of_gamma : float
        gamma of the coarser domain divided by gamma of this one. Potentials over gamma grow by this factor when they
        are prolonged.
    """

    fall_of_gamma: float

    def restrict(self, columns: NDArray[np.float64]) -> NDArray[np.float64]:
        """Restrict densities, (k, *shape), to the coarser domain, (k, *its shape)."""

    def prolong(self, columns: NDArray[np.float64], region: Region) -> NDArray[np.float64]:
        """Interpolate columns of the coarser domain, (k, *its shape), to a region of this one, (k, len)."""

    def refined(self, support: Region, region: Region) -> Region:
        """Elements needed here if the density on the coarser domain has this `support` within this `region`."""


def total_mass(density: NDArray[np.float64], weights: float | NDArray[np.float64]) -> float:
    """Return a^T density, the mass of a density of the domain's shape."""
    if isinstance(weights, float):
        return float(density.sum()) * weights
    return float((density * weights).sum())
