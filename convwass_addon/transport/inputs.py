# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Distributions prepared for many barycenters."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..one_line import one_line
from .checks import check_distributions
from .domain import Domain
from .region import Region
from .sharpening import entropy


@dataclass(frozen=True)
class Level:
    """Distributions on one domain of a coarse-to-fine hierarchy.

    Attributes
    ----------
    domain : Domain
        Their domain.
    regions : tuple of Region
        The support of each distribution.
    log_mus : tuple of (len(region),) float64
        Logarithms of the densities on the support.
    """

    domain: Domain
    regions: tuple[Region, ...]
    log_mus: tuple[NDArray[np.float64], ...]

    @classmethod
    def of(cls, mus: NDArray[np.float64], domain: Domain) -> Level:
        """Restrict densities, (k, *shape), to their supports."""
        regions = tuple(Region(mu > 0) for mu in mus)
        return cls(domain, regions, tuple(np.log(r.gather(mu)) for r, mu in zip(regions, mus, strict=True)))

    def chosen(self, active: Sequence[int] | NDArray[np.int64]) -> Level:
        """Only some of the distributions."""
        return Level(self.domain, tuple(self.regions[i] for i in active), tuple(self.log_mus[i] for i in active))


@dataclass(frozen=True)
class Inputs:
    """Distributions that were validated, normalized, restricted to coarser domains and stored on their supports.

    Barycenters with many different weights share one of these, also across threads.

    Attributes
    ----------
    levels : tuple of Level
        Coarse to fine; the last is on the domain itself.
    entropies : (k,) float64
        In nats.
    finest : Domain, optional
        Where solves end, if these are only the coarser levels of a hierarchy; see `coarser`.
    """

    levels: tuple[Level, ...]
    entropies: NDArray[np.float64]
    finest: Domain | None = None

    __repr__ = one_line("domain", "entropies")

    @classmethod
    def of(cls, mus: ArrayLike, domain: Domain) -> Inputs:
        """Prepare densities, (k, *domain.shape).

        Raises
        ------
        ValueError
            As :func:`barycenter` for its `mus`.
        """
        densities = check_distributions(mus, domain)
        entropies = np.array([entropy(mu, domain.weights) for mu in densities])
        levels = [Level.of(densities, domain)]
        while (coarser := domain.coarser()) is not None:
            densities = domain.restrict(densities)
            domain = coarser
            levels.insert(0, Level.of(densities, domain))
        return cls(tuple(levels), entropies)

    def on(self, domain: Domain) -> Inputs:
        """Return the same distributions on a domain of the same shape with another kernel."""
        levels = [Level(domain, self.levels[-1].regions, self.levels[-1].log_mus)]
        for level in self.levels[-2::-1]:
            domain = domain.coarser()
            levels.insert(0, Level(domain, level.regions, level.log_mus))
        return Inputs(tuple(levels), self.entropies)

    @property
    def coarser(self) -> Inputs:
        """The same distributions without their finest level, to solve a preview.

        Solved with the same options, with lengths in units of the finest domain, their barycenter is what the full
        solve starts from.

        Raises
        ------
        ValueError
            There is only one level.
        """
        if len(self.levels) == 1:
            raise ValueError("inputs on one level have no coarser ones")
        return Inputs(self.levels[:-1], self.entropies, self.aim)

    def __len__(self) -> int:
        return len(self.entropies)

    @property
    def domain(self) -> Domain:
        """The domain of the distributions."""
        return self.levels[-1].domain

    @property
    def aim(self) -> Domain:
        """The domain on which solves end: this one, unless these are the coarser levels of a finer one."""
        return self.domain if self.finest is None else self.finest
