# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from convwass_addon.errors import Cancelled
from convwass_addon.transport import Grid, KernelTooNarrowError, distance, distance_matrix
from convwass_addon.transport.distance import distance_matrix_rounds, distance_rounds
from tests.controls import CountingControl
from tests.transport import dense
from tests.transport.gaussians import gaussian


def ragged(seed, count, shape, empty=0.3):
    """Uneven densities with holes."""
    rng = np.random.default_rng(seed)
    densities = rng.random((count, *shape)) ** 2 * (rng.random((count, *shape)) >= empty)
    densities.reshape(count, -1)[:, 0] += 0.1
    return densities


def plan_marginals(found, grid):
    """Both marginals of the plan D_v H D_w, using the grid's own kernel."""
    v, w = np.exp(found.log_v), np.exp(found.log_w)
    return v * grid.apply(w), w * grid.apply(v)


@pytest.mark.parametrize(("shape", "sigma"), [((24,), 1.5), ((7, 9), 1.1), ((12, 5), 0.8), ((4, 3, 6), 0.9)])
def test_entropic_value_is_that_of_eq_10(shape, sigma):
    """By the definition, from a dense plan. Agrees to 4e-12, because the marginal error enters the value squared."""
    first, second = ragged(1, 2, shape)
    grid = Grid(shape, sigma)
    expected = dense.sinkhorn_value(first, second, grid, dense.kernel(grid))
    found = distance(first, second, grid, debias=False, tolerance=1e-9, max_iterations=5000)
    assert found.value == found.entropic_value
    assert found.divergence is None
    assert found.value == pytest.approx(expected, abs=1e-9)
    assert distance(first, second, grid, tolerance=1e-5).entropic_value == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize(("shape", "sigma"), [((24,), 1.5), ((7, 9), 1.1), ((4, 3, 6), 0.9)])
def test_debiasing_subtracts_half_of_both_self_distances(shape, sigma):
    first, second = ragged(2, 2, shape)
    grid = Grid(shape, sigma)
    h = dense.kernel(grid)
    own = sum(dense.sinkhorn_value(mu, mu, grid, h) for mu in (first, second))
    expected = dense.sinkhorn_value(first, second, grid, h) - 0.5 * own
    assert distance(first, second, grid, tolerance=1e-8).value == pytest.approx(expected, abs=1e-8)


def linear_program(first, second, shape):
    """Exact W2^2 in squared cells, and the entropy -sum pi ln pi of the optimal plan."""
    with np.errstate(all="ignore"):
        ot = pytest.importorskip("ot")
    plan, log = ot.emd(
        first.ravel() / first.sum(), second.ravel() / second.sum(), dense.squared_distances(shape), log=True
    )
    return log["cost"], entropy_of(plan)


def entropy_of(mass):
    held = mass[mass > 0]
    return -float((held * np.log(held)).sum())


@pytest.mark.parametrize("shape", [(12,), (6, 5), (8, 3), (4, 3, 5)])
@pytest.mark.parametrize("seed", [6, 7])
def test_narrow_kernels_approach_linear_programming(shape, seed):
    """The debiased value differs from the exact one by gamma times entropies plus terms that decrease exponentially.

    At sigma = 0.2 cells, the error is up to 9 % for distances of about one cell; extrapolating two values to gamma = 0
    reduces it to 3e-6 (measured).
    """
    first, second = ragged(seed, 2, shape)
    exact, _ = linear_program(first, second, shape)
    wide, narrow = (distance(first, second, Grid(shape, s), tolerance=1e-5, max_iterations=5000) for s in (0.2, 0.17))
    assert wide.converged
    assert narrow.converged
    assert wide.value == pytest.approx(exact, rel=0.1)
    extrapolated = (0.2**2 * narrow.value - 0.17**2 * wide.value) / (0.2**2 - 0.17**2)
    assert extrapolated == pytest.approx(exact, rel=1e-5)


@pytest.mark.parametrize("seed", [5, 6, 7])
def test_on_a_line_the_first_order_in_gamma_is_known(seed):
    """gamma times half the sum of both entropies minus the entropy of the optimal plan. Measured: 1e-7."""
    first, second = ragged(seed, 2, (12,))
    exact, entropy = linear_program(first, second, (12,))
    sigma = 0.2
    ends = [entropy_of(mu / mu.sum()) for mu in (first, second)]
    found = distance(first, second, Grid((12,), sigma), tolerance=1e-8, max_iterations=20000)
    assert found.value == pytest.approx(exact + 2 * sigma**2 * (0.5 * sum(ends) - entropy), rel=1e-6)


