# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Every formula is compared with the integral or maximum that defines it."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad, trapezoid
from scipy.optimize import minimize_scalar
from scipy.special import gammaln, ive, j0, logsumexp

from convwass_addon.transport import matern

GAMMA = 0.01
STEPS = [1, 2, 3, 5, 10, 20, 59, 60, 61, 100, 1000]


def step_of(steps, gamma=GAMMA):
    """Time of one Euler step."""
    return gamma / (4 * steps)


def averaged_heat(distance, gamma, steps):
    """Logarithm of the plane's heat kernel averaged over gamma-distributed times, by the trapezoid rule.

    As a function of the logarithm of time, the integrand is smooth and vanishes at both ends, so the rule is exact.
    """
    step = step_of(steps, gamma)
    log_time = np.log(step) + np.linspace(-25.0, 12.0, 40001)
    time = np.exp(log_time)
    density = steps * log_time - time / step - gammaln(steps) - steps * np.log(step)
    heat = -np.log(4 * np.pi * time) - distance[:, None] ** 2 / (4 * time)
    return logsumexp(density + heat, axis=1) + np.log(log_time[1] - log_time[0])


def hankel(distance, gamma, steps):
    """Inverse Fourier transform of (1 + tau k^2)^-m in the plane, for at least three steps; by the same rule."""
    length = np.sqrt(step_of(steps, gamma))
    log_wave = np.linspace(-20.0, 6.0, 40001)
    wave = np.exp(log_wave)
    values = wave**2 * (1 + wave**2) ** -float(steps) * j0(wave * distance[:, None] / length)
    return trapezoid(values, log_wave, axis=1) / (2 * np.pi * length**2)


@pytest.mark.parametrize("steps", [3, 5, 10, 20, 100])
def test_the_kernel_has_the_spectrum_of_euler_steps(steps):
    """To 1e-9 of the peak, the size of the spectrum of three steps beyond the shortest wave; the expansion to 1e-5."""
    distance = np.linspace(0.01, 4, 12) * np.sqrt(GAMMA)
    expected = hankel(distance, GAMMA, steps)
    found = np.exp(matern.log_kernel(distance, GAMMA, steps))
    accuracy = 1e-9 if steps < 61 else 1e-5
    np.testing.assert_allclose(found, expected, atol=accuracy * steps / ((steps - 1) * np.pi * GAMMA))


@pytest.mark.parametrize("steps", STEPS)
def test_the_kernel_is_heat_averaged_over_gamma_distributed_times(steps):
    """To 1e-10 in the logarithm, from nearby to e^-1000; the expansion for large orders to 1e-5 (measured 9e-6)."""
    reach = np.geomspace(1e-3, 30.0 if steps > 100 else 20.0 * max(1, 10 / steps), 40)
    distance = reach * np.sqrt(GAMMA)
    found = matern.log_kernel(distance, GAMMA, steps)
    np.testing.assert_allclose(found, averaged_heat(distance, GAMMA, steps), atol=1e-10 if steps < 61 else 1e-5)


def test_the_branch_for_large_orders_continues_the_other():
    """Third differences in the number of steps do not grow at the transition."""
    distance = np.geomspace(1e-2, 30, 20) * np.sqrt(GAMMA)
    logs = np.array([matern.log_kernel(distance, GAMMA, steps) for steps in range(50, 72)])
    thirds = np.abs(np.diff(logs, 3, axis=0)).max(axis=1)
    assert thirds[6:].max() < 2 * thirds[:6].max() + 1e-5


@pytest.mark.parametrize("steps", STEPS)
@pytest.mark.parametrize("gamma", [1e-4, 0.01, 3.0])
def test_the_kernel_of_the_plane_has_mass_one(gamma, steps):
    log_distance = np.linspace(np.log(1e-4), np.log(60.0), 4001)
    distance = np.exp(log_distance) * np.sqrt(gamma)
    density = 2 * np.pi * distance**2 * np.exp(matern.log_kernel(distance, gamma, steps))
    # A single step has 1e-7 of its heat within the first 1e-4, more steps have less.
    assert trapezoid(density, log_distance) == pytest.approx(1, abs=5e-7 if steps < 61 else 1e-5)


def at_source(gamma, steps):
    return np.log(steps / (steps - 1) / (np.pi * gamma)) if steps > 1 else 0.0


@pytest.mark.parametrize("steps", STEPS)
@pytest.mark.parametrize("gamma", [1e-4, 0.01, 3.0])
def test_kernel_distance_inverts_the_kernel(gamma, steps):
    """To 1e-4, from a hundredth of the blur up to the limit of logarithms in float64."""
    distance = np.geomspace(0.01, 300, 200) * np.sqrt(gamma)
    logs = matern.log_kernel(distance, gamma, steps)
    keep = logs > -1400
    assert keep.sum() > 100
    found = matern.kernel_distance(logs[keep], np.full(keep.sum(), at_source(gamma, steps)), gamma, steps)
    np.testing.assert_allclose(found, distance[keep], rtol=1e-4)


@pytest.mark.parametrize("steps", [2, 10, 1000])
def test_kernel_distance_depends_only_on_the_ratio_to_the_source(steps):
    logs = matern.log_kernel(np.array([0.01, 0.1, 0.4]), GAMMA, steps)
    moved = [matern.kernel_distance(logs + c, np.full(3, at_source(GAMMA, steps) + c), GAMMA, steps) for c in (0, 700)]
    np.testing.assert_allclose(moved[1], moved[0], rtol=1e-9)


