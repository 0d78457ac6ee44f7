# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from convwass_addon.transport import Grid, barycenter, distance, transport_map
from convwass_addon.transport.log_range import LOG_NOTHING
from tests.transport import gaussians
from tests.transport.gaussians import gaussian

# Shape, means and covariances: a line, rotated axes, and three dimensions.
PAIRS = [
    ((84,), ([36.0], [44.0]), (np.diag([16.0]), np.diag([36.0]))),
    ((64, 60), ([28.0, 30.0], [36.0, 27.0]), (np.array([[16.0, 8], [8, 12]]), np.array([[12.0, -5], [-5, 20]]))),
    ((32, 36, 34), ([14.0, 18, 16], [17.0, 17, 18]), (np.diag([6.0, 9, 7]), np.diag([8.0, 5, 6]))),
]


def core(density):
    """Cells above a thousandth of the largest density: 3.7 deviations of a Gaussian."""
    return density > 1e-3 * density.max()


@pytest.mark.parametrize("sigma", [1.2, 2.5])
@pytest.mark.parametrize(("shape", "means", "covariances"), PAIRS)
def test_maps_of_gaussians_are_linear(shape, means, covariances, sigma):
    """x -> m1 + A (x - m0), with the closed form's A.

    Measured within 8e-6 cells, and 3e-4 in three dimensions, where the grid cuts off more of the tails.
    """
    mus = [gaussian(shape, m, c) for m, c in zip(means, covariances, strict=True)]
    grid = Grid(shape, sigma)
    found = distance(*mus, grid, tolerance=1e-7)
    slopes = gaussians.map_slope(*covariances, sigma), gaussians.map_slope(*covariances[::-1], sigma)
    for log_scaling, slope, source, target, mu in (
        (found.log_w, slopes[0], *means, mus[0]),
        (found.log_v, slopes[1], *means[::-1], mus[1]),
    ):
        expected = target + (grid.positions - source) @ slope.T
        np.testing.assert_allclose(transport_map(log_scaling, grid)[core(mu)], expected[core(mu)], atol=5e-4)


def test_narrow_kernels_give_the_optimal_map():
    """The slope of the optimal map is 1.5; the entropic slope is sigma^2 / (2 variance) less, to the fourth order."""
    shape, means, (first, second) = PAIRS[0]
    grid = Grid(shape, 1.0)
    found = distance(gaussian(shape, means[0], first), gaussian(shape, means[1], second), grid, tolerance=1e-8)
    slopes = np.diff(transport_map(found.log_w, grid)[30:42, 0])
    np.testing.assert_allclose(slopes, 1.5 - 1.0 / (2 * 16), atol=5e-4)


def test_the_map_to_a_shifted_copy_is_a_blurred_shift():
    """The images are means of the plan's rows, so their overall mean is exactly that of the target."""
    shape = (40, 30)
    first = np.zeros(shape)
    first[8:20, 6:18] = np.random.default_rng(0).random((12, 12))
    second = np.roll(first, (11, 9), axis=(0, 1))
    grid = Grid(shape, 1.0)
    found = distance(first, second, grid, tolerance=1e-8)
    images = transport_map(found.log_w, grid)
    mass = first / first.sum()
    own, moved = ((mass[..., None] * m).sum(axis=(0, 1)) for m in (grid.positions, images))
    np.testing.assert_allclose(moved - own, [11, 9], atol=1e-7)
    # The plan is as wide as the kernel, and near an edge it is lopsided.
    assert np.abs(images - grid.positions - [11, 9])[first > 0].max() < 1.0


def test_from_an_input_to_the_barycenter():
    """With the barycenter's own scalings, the images of an input have the barycenter's mean, and its map is linear."""
    shape = (90,)
    mus = np.stack([gaussian(shape, [30], 9.0), gaussian(shape, [54], 25.0)])
    grid = Grid(shape, 1.5)
    found = barycenter(mus, [0.5, 0.5], grid, tolerance=1e-7, max_iterations=2000)
    variance = gaussians.barycenter_covariance([np.eye(1) * 9, np.eye(1) * 25], [0.5, 0.5], 1.5, 0.0)
    for log_v, mu, mean, spread in zip(found.log_v, mus, (30, 54), (9.0, 25.0), strict=True):
        images = transport_map(log_v, grid)[:, 0]
        slope = gaussians.map_slope(np.eye(1) * spread, variance, 1.5)[0, 0]
        expected = 42 + slope * (np.arange(90) + 0.5 - mean)
        np.testing.assert_allclose(images[core(mu)], expected[core(mu)], atol=1e-4)