@pytest.mark.parametrize("shape", [(17,), (9, 6), (32, 16), (5, 4, 6)])
def test_the_debiased_distance_to_itself_is_zero(shape):
    """The two ways to solve agree up to the square of the marginal error."""
    (mu,) = ragged(5, 1, shape)
    found = distance(mu, mu, Grid(shape, 1.2))
    assert abs(found.value) < 1e-8
    assert found.length < 1e-4
    assert abs(found.entropic_value) > 0.1


@pytest.mark.parametrize("tolerance", [1e-1, 1e-2])
def test_the_error_of_the_value_is_of_second_order(tolerance):
    """If a solve stops early, it is one or two times gamma times the square of the marginal error."""
    mu = np.zeros(64)
    mu[8:16] = np.random.default_rng(0).random(8)
    found = distance(mu, mu, Grid((64,), 2.0), tolerance=tolerance)
    assert found.marginal_error > 0.5 * tolerance
    assert abs(found.divergence) < 2.0 * 8.0 * found.marginal_error**2


def test_order_does_not_matter():
    first, second = ragged(6, 2, (11, 8))
    grid = Grid((11, 8), 1.0)
    one, other = (distance(*pair, grid, tolerance=1e-8) for pair in ((first, second), (second, first)))
    assert one.value == pytest.approx(other.value, rel=1e-9)
    assert one.value > 0.1


@pytest.mark.parametrize("sigma", [0.7, 1.5, 4.0])
def test_a_shift_is_measured_exactly_in_cells(sigma):
    """Transport to a translated copy costs the squared distance at any regularization: the plan is translated, too."""
    shape = (80, 60)
    mu = np.zeros(shape)
    mu[30:37, 25:31] = np.random.default_rng(7).random((7, 6))
    found = distance(mu, np.roll(mu, (6, -3), axis=(0, 1)), Grid(shape, sigma), tolerance=1e-8)
    assert found.value == pytest.approx(45.0, rel=1e-7)
    assert found.length == pytest.approx(np.sqrt(45.0), rel=1e-7)


def test_a_shift_adds_to_the_distance_of_centered_shapes():
    """W2^2(mu, nu translated by d) = W2^2(mu, nu) + 2 d (m1 - m0) + d^2, also debiased."""
    shape = (90, 40)
    first, second = np.zeros((2, *shape))
    first[20:30, 15:25], second[22:36, 12:20] = np.random.default_rng(8).random((10, 10)), 1.0
    mass = [m / m.sum() for m in (first, second)]
    (between,) = [(np.arange(90) * (mass[1] - mass[0]).sum(axis=1)).sum()]
    grid = Grid(shape, 1.5)
    near = distance(first, second, grid, tolerance=1e-8).value
    far = distance(first, np.roll(second, 30, axis=0), grid, tolerance=1e-8).value
    assert far == pytest.approx(near + 2 * 30 * between + 30**2, rel=1e-8)


@pytest.mark.parametrize("sigma", [0.8, 1.5])
def test_units_do_not_depend_on_the_margin(sigma):
    small = ragged(9, 2, (10, 8))
    large = np.pad(small, ((0, 0), (5, 9), (12, 3)))
    one = distance(*small, Grid((10, 8), sigma), tolerance=1e-8)
    other = distance(*large, Grid(large.shape[1:], sigma), tolerance=1e-8)
    assert one.value == pytest.approx(other.value, rel=1e-8)


@pytest.mark.parametrize("sigma", [0.9, 2.5])
def test_scalings_define_the_plan(sigma):
    """Both marginals, computed independently; the last update makes the first one exact."""
    first, second = ragged(10, 2, (13, 10))
    grid = Grid((13, 10), sigma)
    found = distance(first, second, grid, tolerance=1e-6)
    one, other = plan_marginals(found, grid)
    np.testing.assert_allclose(one, first / first.mean(), atol=1e-12)
    assert np.abs(other - second / second.mean()).mean() < 2e-6
    assert np.abs(other - second / second.mean()).mean() > 0.0
    np.testing.assert_allclose(found.v, np.exp(found.log_v))
    np.testing.assert_allclose(found.w, np.exp(found.log_w))
    assert found.log_v.max() == pytest.approx(found.log_w.max())


@pytest.mark.parametrize("rounds", [1, 2, 5, 9])
def test_the_error_of_an_early_stop_is_correct(rounds):
    first, second = ragged(11, 2, (31,))
    grid = Grid((31,), 1.0)
    found = distance(first, second, grid, tolerance=1e-12, max_iterations=rounds)
    one, other = plan_marginals(found, grid)
    assert not found.converged
    assert found.iterations == rounds
    np.testing.assert_allclose(one, first / first.mean(), atol=1e-12)
    assert 1e-12 < np.abs(other - second / second.mean()).mean() <= 2 * found.marginal_error


