# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The kernel of implicit Euler steps of the heat equation in the plane, and distances recovered from it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.special import gammaln, kve

# The table covers the range of float64 logarithms and is fine enough to interpolate to 1e-5
# (tests/transport/test_matern.py).
_REACH = 1500.0
_ENTRIES = 20000
_LARGE_ORDER = 60


def log_kernel(distance: NDArray[np.float64], gamma: float, steps: int) -> NDArray[np.float64]:
    """Logarithm of the kernel at positive distances.

    One step of time tau is the filter 1 / (1 + tau k^2); `steps` of them make the Matérn kernel

        (1 / (2 pi tau)) z^(m - 1) K_(m - 1)(z) / (2^(m - 1) (m - 1)!),    z = d / sqrt(tau),  m tau = gamma / 4,

    which is the heat kernel averaged over gamma-distributed times. Its logarithm is quadratic near zero and linear far
    away.

    Parameters
    ----------
    distance : ndarray
        Positive distances.
    gamma : float
        gamma of the kernel: its time is gamma / 4.
    steps : int
        m above.
    """
    step = gamma / (4.0 * steps)
    z = distance / np.sqrt(step)
    constant = np.log(2.0 * np.pi * step) + (steps - 1) * np.log(2.0) + gammaln(steps)
    return (steps - 1) * np.log(z) + _log_bessel(steps - 1, z) - constant


def _log_bessel(order: int, z: NDArray[np.float64]) -> NDArray[np.float64]:
    """Logarithm of the modified Bessel function of the second kind."""
    if order < _LARGE_ORDER:
        return np.log(kve(order, z)) - z
    # kve overflows near zero; the uniform expansion for large orders (DLMF 10.41.4) is accurate to 1 / order^2.
    x = z / order
    root = np.sqrt(1.0 + x**2)
    eta = root + np.log(x / (1.0 + root))
    first = (3.0 / root - 5.0 / root**3) / 24.0
    return 0.5 * np.log(np.pi / (2.0 * order)) - order * eta - 0.5 * np.log(root) + np.log1p(-first / order)


def kernel_distance(
    log_values: NDArray[np.float64], log_at_source: NDArray[np.float64], gamma: float, steps: int
) -> NDArray[np.float64]:
    """Distances at which the kernel in the plane has these values, relative to its value at the source.

    Parameters
    ----------
    log_values, log_at_source : ndarray
        ln H(x, y) and ln H(x, x).
    gamma, steps
        As in :func:`log_kernel`. With one step the kernel is infinite at its source; then absolute values are compared.
    """
    length = np.sqrt(gamma / (4.0 * steps))
    z = np.geomspace(1e-3 * np.sqrt(steps), _REACH * np.sqrt(steps), _ENTRIES)
    table = log_kernel(z * length, gamma, steps)
    fall = log_values
    if steps > 1:
        table = table + np.log(np.pi * gamma) + np.log((steps - 1) / steps)
        fall = log_values - log_at_source
    return length * np.interp(-fall, -table, z)


def squared_distance(divergence: NDArray[np.float64], gamma: float, steps: int) -> NDArray[np.float64]:
    """Squared distance of a translation from the debiased cost of its transport with this kernel, `divergence`.

    Consider a distribution that is wide compared with sqrt(gamma) and its translate by D in the plane. The plan has
    displacements of density k(z) exp(lambda z) with mean D, where k is the kernel, and its cost is Cramér's rate
    function

        I(D) = gamma sup_lambda (lambda D - ln M(lambda)),    M(lambda) = (1 - tau lambda^2)^(-m),  m tau = gamma / 4.

    With u = tau lambda^2 the cost is gamma m (2 u / (1 - u) + ln(1 - u)) at D^2 = 4 m^2 tau u / (1 - u)^2, which is
    D^2 for short distances and linear in D for long ones. This is its inverse; negative divergences, which come from
    rounding, give zero.
    """
    tau = gamma / (4.0 * steps)
    near = np.geomspace(1e-12, 0.5, _ENTRIES // 2)
    u = np.concatenate([[0.0], near[:-1], 1.0 - np.geomspace(0.5, 1e-9, _ENTRIES // 2)])
    cost = gamma * steps * (2.0 * u / (1.0 - u) + np.log1p(-u))
    # For tiny u the difference cancels; use its first term.
    cost = np.where(u < 1e-6, gamma * steps * u, cost)
    return np.interp(divergence, cost, 4.0 * steps**2 * tau * u / (1.0 - u) ** 2)


def cost_slope(distance: NDArray[np.float64], gamma: float, steps: int) -> NDArray[np.float64]:
    """Return the derivative of the cost of :func:`squared_distance` by the distance.

    This is gamma lambda, with the lambda of that function; 2 D for short distances.
    """
    tau = gamma / (4.0 * steps)
    # lambda of the mean displacement D solves D tau lambda^2 + 2 m tau lambda = D.
    reach = steps * tau
    return gamma * distance / (reach + np.sqrt(reach**2 + distance**2 * tau))
