# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from convwass_addon.errors import Cancelled
from convwass_addon.transport import Grid, KernelTooNarrowError, barycenter
from convwass_addon.transport.bregman import BregmanIteration
from convwass_addon.transport.sharpening import entropy
from tests.controls import CountingControl
from tests.transport.dense import log_product


def blob(shape, center, deviation):
    """Gaussian bump on a grid, mass 1 under equal area weights."""
    axes = [np.arange(n) + 0.5 for n in shape]
    grids = np.meshgrid(*axes, indexing="ij")
    logs = -sum(
        (g - c) ** 2 / (2 * d**2) for g, c, d in zip(grids, center, np.broadcast_to(deviation, len(shape)), strict=True)
    )
    density = np.exp(logs)
    return density / density.mean()


def moments(density):
    """Mean and standard deviation per axis."""
    mass = density / density.sum()
    axes = [np.arange(n) + 0.5 for n in density.shape]
    means, deviations = [], []
    for axis, cells in enumerate(axes):
        line = mass.sum(axis=tuple(a for a in range(density.ndim) if a != axis))
        means.append((line * cells).sum())
        deviations.append(np.sqrt((line * (cells - means[-1]) ** 2).sum()))
    return np.array(means), np.array(deviations)


def dense_log_barycenter(mus, weights, grid, sharpness, iterations):
    """Algorithm 2 with sharpness, with the kernel as a matrix and all sums by log-sum-exp."""
    cells = np.stack(np.meshgrid(*[np.arange(n) for n in grid.shape], indexing="ij"), -1).reshape(-1, len(grid.shape))
    squared = ((cells[:, None] - cells) ** 2).sum(-1)
    log_kernel = -squared / (2 * grid.sigma**2) - len(grid.shape) * np.log(np.sqrt(2 * np.pi) * grid.sigma)

    def log_apply(logs):
        return log_product(log_kernel, logs)

    with np.errstate(divide="ignore"):
        log_mus = [np.log(mu.ravel()) for mu in mus]
    log_v = [np.zeros(len(cells)) for _ in mus]
    log_d, log_density = np.zeros(len(cells)), np.zeros(len(cells))
    for _ in range(iterations):
        before = log_density
        log_kw = [log_apply(log_mu - log_apply(v)) for log_mu, v in zip(log_mus, log_v, strict=True)]
        log_density = sharpness * log_d + sum(w * k for w, k in zip(weights, log_kw, strict=True))
        log_v = [log_density - k for k in log_kw]
        log_d = 0.5 * (log_d + log_density - log_apply(log_d))
        if np.abs(log_density - before).max() < 1e-14:
            break
    density = np.exp(log_density).reshape(grid.shape)
    return density / density.mean()


@pytest.mark.parametrize("shape", [(64,), (40, 48), (36, 32, 40)])
@pytest.mark.parametrize("t", [0.25, 0.5, 0.8])
def test_debiased_gaussians_match_the_closed_form(shape, t):
    """The barycenter of axis-parallel Gaussians has the weighted means of their centers and deviations."""
    grid = Grid(shape, 1.5)
    low, high = np.array(shape) * 0.4, np.array(shape) * 0.6
    first, second = blob(shape, low, 2.0), blob(shape, high, 3.0)
    found = barycenter([first, second], [1 - t, t], grid, sharpness=1.0, tolerance=1e-4, max_iterations=3000)
    means, deviations = moments(found.density)
    np.testing.assert_allclose(means, (1 - t) * low + t * high, atol=0.02)
    np.testing.assert_allclose(deviations, (1 - t) * 2.0 + t * 3.0, rtol=0.04)


def test_a_wide_kernel_is_mostly_solved_on_the_coarser_grid():
    """After a coarser grid with a wider kernel, 8 rounds remain."""
    grid = Grid((64, 64), 2.5)
    mus = [blob((64, 64), [20, 24], 3.0), blob((64, 64), [44, 36], 5.0) + blob((64, 64), [24, 50], 2.5)]
    found = barycenter(mus, [0.4, 0.6], grid)
    assert found.converged
    assert found.iterations[-1] <= 4


def test_full_sharpness_converges_fast_with_momentum():
    """Without momentum, this takes 39, 52, 78 and 21 rounds."""
    grid = Grid((64, 64), 1.25)
    one, other = np.zeros((64, 64)), np.zeros((64, 64))
    one[10:30, 12:24], other[36:56, 30:58] = 1.0, 1.0
    found = barycenter([one, other], [0.5, 0.5], grid, sharpness=1.0, tolerance=3e-3, max_iterations=500)
    assert found.converged
    assert sum(found.iterations) < 120