def test_a_smaller_tolerance_is_reached_and_takes_longer():
    first, second = ragged(12, 2, (40,))
    found = [distance(first, second, Grid((40,), 1.0), tolerance=t, max_iterations=5000) for t in (1e-2, 1e-5, 1e-9)]
    assert all(one.converged for one in found)
    assert [one.marginal_error < t for one, t in zip(found, (1e-2, 1e-5, 1e-9), strict=True)] == [True] * 3
    assert found[0].iterations < found[1].iterations < found[2].iterations


@pytest.mark.parametrize("shape", [(64,), (32, 48), (16, 32, 16)])
def test_coarse_levels_change_only_the_time(shape, monkeypatch):
    first, second = ragged(13, 2, shape)
    grid = Grid(shape, 1.5)
    with_levels = distance(first, second, grid, tolerance=1e-8, max_iterations=5000)
    monkeypatch.setattr(Grid, "coarser", lambda self: None)
    alone = distance(first, second, grid, tolerance=1e-8, max_iterations=5000)
    assert with_levels.value == pytest.approx(alone.value, rel=1e-8)


def test_coarse_levels_provide_the_start_of_the_finest(monkeypatch):
    """Potentials are scaled by four from one level to the next, which leaves a third of the rounds (measured)."""
    first, second = np.zeros((2, 64, 64))
    first[8:16, 8:16], second[32:48, 32:48] = np.random.default_rng(0).random((8, 8)), 1.0
    rounds = []
    for levels in (True, False):
        if not levels:
            monkeypatch.setattr(Grid, "coarser", lambda self: None)
        reports = list(distance_rounds(first, second, Grid((64, 64), 2.0), debias=False, tolerance=1e-2))
        rounds.append(sum(report.payload.elements == 64 * 64 for report in reports))
    assert rounds[0] < 0.6 * rounds[1]


def test_both_boundaries_give_the_same_distance_far_inside():
    """Walls change the kernel only near them, by the heat that they reflect."""
    first, second = gaussian((40, 36), [18, 17], 4.0), gaussian((40, 36), [23, 19], 6.0)
    one, other = (distance(first, second, Grid((40, 36), 1.2, b), tolerance=1e-8).value for b in ("open", "reflecting"))
    assert one == pytest.approx(other, rel=1e-8)
    uniform = distance(np.ones((8, 6)), np.ones((8, 6)), Grid((8, 6), 2.0, "reflecting"), debias=False)
    assert uniform.value == pytest.approx(0.0, abs=1e-12)
    assert uniform.iterations == 1


def test_masses_are_normalized_without_changing_the_inputs():
    first, second = ragged(14, 2, (9, 7))
    before = first.copy(), second.copy()
    grid = Grid((9, 7), 1.0)
    assert distance(3.0 * first, second / 7.0, grid).value == pytest.approx(distance(first, second, grid).value)
    np.testing.assert_array_equal(first, before[0])
    np.testing.assert_array_equal(second, before[1])


@pytest.mark.parametrize("layout", [np.asfortranarray, np.ndarray.tolist, lambda m: m.astype(np.longdouble)])
def test_the_layout_of_the_inputs_does_not_matter(layout):
    mus = ragged(15, 2, (10, 12))
    grid = Grid((10, 12), 1.2)
    expected = distance(*mus, grid)
    assert distance(*map(layout, mus), grid).value == expected.value
    assert distance_matrix(layout(mus), grid).values[0, 1] == pytest.approx(expected.value, rel=1e-8)


def test_the_matrix_holds_the_distances_of_all_pairs():
    mus = ragged(16, 4, (9, 8))
    grid = Grid((9, 8), 1.1)
    found = distance_matrix(mus, grid, tolerance=1e-8)
    np.testing.assert_array_equal(found.values, found.values.T)
    np.testing.assert_array_equal(np.diag(found.values), 0.0)
    for i, j in zip(*np.triu_indices(4, 1), strict=True):
        pair = distance(mus[i], mus[j], grid, tolerance=1e-8)
        assert found.values[i, j] == pytest.approx(pair.value, rel=1e-8)
        assert pair.iterations <= found.iterations
    assert found.converged
    assert found.marginal_error < 1e-8


def test_the_matrix_does_not_depend_on_its_blocks():
    """At most sixteen pairs are solved together: the 28 pairs of eight in two blocks, the ten of five in one."""
    mus = ragged(17, 8, (32,))
    some = distance_matrix(mus[3:], Grid((32,), 1.5), tolerance=1e-8)
    blocks = distance_matrix(mus, Grid((32,), 1.5), tolerance=1e-8)
    np.testing.assert_allclose(blocks.values[3:, 3:], some.values, rtol=1e-6)


