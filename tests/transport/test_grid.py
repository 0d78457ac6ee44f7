# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from hypothesis.extra import numpy as npst
from scipy.ndimage import gaussian_filter

from convwass_addon.transport import Grid
from convwass_addon.transport.log_lines import log_blur
from convwass_addon.transport.log_range import LOG_NOTHING
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
    getattr(grid, method)(logs, logs)  # in place, as in the solver
    np.testing.assert_allclose(np.exp(logs), grid.apply(columns), rtol=1e-12)


def brute_force_log_apply(logs, sigma):
    """Log-sum-exp over all pairs of cells on a line, without any scaling."""
    cells = np.arange(len(logs))
    kernel = -((cells[:, None] - cells) ** 2) / (2 * sigma**2) - np.log(np.sqrt(2 * np.pi) * sigma)
    return np.logaddexp.reduce(kernel + logs[None, :], axis=1)


def test_scalings_are_accurate_or_fail():
    logs = np.linspace(-2500.0, 0.0, 200)[None]
    result = np.empty_like(logs)
    Grid((200,), 1.5).log_apply(logs, result)
    expected = brute_force_log_apply(logs[0], 1.5)
    reached = result[0] > LOG_NOTHING / 2
    assert 0 < reached.sum() < 200
    np.testing.assert_allclose(result[0, reached], expected[reached], rtol=1e-4)


def test_by_line_numerics_reach_further_than_scalings():
    # Each line spans a small range, the whole grid far more than float64.
    rows = -9.0 * np.add.outer(np.arange(100.0), np.arange(100.0))
    grid = Grid((100, 100), 1.5)
    plain, by_line = np.empty((2, 1, 100, 100))
    grid.log_apply(rows[None], plain)
    grid.log_apply_far(rows[None], by_line)
    assert (plain <= LOG_NOTHING / 2).any()
    expected = np.stack([brute_force_log_apply(row, 1.5) for row in rows])
    expected = np.stack([brute_force_log_apply(column, 1.5) for column in expected.T]).T
    np.testing.assert_allclose(by_line[0], expected, rtol=1e-9)


def kernel_of(grid):
    """The kernel as a matrix over all cells, (n, n)."""
    cells = np.eye(grid.cells).reshape(grid.cells, *grid.shape)
    return grid.apply(cells).reshape(grid.cells, -1)


@pytest.mark.parametrize("shape", [*SHAPES, (1,), (7, 1), (1, 5, 1)])
@pytest.mark.parametrize("sigma", [0.4, 1.3, 6.0, 40.0])
def test_reflecting_walls_reflect_all_heat(shape, sigma):
    """Compared with SciPy, which mirrors the grid as often as 40 deviations require."""
    columns = np.random.default_rng(7).random((2, *shape))
    expected = [gaussian_filter(c, sigma, mode="reflect", truncate=40) for c in columns]
    np.testing.assert_allclose(Grid(shape, sigma, "reflecting").apply(columns), expected, atol=1e-13)


@pytest.mark.parametrize("shape", [(1,), (2,), (17,), (6, 5), (3, 1, 4)])
@pytest.mark.parametrize("sigma", [0.02, 0.3, 1.0, 5.0, 300.0])
def test_the_reflecting_kernel_is_a_symmetric_stochastic_matrix(shape, sigma):
    """Rows sum to one up to rounding, for any sigma; a very large one makes everything uniform."""
    kernel = kernel_of(Grid(shape, sigma, "reflecting"))
    np.testing.assert_allclose(kernel.sum(axis=1), 1.0, rtol=0, atol=1e-13)
    np.testing.assert_allclose(kernel, kernel.T, rtol=0, atol=1e-15)
    assert (kernel >= 0).all()
    if sigma == 300.0:
        np.testing.assert_allclose(kernel, 1.0 / len(kernel), atol=1e-13)
    if sigma == 0.02:
        np.testing.assert_array_equal(kernel, np.eye(len(kernel)))


@pytest.mark.parametrize("shape", SHAPES)
def test_walls_keep_constants_and_mass(shape):
    walls, space = (Grid(shape, 3.0, boundary) for boundary in ("reflecting", "open"))
    np.testing.assert_allclose(walls.apply(np.full(shape, 2.5)), 2.5, rtol=1e-13)
    density = np.random.default_rng(8).random(shape)
    assert walls.apply(density).sum() == pytest.approx(density.sum(), rel=1e-13)
    assert space.apply(density).sum() < 0.95 * density.sum()


@pytest.mark.parametrize("boundary", ["open", "reflecting"])
def test_two_blurs_are_one_wider_blur(boundary):
    """With twice the variance, up to the discretization error at these deviations."""
    density = np.random.default_rng(9).random((40, 36))
    once = Grid((40, 36), np.sqrt(2.0) * 1.5, boundary).apply(density)
    half = Grid((40, 36), 1.5, boundary)
    twice = half.apply(half.apply(density))
    inner = (slice(16, 24), slice(16, 20)) if boundary == "open" else ...
    np.testing.assert_allclose(twice[inner], once[inner], atol=1e-8)


def test_both_boundaries_agree_far_inside():
    density = np.zeros((60, 50))
    density[25:35, 20:30] = 1.0
    one, other = (Grid((60, 50), 1.5, boundary).apply(density) for boundary in ("open", "reflecting"))
    np.testing.assert_allclose(one, other, atol=1e-15)


