# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Distributions on domains of several connected components, each of which keeps its mass."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .domain import Domain
from .log_range import LOG_NOTHING


def piece_masses(densities: NDArray[np.float64], domain: Domain) -> NDArray[np.float64]:
    """Return the mass of every density, (k, *shape), on every connected component of their domain, (k, p)."""
    if domain.pieces is None:
        return np.ones((len(densities), 1))
    labels = domain.pieces.ravel()
    used = labels >= 0
    return np.stack([np.bincount(labels[used], (density * domain.weights).ravel()[used]) for density in densities])


@dataclass(frozen=True)
class PieceMasses:
    """The mass of every connected component.

    Attributes
    ----------
    labels : (n,) int64
        The component of every element.
    masses : (p,) float64
        The mass of every component, of sum 1.
    """

    labels: NDArray[np.int64]
    masses: NDArray[np.float64]

    @classmethod
    def of(cls, density: NDArray[np.float64], domain: Domain) -> PieceMasses | None:
        """Return the masses of a distribution, or None where one component holds all mass and needs no balancing."""
        if domain.pieces is None:
            return None
        # Elements outside all components have no area, so they may be counted anywhere.
        labels = np.maximum(domain.pieces.ravel(), 0)
        masses = np.bincount(labels, (density * domain.weights).ravel())
        return cls(labels, masses) if np.count_nonzero(masses) > 1 else None

    def sums(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the sums of `values`, (n,), over every component."""
        return np.bincount(self.labels, values, len(self.masses))

    def tops(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the maximum of `values`, (n,), on every component."""
        tops = np.full(len(self.masses), LOG_NOTHING)
        np.maximum.at(tops, self.labels, values)
        return tops

    def balanced(self, log_mu: NDArray[np.float64], weights: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return ln mu, (n,), shifted on every component so that each has its mass."""
        tops = self.tops(log_mu)
        sums = self.sums(np.exp(log_mu - tops[self.labels]) * weights)
        holds = (self.masses > 0) & (sums > 0)
        shifts = np.zeros(len(sums))
        shifts[holds] = np.log(self.masses[holds] / sums[holds]) - tops[holds]
        return np.where(holds[self.labels], log_mu + shifts[self.labels], LOG_NOTHING)