def test_the_matrix_follows_a_permutation_of_its_inputs():
    mus = ragged(18, 4, (6, 5))
    order = np.array([2, 0, 3, 1])
    grid = Grid((6, 5), 1.0)
    one, other = (distance_matrix(m, grid, tolerance=1e-8).values for m in (mus, mus[order]))
    np.testing.assert_allclose(other, one[np.ix_(order, order)], rtol=1e-8)


def test_a_matrix_of_one_is_zero():
    found = distance_matrix(ragged(19, 1, (6, 5)), Grid((6, 5), 1.0))
    np.testing.assert_array_equal(found.values, [[0.0]])
    assert found.converged


def test_lengths_keep_the_triangle_inequality():
    """Debiased entropic lengths are no metric, but these distributions are far apart relative to the blur."""
    mus = np.stack([gaussian((60,), [c], v) for c, v in ((15, 4), (25, 9), (33, 2), (44, 16))])
    lengths = np.sqrt(distance_matrix(mus, Grid((60,), 1.5)).values)
    detours = (lengths[:, :, None] + lengths[None]).min(axis=1)
    assert (lengths <= detours + 1e-6).all()
    # For equal shapes along a line, the inequality is an equality.
    moved = np.stack([gaussian((60,), [c], 6.0) for c in (18, 27, 41)])
    lengths = np.sqrt(distance_matrix(moved, Grid((60,), 1.5), tolerance=1e-8).values)
    assert lengths[0, 2] == pytest.approx(lengths[0, 1] + lengths[1, 2], abs=1e-7)


def test_far_numerics_take_over_with_the_same_result():
    """Lines span little, the diagonal exceeds float64: scalings fail, and the translation stays exact."""
    shape = (29, 29, 29)
    first = np.zeros(shape)
    first[1:4, 1:4, 1:4] = np.random.default_rng(20).random((3, 3, 3))
    second = np.roll(first, (24, 24, 24), axis=(0, 1, 2))
    far = distance(first, second, Grid(shape, 0.75), tolerance=1e-7)
    assert far.numerics == "log domain by line"
    assert far.converged
    assert far.value == pytest.approx(3 * 24**2, rel=1e-9)
    near = distance(first, second, Grid(shape, 1.5), tolerance=1e-7)
    assert near.numerics == "scaling"
    assert near.value == pytest.approx(3 * 24**2, rel=1e-9)


@pytest.mark.parametrize("solve", [distance, lambda mu, nu, grid: distance_matrix([mu, nu], grid)])
def test_a_kernel_that_is_too_narrow_is_refused(solve):
    """Over 60 cells, the potentials would exceed the value that represents nothing."""
    first, second = gaussian((128,), [34], 4.0), gaussian((128,), [94], 4.0)
    first[first < 1e-30], second[second < 1e-30] = 0.0, 0.0
    with pytest.raises(KernelTooNarrowError, match=r"gamma = .* is too small .*; try"):
        solve(first, second, Grid((128,), 0.3))


@pytest.mark.parametrize("sigma", [1.0, 1.3])
def test_beyond_the_entries_of_the_kernel_the_distance_is_accurate(sigma):
    """On a line, 60 cells are more than 36 sigma."""
    first, second = gaussian((128,), [34], 4.0), gaussian((128,), [94], 4.0)
    first[first < 1e-30], second[second < 1e-30] = 0.0, 0.0
    found = distance(first, second, Grid((128,), sigma), tolerance=1e-6, max_iterations=5000)
    assert found.numerics == "log domain by line"
    assert found.converged
    assert found.value == pytest.approx(60**2, rel=1e-6)


@pytest.mark.parametrize(
    "rounds", [distance_rounds, lambda a, b, *rest, **own: distance_matrix_rounds([a, b], *rest, **own)]
)
def test_every_round_is_reported_and_can_be_cancelled(rounds):
    first, second = ragged(21, 2, (17, 9))
    reports = list(rounds(first, second, Grid((17, 9), 1.0)))
    assert {report.payload.elements for report in reports} == {17 * 9}
    numbers = [report.payload.iteration for report in reports]
    assert all(later == before + 1 or later == 1 for before, later in pairwise(numbers))
    assert min(report.payload.error for report in reports) < 1e-5
    fractions = [report.fraction for report in reports]
    assert fractions == sorted(fractions)
    assert 0.0 <= fractions[0] < 0.3
    assert 0.9 < fractions[-1] <= 1.0
    control = CountingControl(last=3)
    with pytest.raises(Cancelled):
        list(rounds(first, second, Grid((17, 9), 1.0), control=control))
    assert control.count == 3
