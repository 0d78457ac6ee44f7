# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Common base of domains with a Gaussian kernel: its cost and its width on coarser domains."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

# A coarser domain keeps the kernel of the finer one unless its width in coarse elements would be less than this; then
# it keeps sigma (docs/performance, "Constants of the barycenter").
_NARROWEST_COARSE = 1.25


class GaussianKernel:
    """A domain whose kernel is a constant times exp(-d^2 / gamma), with d the distance.

    Attributes
    ----------
    sigma : float
        Standard deviation of the kernel in elements of the domain.
    gamma : float
        2 sigma^2 in lengths of the domain rescaled to unit volume.
    """

    has_quadratic_cost = True

    sigma: float
    gamma: float

    def kernel_distance(
        self, log_values: NDArray[np.float64], log_at_source: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Distances, in units of the domain, at which the Gaussian falls from its source to these values."""
        return np.sqrt(self.gamma * np.maximum(log_at_source - log_values, 0.0))

    def squared_distance(self, divergence: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the divergence itself: transport with a Gaussian kernel costs the squared distance."""
        return divergence

    def cost_slope(self, distance: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the derivative of the squared distance."""
        return 2.0 * distance

    @property
    def coarser_sigma(self) -> float:
        """Sigma on the domain of half the resolution, in its elements."""
        return min(self.sigma, max(self.sigma / 2.0, _NARROWEST_COARSE))

    @property
    def fall_of_gamma(self) -> float:
        """Ratio of gamma on the domain of half the resolution to gamma here."""
        return (2.0 * self.coarser_sigma / self.sigma) ** 2
