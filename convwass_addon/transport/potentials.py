# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Starting points of barycenter solves: the scalings of another solve, on the same or a coarser domain."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..one_line import one_line
from .domain import Multiscale
from .log_range import LOG_NOTHING
from .region import Region


@dataclass(frozen=True)
class Potentials:
    """The state from which a solve can start.

    Attributes
    ----------
    region : Region
        Where the barycenter may have mass.
    log_v : (k, len(region)) float64
        Logarithms of the scalings on the side of the barycenter.
    log_debias : (len(region),) float64
        Logarithm of the debiasing density d.
    """

    region: Region
    log_v: NDArray[np.float64]
    log_debias: NDArray[np.float64]

    __repr__ = one_line("log_v", "log_debias")

    @classmethod
    def flat(cls, count: int, shape: tuple[int, ...]) -> Potentials:
        """Scalings of one everywhere."""
        size = int(np.prod(shape))
        return cls(Region.whole(shape), np.zeros((count, size)), np.zeros(size))

    @property
    def columns(self) -> NDArray[np.float64]:
        """The physical potentials over gamma at this level, ln v, and ln d, (k + 1, len(region))."""
        return np.concatenate([self.log_v, self.log_debias[None]])

    def prolonged(self, domain: Multiscale, region: Region) -> Potentials:
        """Interpolate the state from the next coarser domain to `domain`.

        The physical potential is gamma ln v, so ln v grows as gamma falls; ln d stays.
        """
        finer = domain.prolong(self.region.scatter(self.columns, 0.0), region)
        return Potentials(region, np.maximum(domain.fall_of_gamma * finer[:-1], LOG_NOTHING), finer[-1])

    def corrected(
        self, domain: Multiscale, region: Region, coarse: Potentials, coarse_before: Potentials
    ) -> Potentials:
        """Return the state, changed by the same amount as the coarser domain's state.

        Large-scale changes come from the coarser domain and fine detail is kept: a neighbor's fine state alone would be
        wrong at the scale that fine iterations correct most slowly. Elements missing from the neighbor are prolonged
        from the coarser domain.
        """
        before = coarse_before.region.transferred(coarse_before.columns, coarse.region, LOG_NOTHING)
        known = (coarse.columns > LOG_NOTHING / 2) & (before > LOG_NOTHING / 2)
        # float32 is accurate enough for a start, and half the work.
        moved = np.where(known, coarse.columns - before, 0.0).astype(np.float32)
        steps = domain.prolong(coarse.region.scatter(moved, 0.0), region)
        columns = self.region.transferred(self.columns, region, LOG_NOTHING)
        missing = (columns <= LOG_NOTHING / 2).any(axis=0)
        columns[:-1] += domain.fall_of_gamma * steps[:-1]
        columns[-1] += steps[-1]
        if missing.any():
            rest = Region(region.scatter(missing, False))
            columns[:, missing] = coarse.prolonged(domain, rest).columns
        return Potentials(region, np.maximum(columns[:-1], LOG_NOTHING), columns[-1])

    def for_weights(self, alphas: NDArray[np.float64], sharpness: float) -> Potentials:
        """Return the state, shifted so that sum_i alphas_i ln v_i = s ln d holds.

        Without this, a solve that starts from the potentials of other weights converges to their barycenter.
        """
        offset = np.tensordot(alphas, self.log_v, 1) - sharpness * self.log_debias
        return Potentials(self.region, np.maximum(self.log_v - offset, LOG_NOTHING), self.log_debias)

    def on(self, region: Region) -> Potentials:
        """Return the state on another region; new elements are empty until the first round."""
        return Potentials(
            region,
            self.region.transferred(self.log_v, region, LOG_NOTHING),
            self.region.transferred(self.log_debias, region, float(self.log_debias.min())),
        )
