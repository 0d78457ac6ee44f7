# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Unbalanced transport: closed forms, a dense solver, and the balanced limit."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from convwass_addon.transport import Grid, barycenter
from tests.transport.dense import kernel, log_product


def bump(size, center, deviation):
    return np.exp(-((np.arange(size) + 0.5 - center) ** 2) / (2 * deviation**2))


def dense_unbalanced(mus, alphas, grid, reach, sharpness, rounds):
    """The iteration of Chizat et al. with the debiasing density and a dense kernel; density of mass 1, total mass."""
    log_h = np.log(kernel(grid)) - np.log(grid.cells)
    gamma = 2 * grid.sigma**2
    e, k = reach**2 / (reach**2 + gamma), gamma / (reach**2 + gamma)

    def blurred(logs):
        return log_product(log_h, logs)

    log_mus = [np.log(mu.ravel() / mu.mean()) for mu in mus]
    log_v, log_d, log_mu = [np.zeros(grid.cells) for _ in mus], np.zeros(grid.cells), np.zeros(grid.cells)
    for _ in range(rounds):
        before = log_mu
        log_kw = [blurred(e * (log_mu - blurred(v))) for log_mu, v in zip(log_mus, log_v, strict=True)]
        terms = [np.log(alpha) + k * logs for alpha, logs in zip(alphas, log_kw, strict=True)]
        log_mu = np.logaddexp.reduce(terms, axis=0) / k + sharpness / e * log_d
        log_v = [e * (log_mu - logs) for logs in log_kw]
        log_d = 0.5 * (log_d + e * (log_mu - blurred(log_d)))
        if np.abs(log_mu - before).max() < 1e-14:
            break
    density = np.exp(log_mu)
    return (density / density.mean()).reshape(grid.shape), density.mean()


@pytest.mark.parametrize("reach", [3.0, 5.0, 8.0])
@pytest.mark.parametrize("weight", [0.2, 0.5, 0.9])
def test_bumps_out_of_reach_fade(reach, weight):
    """For each bump in place, mu = alpha^(1 + e) times a common factor, and nothing moves.

    For gamma to 0 this is alpha^2, the interpolation of the Hellinger distance.
    """
    grid = Grid((128,), 1.5)
    found = barycenter(
        [bump(128, 30, 3), bump(128, 98, 3)],
        [weight, 1 - weight],
        grid,
        reach=reach,
        tolerance=1e-8,
        max_iterations=500,
    )
    assert found.converged
    mass = found.density / 128
    exponent = 1 + reach**2 / (reach**2 + 2 * 1.5**2)
    assert mass[:64].sum() / mass[64:].sum() == pytest.approx((weight / (1 - weight)) ** exponent, rel=1e-6)
    cells = np.arange(128) + 0.5
    assert (mass[:64] @ cells[:64]) / mass[:64].sum() == pytest.approx(30, abs=1e-4)
    assert found.mass < 1


@pytest.mark.parametrize("sharpness", [0.0, 0.75])
@pytest.mark.parametrize("reach", [2.0, 10.0])
def test_agrees_with_a_dense_solver(reach, sharpness):
    rng = np.random.default_rng(3)
    grid = Grid((9, 8), 1.2)
    mus = 0.1 + rng.random((3, 9, 8))
    expected, mass = dense_unbalanced(mus, [0.2, 0.5, 0.3], grid, reach, sharpness, 3000)
    found = barycenter(
        mus, [0.2, 0.5, 0.3], grid, sharpness=sharpness, reach=reach, tolerance=1e-12, max_iterations=5000
    )
    np.testing.assert_allclose(found.density, expected, rtol=1e-7)
    assert found.mass == pytest.approx(mass, rel=1e-7)


def test_a_long_reach_is_the_balanced_barycenter():
    grid = Grid((24, 20), 1.3)
    rng = np.random.default_rng(4)
    mus = rng.random((2, 24, 20)) ** 4
    options = {"sharpness": 0.75, "tolerance": 1e-8, "max_iterations": 2000}
    balanced = barycenter(mus, [0.4, 0.6], grid, **options)
    found = barycenter(mus, [0.4, 0.6], grid, reach=1e5, **options)
    assert found.converged
    assert found.mass == pytest.approx(1.0, abs=1e-5)
    np.testing.assert_allclose(found.density, balanced.density, rtol=1e-4)


@pytest.mark.parametrize("reach", [2.0, 20.0])
def test_equal_shapes_are_returned_unchanged(reach):
    grid = Grid((96,), 1.5)
    mu = bump(96, 30, 5) + 0.5 * bump(96, 62, 7)
    found = barycenter([mu, mu], [0.3, 0.7], grid, sharpness=1.0, reach=reach, tolerance=1e-4, max_iterations=5000)
    assert np.abs(found.density - mu / mu.mean()).mean() < 5e-3
    assert found.mass == pytest.approx(1.0, abs=1e-3)


@settings(max_examples=12, deadline=None)
@given(
    seed=st.integers(0, 2**31 - 1),
    reach=st.floats(0.5, 1000.0),
    sharpness=st.sampled_from([0.0, 0.5, 0.75]),
    count=st.integers(1, 4),
)
def test_it_converges_for_every_reach(seed, reach, sharpness, count):
    rng = np.random.default_rng(seed)
    grid = Grid((32, 16), 1.5)
    mus = rng.random((count, 32, 16)) ** 3
    weights = rng.random(count) + 0.05
    found = barycenter(mus, weights, grid, reach=reach, sharpness=sharpness, tolerance=1e-3, max_iterations=500)
    assert found.converged
    assert np.isfinite(found.density).all()
    assert found.density.mean() == pytest.approx(1.0)
    assert 0 < found.mass < 1 + 1e-3
    assert found.invariant_error < 1e-8


def test_invalid_arguments_are_refused():
    mus = np.ones((2, 16))
    with pytest.raises(ValueError, match="reach must be a positive length"):
        barycenter(mus, [1, 1], Grid((16,), 1.5), reach=0.0)
    with pytest.raises(ValueError, match="entropy_limit"):
        barycenter(mus, [1, 1], Grid((16,), 1.5), reach=2.0, entropy_limit="max")