def test_converged_densities_have_no_outliers_at_their_rim():
    """The last step of d, whose error is never measured, once put 1 % of the mass into a cell that should be empty."""
    grid = Grid((48, 48), 1.0)
    mus = [blob(grid.shape, [14.4, 14.4], 2.4), blob(grid.shape, [33.6, 28.8], 3.84)]
    exact = barycenter(mus, [0.25, 0.75], grid, sharpness=1.0, tolerance=1e-8, max_iterations=5000)
    for tolerance in (1e-4, 3e-5, 1e-5):
        found = barycenter(mus, [0.25, 0.75], grid, sharpness=1.0, tolerance=tolerance, max_iterations=1000)
        assert found.converged
        assert np.abs(found.density - exact.density).mean() < 5e-4


@pytest.mark.parametrize(("sharpness", "within"), [(0.0, 1e-4), (0.5, 1e-2), (0.75, 1e-2), (1.0, 1e-2)])
def test_sharpness_removes_its_fraction_of_the_blur(sharpness, within):
    """Two equal Gaussians of variance d^2 have a barycenter of variance d^2 + (1 - s) sigma^2."""
    grid = Grid((96,), 1.5)
    mu = blob((96,), [48], 8.0)
    found = barycenter([mu, mu], [0.5, 0.5], grid, sharpness=sharpness, tolerance=1e-5, max_iterations=3000)
    assert moments(found.density)[1][0] ** 2 == pytest.approx(64.0 + (1 - sharpness) * 1.5**2, abs=within)


@pytest.mark.parametrize("sharpness", [0.0, 0.75, 1.0])
def test_agrees_with_a_dense_log_domain_solve(sharpness):
    rng = np.random.default_rng(5)
    grid = Grid((9, 10), 1.2)
    mus = rng.random((3, 9, 10)) ** 3
    if sharpness == 1.0:
        # Full debiasing converges extremely slowly for detail finer than the kernel.
        mus = grid.apply(grid.apply(mus))
    mus /= mus.mean(axis=(1, 2), keepdims=True)
    weights = [0.2, 0.5, 0.3]
    # Over-relaxation takes the solve another way to the same limit; debiased, it gets there much earlier.
    rounds = 400 if sharpness == 1.0 else 1000
    expected = dense_log_barycenter(mus, weights, grid, sharpness, 4 * rounds if sharpness == 1.0 else rounds)
    found = barycenter(mus, weights, grid, sharpness=sharpness, tolerance=1e-12, max_iterations=rounds)
    if sharpness == 1.0:
        np.testing.assert_allclose(found.density, expected, rtol=5e-3)
        np.testing.assert_allclose(grid.apply(found.density), grid.apply(expected), rtol=1e-5)
    else:
        np.testing.assert_allclose(found.density, expected, atol=1e-9)


def test_by_line_numerics_take_over_with_the_same_result():
    """For distant blobs and a narrow kernel, scalings fail; the record says so, and the result stays accurate."""
    shape = (160, 16)
    first, second = np.zeros(shape), np.zeros(shape)
    first[6:10, 4:12], second[150:154, 4:12] = 1.0, 1.0
    far = barycenter([first, second], [0.5, 0.5], Grid(shape, 1.9), sharpness=0.75, max_iterations=800)
    assert far.numerics == "log domain by line"
    assert np.isfinite(far.density).all()
    assert far.converged
    assert moments(far.density)[0][0] == pytest.approx(80.0, abs=0.5)


@pytest.mark.parametrize("corner", [0, 1, 2])
def test_all_weight_on_one_input_returns_it(corner):
    grid = Grid((24, 24), 1.3)
    mus = np.stack([blob(grid.shape, c, 2.5) for c in ([8, 8], [16, 9], [12, 16])])
    weights = np.eye(3)[corner]
    found = barycenter(mus, weights, grid, sharpness=1.0, tolerance=1e-6, max_iterations=5000)
    assert np.abs(found.density - mus[corner]).mean() < 0.01
    np.testing.assert_array_equal(found.active, [corner])


@pytest.mark.parametrize("sharpness", [0.0, 0.75, 1.0])
def test_invariant_mass_and_marginals(sharpness):
    grid = Grid((32, 32), 1.4)
    mus = np.stack([blob(grid.shape, [10, 12], 2.0), blob(grid.shape, [22, 20], 3.0)])
    found = barycenter(mus, [0.3, 0.7], grid, sharpness=sharpness, tolerance=1e-3, max_iterations=2000)
    assert found.converged
    assert found.invariant_error < 1e-9
    assert found.mass_error < 5e-3
    assert found.density.mean() == pytest.approx(1.0)
    # The marginal error, computed independently from the scalings alone.
    v = np.exp(found.log_v)
    w = mus / grid.apply(v)
    plans = v * grid.apply(w)
    assert max(np.abs(plan - found.density).mean() for plan in plans) < 2e-3