@pytest.mark.parametrize("steps", [1, 2, 10, 1000])
def test_kernel_distance_without_decay(steps):
    """At the source, and where rounding makes a neighbor's value larger: a thousandth of the blur."""
    source = np.full(2, at_source(GAMMA, steps))
    risen = source + (np.array([0.0, 1e-3]) if steps > 1 else 50.0)
    found = matern.kernel_distance(risen, source, GAMMA, steps)
    assert (found >= 0).all()
    assert found.max() < 1e-3 * np.sqrt(GAMMA)


def test_many_steps_approach_the_gaussian():
    """-gamma ln of the kernel is d^2, with an error of d^4 / (gamma m) by the formula's second term."""
    distance = np.linspace(0.05, 2, 20) * np.sqrt(GAMMA)
    errors = [
        np.abs(-GAMMA * (matern.log_kernel(distance, GAMMA, steps) + np.log(np.pi * GAMMA)) - distance**2).max()
        for steps in (100, 1000, 10000)
    ]
    assert errors[2] < 1e-3 * distance[-1] ** 2
    np.testing.assert_allclose(np.divide(errors[:-1], errors[1:]), 10, rtol=0.1)


def log_moments(slope, gamma, steps):
    """ln of the mean of exp(slope z_x) under the plane's kernel, by integration over rings."""
    tau = step_of(steps, gamma)
    length = np.sqrt(tau)

    def ring(r):
        log_k = matern.log_kernel(np.array([r]), gamma, steps)[0]
        return 2 * np.pi * r * np.exp(log_k + slope * r) * ive(0, slope * r)

    ends = length * np.array([1e-9, 0.1, 1, 5, 20, 100, 800]) * np.sqrt(steps)
    return np.log(sum(quad(ring, *pair, epsabs=0, epsrel=1e-10)[0] for pair in pairwise(ends)))


@pytest.mark.parametrize("steps", [1, 2, 10, 40])
@pytest.mark.parametrize("share", [0.1, 0.5, 0.9])
def test_the_moments_behind_the_cost(steps, share):
    """M(lambda) = (1 - tau lambda^2)^-m, the basis of the rate function, compared with the kernel itself."""
    tau = step_of(steps)
    slope = share / np.sqrt(tau)
    assert log_moments(slope, GAMMA, steps) == pytest.approx(-steps * np.log1p(-tau * slope**2), abs=1e-7)


def rate(distance, gamma, steps):
    """Cramér's rate function, gamma sup (lambda D - ln M), by numerical maximization."""
    tau = step_of(steps, gamma)
    found = minimize_scalar(
        lambda u: -(u / np.sqrt(tau) * distance + steps * np.log1p(-(u**2))),
        bounds=(0, 1 - 1e-15),
        method="bounded",
        options={"xatol": 1e-12},
    )
    return -gamma * found.fun


@pytest.mark.parametrize("steps", [1, 2, 3, 10, 50, 1000])
@pytest.mark.parametrize("gamma", [1e-4, 0.01, 3.0])
def test_squared_distance_inverts_cramers_rate_function(gamma, steps):
    """To 1e-5, the accuracy of the table's interpolation, from a tenth of the blur to a thousand times it."""
    distance = np.geomspace(0.1, 1000, 30) * np.sqrt(gamma)
    cost = np.array([rate(d, gamma, steps) for d in distance])
    np.testing.assert_allclose(matern.squared_distance(cost, gamma, steps), distance**2, rtol=1e-5)


@pytest.mark.parametrize("steps", [1, 10, 1000])
def test_squared_distance_nearby_is_the_divergence(steps):
    small = GAMMA * steps * np.array([0.0, 1e-14, 1e-13, 3e-12, 1e-9, 1e-7])
    np.testing.assert_allclose(matern.squared_distance(small, GAMMA, steps), small, rtol=1e-6, atol=0)
    assert matern.squared_distance(np.array(-1e-9), GAMMA, steps) == 0


def test_squared_distance_of_many_steps_is_the_divergence():
    """The error decreases with the inverse number of steps."""
    cost = np.linspace(0.1, 10, 20) * GAMMA
    errors = [np.abs(matern.squared_distance(cost, GAMMA, steps) / cost - 1).max() for steps in (10**3, 10**4, 10**5)]
    assert errors[-1] < 1e-4
    np.testing.assert_allclose(np.divide(errors[:-1], errors[1:]), 10, rtol=0.1)


@pytest.mark.parametrize("steps", [1, 10])
def test_far_away_the_cost_is_linear(steps):
    """gamma / sqrt(tau) per length, from the tail of the kernel."""
    distance = np.array([200.0, 201.0]) * np.sqrt(GAMMA)
    cost = [rate(d, GAMMA, steps) for d in distance]
    per_length = (cost[1] - cost[0]) / (distance[1] - distance[0])
    assert per_length == pytest.approx(GAMMA / np.sqrt(step_of(steps)), rel=0.03)
    np.testing.assert_allclose(matern.cost_slope(distance, GAMMA, steps), per_length, rtol=0.01)


@pytest.mark.parametrize("steps", [1, 2, 10, 1000])
@pytest.mark.parametrize("gamma", [1e-4, 0.01, 3.0])
def test_cost_slope_is_the_derivative(gamma, steps):
    """Compared with central differences of the rate function."""
    distance = np.geomspace(0.05, 100, 25) * np.sqrt(gamma)
    nudge = 1e-4 * distance
    difference = [rate(d + h, gamma, steps) - rate(d - h, gamma, steps) for d, h in zip(distance, nudge, strict=True)]
    np.testing.assert_allclose(matern.cost_slope(distance, gamma, steps), difference / (2 * nudge), rtol=1e-5)


def test_cost_slope_nearby_is_that_of_the_squared_distance():
    distance = np.array([0.0, 1e-9, 1e-6]) * np.sqrt(GAMMA)
    np.testing.assert_allclose(matern.cost_slope(distance, GAMMA, 10), 2 * distance, rtol=1e-9, atol=0)
