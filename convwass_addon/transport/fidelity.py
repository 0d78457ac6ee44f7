# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Marginal constraints of plans: exact, or relaxed at a cost so that mass may vanish and appear."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .log_range import LOG_NOTHING


@dataclass(frozen=True)
class Balanced:
    """All mass travels: the marginals of the plans equal the distributions."""

    exponent = 1.0

    def log_mean(self, log_values: NDArray[np.float64], alphas: NDArray[np.float64], out: NDArray[np.float64]) -> None:
        """Write the logarithm of the geometric mean of the rows, (k, n), to `out`, (n,)."""
        np.multiply(log_values[0], alphas[0], out=out)
        for log_value, alpha in zip(log_values[1:], alphas[1:], strict=True):
            out += alpha * log_value

    def mean_of_scalings(self, log_v: NDArray[np.float64], alphas: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the mean of ln v_i, (n,), which equals s ln d in every round."""
        return np.tensordot(alphas, log_v, 1)


@dataclass(frozen=True)
class Unbalanced:
    """Mass may vanish and appear: a plan pays reach^2 KL(marginal | distribution) on both sides.

    In the scaling iterations (Chizat, Peyre, Schmitzer and Vialard 2018, "Scaling algorithms for unbalanced optimal
    transport problems", section 5.2) every update gets one exponent, and the geometric mean becomes a power mean:

        w_i = (mu_i / H(a v_i))^e,    mu = (sum_i alpha_i H(a w_i)^k)^(1 / k),    v_i = (mu / H(a w_i))^e

    with e = reach^2 / (reach^2 + gamma) and k = gamma / (reach^2 + gamma). Mass travels about as far as `reach`; beyond
    that it fades instead. The debiasing density enters mu as d^(s / e), so that for s = 1 the barycenter of a single
    distribution is the distribution itself.

    Attributes
    ----------
    reach : float
        In lengths of the domain rescaled to unit volume.
    gamma : float
        gamma of the domain.
    """

    reach: float
    gamma: float

    @property
    def exponent(self) -> float:
        """The exponent e above."""
        return self.reach**2 / (self.reach**2 + self.gamma)

    @property
    def power(self) -> float:
        """The exponent k of the power mean above."""
        return self.gamma / (self.reach**2 + self.gamma)

    def log_mean(self, log_values: NDArray[np.float64], alphas: NDArray[np.float64], out: NDArray[np.float64]) -> None:
        """Write the logarithm of the power mean of the rows, (k, n), to `out`, (n,).

        For small powers this is the largest row plus a small difference of nearly equal numbers; expm1 and log1p keep
        its digits.
        """
        largest = log_values.max(axis=0)
        out.fill(0.0)
        for log_value, alpha in zip(log_values, alphas, strict=True):
            share = np.expm1(self.power * (log_value - largest))
            # No mass of this input arrives here, so its value is zero for any power.
            np.copyto(share, -1.0, where=log_value <= LOG_NOTHING / 2)
            out += alpha * share
        # No mass of any input arrives here.
        np.maximum(out, -1.0 + np.finfo(float).eps, out=out)
        np.log1p(out, out=out)
        out /= self.power
        out += largest

    def mean_of_scalings(self, log_v: NDArray[np.float64], alphas: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the power mean of ln v_i, (n,), which equals s ln d in every round: v_i^(-k / e) is averaged."""
        mean = np.empty(log_v.shape[1])
        self.log_mean(log_v / -self.exponent, alphas, mean)
        return -self.exponent * mean


def fidelity(reach: float | None, gamma: float) -> Balanced | Unbalanced:
    """Return the rule for a reach, or the balanced one for None."""
    return Balanced() if reach is None else Unbalanced(reach, gamma)