def test_levels_keep_their_boundary():
    coarse = Grid((32, 16), 1.5, "reflecting").coarser()
    assert coarse.boundary == "reflecting"
    np.testing.assert_allclose(coarse.apply(np.ones((16, 8))), 1.0)
    with pytest.raises(ValueError, match="boundary"):
        Grid((8, 8), 1.0, "periodic")


@pytest.mark.parametrize("shape", [(5,), (3, 4), (2, 3, 4)])
def test_positions_are_the_centers_of_cells_in_cells(shape):
    positions = Grid(shape, 1.0).positions
    assert positions.shape == (*shape, len(shape))
    for cell in np.ndindex(*shape):
        np.testing.assert_array_equal(positions[cell], np.array(cell) + 0.5)


@pytest.mark.parametrize("shape", [(50,), (20, 80), (8, 16, 64)])
def test_the_unit_length_converts_gamma_to_squared_cells(shape):
    """Grids of any shape have unit volume, and sigma^2 is half of gamma."""
    grid = Grid(shape, 2.5)
    assert grid.gamma * grid.unit_length**2 == pytest.approx(2 * 2.5**2)
    assert np.prod(np.array(shape) / grid.unit_length) == pytest.approx(1.0)
    assert grid.weights * grid.cells == pytest.approx(1.0)


@pytest.mark.parametrize("height", [-9000.0, 0.0, 5500.0, 9000.0])
def test_cells_beyond_reach_stay_empty_for_any_scalings(height):
    """A cell beyond the reach of the kernel gets no value, even if scalings elsewhere are large."""
    logs = np.full((1, 200), LOG_NOTHING)
    logs[0, :5] = height
    result = np.empty_like(logs)
    Grid((200,), 1.0).log_apply(logs, result)
    assert (result[0, 60:] == LOG_NOTHING).all()
    assert (result[0, :5] > height - 2).all()


@pytest.mark.parametrize("height", [-9000.0, 0.0, 5500.0])
def test_in_the_log_domain_the_kernel_reaches_a_hundred_deviations(height):
    logs = np.full((1, 200), LOG_NOTHING)
    logs[0, :5] = height
    result = np.empty_like(logs)
    Grid((200,), 1.0).log_apply_far(logs, result)
    expected = brute_force_log_apply(logs[0], 1.0)
    known = expected > height + LOG_NOTHING / 2 + 5
    known &= expected > LOG_NOTHING + 10
    assert known.sum() > 40
    assert (result[0, 4 + 102 :] == LOG_NOTHING).all()
    np.testing.assert_allclose(result[0, known], expected[known], atol=1e-7)


@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 2**31 - 1),
    size=st.integers(1, 260),
    sigma=st.floats(0.4, 2.5),
    slope=st.floats(-15.0, 15.0),
    curvature=st.floats(-1.0, 1.0),
    empty=st.sampled_from([0.0, 0.3, 0.9]),
)
def test_log_blur_agrees_with_brute_force(seed, size, sigma, slope, curvature, empty):
    """Potentials as in solvers: slopes and parabolas that compensate the kernel, with noise and gaps."""
    rng = np.random.default_rng(seed)
    x = np.arange(size) - size / 2
    logs = rng.normal(size=(3, size)) * 10 + slope * x + curvature * np.clip(x**2 / (2 * sigma**2), 0, 3000)
    logs[rng.random((3, size)) < empty] = LOG_NOTHING
    scale = -np.log(np.sqrt(2 * np.pi) * sigma)
    found = log_blur(logs, sigma, scale)
    expected = np.stack([brute_force_log_apply(line, sigma) for line in logs])
    known = expected > LOG_NOTHING + 50
    np.testing.assert_allclose(found[known], expected[known], rtol=1e-9, atol=1e-9)
    assert (found >= LOG_NOTHING).all()


def test_walls_reflect_distant_mass():
    """Compared with mirror images of the line behind both walls."""
    rng = np.random.default_rng(1)
    logs = 20 * rng.normal(size=(1, 60)) - 8 * np.arange(60)
    result = np.empty_like(logs)
    Grid((60,), 1.0, "reflecting").log_apply_far(logs, result)
    images = np.concatenate([logs[0, ::-1], logs[0], logs[0, ::-1]])
    np.testing.assert_allclose(result[0], brute_force_log_apply(images, 1.0)[60:120], atol=1e-7)


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


@pytest.mark.parametrize(("sigma", "coarser"), [(1.0, 1.0), (1.25, 1.25), (2.0, 1.25), (2.5, 1.25), (6.0, 3.0)])
def test_a_coarser_grid_keeps_the_kernel_unless_its_cells_are_too_large(sigma, coarser):
    grid = Grid((32, 16, 16), sigma)
    assert grid.coarser().sigma == pytest.approx(coarser)
    assert grid.coarser().gamma / grid.gamma == pytest.approx(grid.fall_of_gamma)
    assert 1.0 <= grid.fall_of_gamma <= 4.0


def test_restriction_keeps_mass_and_prolongation_linear_functions():
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


def test_prolonging_to_a_region_agrees_with_the_whole_grid():
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