def test_the_result_has_the_given_weights():
    """With a wrong invariant, the solver converges to the barycenter of other weights; the center of mass shows it."""
    grid = Grid((48,), 1.5)
    mus = np.stack([blob((48,), [14], 2.0), blob((48,), [34], 2.0)])
    before = None
    for t in (0.1, 0.3, 0.5, 0.7, 0.9):
        before = barycenter(mus, [1 - t, t], grid, sharpness=0.75, initial=before, tolerance=1e-3, max_iterations=2000)
        assert moments(before.density)[0][0] == pytest.approx(14 + 20 * t, abs=0.05)
        cold = barycenter(mus, [1 - t, t], grid, sharpness=0.75, tolerance=1e-3, max_iterations=2000)
        assert np.abs(before.density - cold.density).mean() < 0.03


def test_a_start_from_other_inputs_is_ignored():
    grid = Grid((16, 16), 1.2)
    mus = np.stack([blob(grid.shape, c, 2.0) for c in ([5, 5], [11, 5], [8, 11])])
    pair = barycenter(mus, [0.5, 0.5, 0.0], grid)
    three = barycenter(mus, [0.4, 0.3, 0.3], grid, initial=pair)
    cold = barycenter(mus, [0.4, 0.3, 0.3], grid)
    np.testing.assert_array_equal(three.density, cold.density)


def test_barycenters_are_translation_equivariant():
    grid = Grid((64, 48), 1.3)
    mus = np.stack([blob(grid.shape, [24, 20], 2.0), blob(grid.shape, [30, 23], 2.5)])
    moved = np.roll(mus, (8, 4), axis=(1, 2))
    one = barycenter(mus, [0.5, 0.5], grid, tolerance=1e-5, max_iterations=2000).density
    other = barycenter(moved, [0.5, 0.5], grid, tolerance=1e-5, max_iterations=2000).density
    np.testing.assert_allclose(np.roll(one, (8, 4), axis=(0, 1)), other, atol=1e-3)


def test_order_of_inputs_does_not_matter():
    grid = Grid((24, 20), 1.3)
    mus = np.stack([blob(grid.shape, c, 2.0) for c in ([8, 6], [14, 12], [9, 14])])
    weights = np.array([0.5, 0.3, 0.2])
    turned = [2, 0, 1]
    one = barycenter(mus, weights, grid, sharpness=0.75).density
    other = barycenter(mus[turned], weights[turned], grid, sharpness=0.75).density
    np.testing.assert_allclose(one, other, atol=1e-9)


def test_sharpness_is_monotonic():
    grid = Grid((64,), 2.0)
    mus = np.stack([blob((64,), [24], 3.0), blob((64,), [40], 4.0)])
    entropies = [
        barycenter(mus, [0.5, 0.5], grid, sharpness=s, tolerance=1e-4, max_iterations=3000).entropy
        for s in (0.0, 0.25, 0.5, 0.75, 1.0)
    ]
    assert (np.diff(entropies) < 0).all()


@pytest.mark.parametrize("tightening", [0, 3])
@pytest.mark.parametrize("sharpness", [0.0, 0.75])
def test_the_entropy_bound_holds(tightening, sharpness):
    grid = Grid((48, 48), 2.0)
    mus = np.zeros((2, 48, 48))
    mus[0, 8:20, 10:36], mus[1, 30:40, 12:30] = 1.0, 1.0
    limit = max(entropy(mu / mu.mean(), grid.weights) for mu in mus)
    free = barycenter(mus, [0.5, 0.5], grid, sharpness=sharpness)
    bounded = barycenter(mus, [0.5, 0.5], grid, sharpness=sharpness, entropy_limit="max", tightening=tightening)
    assert free.entropy > limit
    assert bounded.entropy == pytest.approx(limit, abs=1e-3)
    assert bounded.sharpening_exponent > 1.0
    assert bounded.converged
    # The bound sharpens without moving the mass.
    np.testing.assert_allclose(moments(bounded.density)[0], moments(free.density)[0], atol=0.7)


def test_a_loose_entropy_bound_changes_nothing():
    grid = Grid((32,), 1.5)
    mus = np.stack([blob((32,), [10], 2.0), blob((32,), [20], 3.0)])
    free = barycenter(mus, [0.5, 0.5], grid, sharpness=0.75, tolerance=1e-4, max_iterations=2000)
    loose = barycenter(mus, [0.5, 0.5], grid, sharpness=0.75, entropy_limit=1.0, tolerance=1e-4, max_iterations=2000)
    assert loose.sharpening_exponent == 1.0
    np.testing.assert_allclose(loose.density, free.density, atol=1e-2)