@pytest.mark.parametrize("layout", [np.ascontiguousarray, np.asfortranarray, lambda v: v[..., ::-1]])
def test_any_values_are_carried_along(layout):
    """Means of columns of any range and memory layout, compared with the plan's own rows."""
    rng = np.random.default_rng(1)
    grid = Grid((9, 7), 1.3)
    mus = rng.random((2, 9, 7)) * (rng.random((2, 9, 7)) > 0.3)
    log_w = distance(*mus, grid).log_w
    values = layout(rng.normal(size=(9, 7, 5)) * [1e-6, 1.0, 1e6, 1.0, 1.0] + [0.0, 0.0, 0.0, 1e9, -3.0])
    found = transport_map(log_w, grid, values)
    w = np.exp(log_w)
    expected = np.moveaxis(grid.apply(w * np.moveaxis(values, -1, 0)) / grid.apply(w), 0, -1)
    # The precision is relative to the largest value of each column.
    assert (np.abs(found - expected) <= 1e-12 * np.abs(values).max(axis=(0, 1))).all()


def test_constant_columns_are_exactly_unchanged():
    rng = np.random.default_rng(2)
    grid = Grid((8, 6), 1.1)
    log_w = distance(*rng.random((2, 8, 6)), grid).log_w
    values = np.broadcast_to([0.1, -7e9, 0.0, 3.3e-200], (8, 6, 4))
    np.testing.assert_array_equal(transport_map(log_w, grid, values), values)


def test_images_stay_within_the_range_of_the_values():
    rng = np.random.default_rng(3)
    grid = Grid((12, 11), 2.0)
    log_w = distance(*rng.random((2, 12, 11)), grid).log_w
    images = transport_map(log_w, grid)
    assert images.min() >= 0.5
    assert images[..., 0].max() <= 11.5
    assert images[..., 1].max() <= 10.5


def test_cells_that_no_mass_reaches_keep_their_values():
    """Beyond 141 deviations, the logarithm of the kernel is the value that represents nothing."""
    grid = Grid((260,), 1.0)
    mu = np.zeros(260)
    mu[10:14] = 1.0
    log_w = distance(mu, np.roll(mu, 3), grid).log_w
    images = transport_map(log_w, grid)[:, 0]
    own = grid.positions[:, 0]
    unreached = own > 17 + 145
    np.testing.assert_array_equal(images[unreached], own[unreached])
    assert (images[own < 40] < 18).all()
    nothing = np.full(260, LOG_NOTHING)
    nothing[5] = 0.0
    np.testing.assert_allclose(transport_map(nothing, grid)[:20], 5.5)


@settings(max_examples=20, deadline=None, derandomize=True)
@given(
    shape=st.lists(st.integers(1, 12), min_size=1, max_size=3),
    sigma=st.floats(0.03, 30.0),
    reach=st.floats(0.0, 3000.0),
    seed=st.integers(0, 2**32 - 1),
)
def test_never_nan_and_never_out_of_range(shape, sigma, reach, seed):
    rng = np.random.default_rng(seed)
    grid = Grid(shape, sigma, ("open", "reflecting")[seed % 2])
    log_scaling = np.where(rng.random(shape) < 0.5, -reach * rng.random(shape), LOG_NOTHING)
    values = rng.normal(size=(*shape, 3)) * 10.0 ** rng.integers(-8, 8, 3)
    images = transport_map(log_scaling, grid, values)
    room = 1e-9 * np.ptp(values.reshape(-1, 3), axis=0)
    assert np.isfinite(images).all()
    assert (images >= values.reshape(-1, 3).min(axis=0) - room).all()
    assert (images <= values.reshape(-1, 3).max(axis=0) + room).all()
