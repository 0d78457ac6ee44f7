# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from hypothesis.extra import numpy as npst
from scipy.ndimage import gaussian_filter

from convwass_addon.transport import Grid
from convwass_addon.transport.domain import LOG_NOTHING
from convwass_addon.transport.region import Region

SHAPES = [(40,), (20, 31), (18, 24, 13)]


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("sigma", [0.8, 1.3, 3.0])
def test_apply_is_a_gaussian_in_free_space(shape, sigma):
    columns = np.random.default_rng(1).random((2, *shape))
    expected = [gaussian_filter(c, sigma, mode="constant", truncate=30) for c in columns]
    np.testing.assert_allclose(Grid(shape, sigma).apply(columns), expected, atol=1e-13)


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("method", ["log_apply", "log_apply_far"])
def test_log_forms_agree_with_apply(shape, method):
    grid = Grid(shape, 1.4)
    columns = np.random.default_rng(2).random((3, *shape)) + 1e-3
    logs = np.log(columns)
    getattr(grid, method)(logs, logs)  # in place, as the solver may call it
    np.testing.assert_allclose(np.exp(logs), grid.apply(columns), rtol=1e-12)


def brute_force_log_apply(logs, sigma):
    """Log-sum-exp over all pairs of cells of a line, without any scaling."""
    cells = np.arange(len(logs))
    kernel = -((cells[:, None] - cells) ** 2) / (2 * sigma**2) - np.log(np.sqrt(2 * np.pi) * sigma)
    return np.logaddexp.reduce(kernel + logs[None, :], axis=1)


def test_scalings_are_right_or_nothing():
    logs = np.linspace(-2500.0, 0.0, 200)[None]
    result = np.empty_like(logs)
    Grid((200,), 1.5).log_apply(logs, result)
    expected = brute_force_log_apply(logs[0], 1.5)
    reached = result[0] > LOG_NOTHING / 2
    assert 0 < reached.sum() < 200
    np.testing.assert_allclose(result[0, reached], expected[reached], rtol=1e-4)


def test_by_line_reaches_where_scalings_do_not():
    # Every line spans little, the grid as a whole far more than float64.
    rows = -9.0 * np.add.outer(np.arange(100.0), np.arange(100.0))
    grid = Grid((100, 100), 1.5)
    plain, by_line = np.empty((2, 1, 100, 100))
    grid.log_apply(rows[None], plain)
    grid.log_apply_far(rows[None], by_line)
    assert (plain <= LOG_NOTHING / 2).any()
    expected = np.stack([brute_force_log_apply(row, 1.5) for row in rows])
    expected = np.stack([brute_force_log_apply(column, 1.5) for column in expected.T]).T
    np.testing.assert_allclose(by_line[0], expected, rtol=1e-9)


def test_kernel_keeps_constants_and_is_symmetric():
    grid = Grid((40, 40), 1.5)
    assert grid.apply(np.ones((40, 40)))[20, 20] == pytest.approx(1.0, abs=1e-12)
    one, other = np.random.default_rng(3).random((2, 40, 40))
    assert (one * grid.apply(other)).sum() == pytest.approx((other * grid.apply(one)).sum())


def test_lengths_are_those_of_unit_volume():
    grid = Grid((8, 8, 64), 2.0)
    assert grid.weights * grid.cells == pytest.approx(1.0)
    assert grid.spacing**3 * grid.cells == pytest.approx(1.0)
    assert grid.gamma == pytest.approx(2 * (2.0 * grid.spacing) ** 2)


def test_restriction_keeps_mass_and_prolongation_keeps_lines():
    grid = Grid((16, 24, 32), 1.0)
    coarse = grid.coarser()
    assert coarse.shape == (8, 12, 16)
    assert coarse.sigma == grid.sigma
    density = np.random.default_rng(4).random((1, *grid.shape))
    restricted = grid.restrict(density)
    assert (restricted * coarse.weights).sum() == pytest.approx((density * grid.weights).sum())
    ramp = np.arange(12, dtype=float)[None, None, :, None] * np.ones((1, 8, 12, 16))
    doubled = grid.prolong(ramp, Region.whole(grid.shape)).reshape(1, *grid.shape)
    np.testing.assert_allclose(np.diff(doubled, axis=2)[:, :, 1:-1], 0.5)


def test_prolonging_to_a_region_is_prolonging_to_all_of_the_grid():
    grid = Grid((16, 24, 32), 1.0)
    rng = np.random.default_rng(5)
    columns = rng.random((2, 8, 12, 16))
    everywhere = grid.prolong(columns, Region.whole(grid.shape))
    for low, high in (((0, 0, 0), (5, 24, 9)), ((3, 7, 12), (4, 8, 13)), ((9, 3, 2), (16, 20, 32))):
        inside = np.zeros(grid.shape, bool)
        inside[tuple(map(slice, low, high))] = rng.random(np.subtract(high, low)) < 0.7
        inside[low] = True
        region = Region(inside)
        np.testing.assert_array_equal(grid.prolong(columns, region), everywhere[:, region.index])


@pytest.mark.parametrize("shape", SHAPES)
def test_transfer_between_regions_is_the_kernel_between_them(shape):
    grid = Grid(shape, 1.4)
    rng = np.random.default_rng(6)
    here, there = (Region(rng.random(shape) < share) for share in (0.3, 0.1))
    logs = rng.normal(0, 30, len(here))
    for transfer in (grid.log_transfer, grid.log_transfer_far):
        whole = here.scatter(logs, LOG_NOTHING)[None]
        expected = np.empty_like(whole)
        grid.log_apply_far(whole, expected)
        (found,) = transfer([logs], [here], [there])
        np.testing.assert_allclose(found, there.gather(expected[0]), atol=1e-9)


def test_odd_or_small_grids_have_no_coarser_level():
    assert Grid((17, 32), 1.0).coarser() is None
    assert Grid((8, 32), 1.0).coarser() is None


@pytest.mark.parametrize("shape", [(), (3, 3, 3, 3), (0, 4)])
def test_impossible_shapes_are_refused(shape):
    with pytest.raises(ValueError, match="shape"):
        Grid(shape, 1.0)


@pytest.mark.parametrize("sigma", [0.0, -1.0, np.nan, np.inf])
def test_impossible_blurs_are_refused(sigma):
    with pytest.raises(ValueError, match="sigma"):
        Grid((8, 8), sigma)


@settings(max_examples=40, deadline=None)
@given(npst.arrays(float, st.tuples(st.integers(1, 9), st.integers(1, 9)), elements=st.floats(-3000, 3000)))
def test_log_forms_are_never_nan(logs):
    grid = Grid(logs.shape, 1.1)
    for method in (grid.log_apply, grid.log_apply_far):
        result = np.empty((1, *logs.shape))
        method(logs[None], result)
        assert np.isfinite(result).all()