def test_a_solve_can_be_cancelled_at_any_iteration():
    control = CountingControl(last=3)
    mus = np.random.default_rng(0).random((2, 16, 16))
    with pytest.raises(Cancelled):
        barycenter(mus, [0.5, 0.5], Grid((16, 16), 1.0), tolerance=1e-12, control=control)
    assert control.count == 3


def test_an_exceeded_iteration_limit_is_reported():
    found = barycenter(
        np.random.default_rng(0).random((2, 17)), [0.5, 0.5], Grid((17,), 1.0), tolerance=1e-14, max_iterations=2
    )
    assert not found.converged
    assert found.iterations == (2,)
    assert found.record()["converged"] is False


GRID = Grid((8, 8), 1.0)
GOOD = np.ones((2, 8, 8))


@pytest.mark.parametrize(
    ("mus", "weights", "options", "named"),
    [
        (np.ones((2, 8, 7)), [1, 1], {}, "mus"),
        (np.ones((8, 8)), [1, 1], {}, "mus"),
        (-GOOD, [1, 1], {}, "mus"),
        (0 * GOOD, [1, 1], {}, "mus"),
        (np.nan * GOOD, [1, 1], {}, "mus"),
        (GOOD, [1, 1, 1], {}, "weights"),
        (GOOD, [1, -1], {}, "weights"),
        (GOOD, [0, 0], {}, "weights"),
        (GOOD, [np.nan, 1], {}, "weights"),
        (GOOD, [1, 1], {"sharpness": 1.5}, "sharpness"),
        (GOOD, [1, 1], {"tolerance": 0.0}, "tolerance"),
        (GOOD, [1, 1], {"max_iterations": 0}, "max_iterations"),
    ],
)
def test_bad_input_is_named(mus, weights, options, named):
    with pytest.raises(ValueError, match=named):
        barycenter(mus, weights, GRID, **options)


@settings(max_examples=15, deadline=None)
@given(
    shape=st.lists(st.integers(4, 20), min_size=1, max_size=3),
    sigma=st.floats(0.6, 5.0),
    count=st.integers(1, 4),
    sharpness=st.floats(0.0, 1.0),
    sparsity=st.floats(0.0, 0.95),
    seed=st.integers(0, 2**32 - 1),
)
def test_results_are_finite_and_errors_correct(shape, sigma, count, sharpness, sparsity, seed):
    rng = np.random.default_rng(seed)
    grid = Grid(shape, sigma)
    mus = rng.random((count, *shape)) * (rng.random((count, *shape)) >= sparsity)
    mus[:, *(0,) * len(shape)] += 0.1
    weights = rng.random(count) + 1e-3
    found = barycenter(mus, weights, grid, sharpness=sharpness, max_iterations=60)
    assert np.isfinite(found.density).all()
    assert found.density.mean() == pytest.approx(1.0)
    assert np.isfinite(found.marginal_error)
    assert found.converged == (judged(found) < 1e-2)


def judged(found):
    """The error that stops a solve; d contributes up to two halves, of which its last step removes one."""
    return max(found.marginal_error, found.debias_error * max(0.5, 2.0 * found.sharpness - 1.0))


@pytest.mark.parametrize("sharpness", [0.5, 0.75, 1.0])
def test_the_last_step_of_d_replaces_a_round(monkeypatch, sharpness):
    """It needs no product, and with the same number of rounds or fewer, the density is closer to the solution."""
    grid, mus = Grid((48, 48), 2.0), two_squares()
    solved = barycenter(mus, [0.4, 0.6], grid, sharpness=sharpness, tolerance=1e-4, max_iterations=3000)
    assert solved.converged
    misses, rounds = [], []
    for settle in (BregmanIteration.settle, lambda self: None):
        monkeypatch.setattr(BregmanIteration, "settle", settle)
        found = barycenter(mus, [0.4, 0.6], grid, sharpness=sharpness)
        misses.append(np.abs(found.density - solved.density).mean())
        rounds.append(found.iterations)
        assert found.mass_error < 1e-2
        assert found.invariant_error < 1e-9
    assert misses[0] < misses[1]
    assert all(with_it <= without for with_it, without in zip(*rounds, strict=True))


def two_squares():
    mus = np.zeros((2, 48, 48))
    mus[0, 8:20, 10:30], mus[1, 26:40, 20:32] = 1.0, 1.0
    return mus


def test_scaling_alone_raises_if_its_range_is_too_small():
    shape = (160, 16)
    mus = np.zeros((2, *shape))
    mus[0, 6:10, 4:12], mus[1, 150:154, 4:12] = 1.0, 1.0
    with pytest.raises(KernelTooNarrowError):
        barycenter(mus, [0.5, 0.5], Grid(shape, 1.0), sharpness=0.75, numerics="scaling")
