# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.errors import Cancelled
from convwass_addon.transport import Grid, barycenter, bisect, interpolate, propagate
from convwass_addon.transport.sharpening import entropy
from tests.controls import CountingControl
from tests.transport import gaussians
from tests.transport.gaussians import gaussian, moments, quantiles

EACH = pytest.mark.parametrize("solve", [interpolate, bisect])


def pair(shape, seed=0):
    """A box and an uneven patch that do not overlap."""
    rng = np.random.default_rng(seed)
    densities = np.zeros((2, *shape))
    low = tuple(slice(n // 8, n // 3) for n in shape)
    high = tuple(slice(n // 2, 7 * n // 8) for n in shape)
    densities[0][low] = 1.0
    densities[1][high] = rng.random(densities[1][high].shape) ** 2 + 0.1
    return densities / densities.mean(axis=tuple(range(1, len(shape) + 1)), keepdims=True)


@pytest.mark.parametrize("sharpness", [0.0, 0.75])
def test_frames_are_barycenters_in_the_order_of_the_times(sharpness):
    """Solved one from the other in any order, they agree with cold solves within the tolerance."""
    mus, grid = pair((32, 24)), Grid((32, 24), 1.4)
    times = [0.7, 0.0, 0.25, 1.0, 0.7]
    options = {"sharpness": sharpness, "tolerance": 1e-4, "max_iterations": 1000}
    found = interpolate(*mus, times, grid, **options)
    np.testing.assert_array_equal(found.times, times)
    np.testing.assert_allclose(found.densities[[1, 3]], mus, rtol=1e-12)
    for i in (0, 2, 4):
        cold = barycenter(mus, [1 - times[i], times[i]], grid, **options).density
        assert np.abs(found.densities[i] - cold).mean() < 1e-3
    assert found.iterations[1] == found.iterations[3] == 0
    assert found.converged.all()
    assert (found.marginal_errors[[0, 2, 4]] < 1e-4).all()
    assert (found.marginal_errors[[1, 3]] == 0.0).all()
    np.testing.assert_allclose(found.entropies, [entropy(mu, grid.weights) for mu in found.densities])
    assert found.numerics == "scaling"


def test_an_entropy_limit_holds_in_every_frame_of_interpolate():
    mus, grid = pair((32, 24)), Grid((32, 24), 1.4)
    limit = max(entropy(mu, grid.weights) for mu in mus)
    free = interpolate(*mus, [0.3, 0.6], grid)
    bounded = interpolate(*mus, [0.3, 0.6], grid, entropy_limit="max")
    assert (free.entropies > limit + 0.01).all()
    assert (bounded.entropies < limit + 1e-3).all()
    low = interpolate(*mus, [0.5], grid, entropy_limit=limit - 0.2)
    assert low.entropies[0] == pytest.approx(limit - 0.2, abs=1e-3)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-6])
@pytest.mark.parametrize("levels", [1, 3])
def test_bisection_of_equal_gaussians_is_displacement_interpolation(levels, tolerance):
    """With the entropy bounded by the ends, every frame is a translated end: centers and variances are exact.

    Measured: centers within 5 cells times the tolerance, variances to rounding.
    """
    shape = (96,)
    found = bisect(
        gaussian(shape, [36], 16.0),
        gaussian(shape, [60], 16.0),
        Grid(shape, 1.5),
        levels=levels,
        tolerance=tolerance,
        max_iterations=1000,
    )
    assert found.converged.all()
    np.testing.assert_array_equal(found.times, np.arange(2**levels + 1) / 2**levels)
    for t, density in zip(found.times, found.densities, strict=True):
        mean, variance = moments(density)
        assert mean[0] == pytest.approx(36 + 24 * t, abs=10 * tolerance)
        assert variance[0, 0] == pytest.approx(16.0, abs=1e-9)
        assert np.abs(density - gaussian(shape, [36 + 24 * t], 16.0)).mean() < 2 * tolerance


def test_bisection_without_a_limit_adds_a_blur_per_level():
    """Midpoints of midpoints: the closed form's covariances, level by level; measured within 1e-5."""
    shape, ends = (80, 70), [np.array([[16.0, 6], [6, 9]]), np.array([[8.0, -3], [-3, 14]])]
    means = np.array([[34.0, 32.0], [46.0, 38.0]])
    found = bisect(
        *(gaussian(shape, m, c) for m, c in zip(means, ends, strict=True)),
        Grid(shape, 1.5),
        levels=2,
        entropy_limit=None,
        tolerance=1e-6,
    )
    middle = gaussians.barycenter_covariance(ends, [0.5, 0.5], 1.5, 0.0)
    quarters = [gaussians.barycenter_covariance([end, middle], [0.5, 0.5], 1.5, 0.0) for end in ends]
    for t, covariance, density in zip(
        (0.25, 0.5, 0.75), (quarters[0], middle, quarters[1]), found.densities[1:-1], strict=True
    ):
        mean = (1 - t) * means[0] + t * means[1]
        assert np.abs(density - gaussian(shape, mean, covariance)).mean() < 1e-5


@pytest.mark.parametrize(("levels", "within"), [(1, 0.09), (2, 0.14), (3, 0.2)])
def test_bisection_of_boxes_averages_their_quantiles(levels, within):
    """Displacement interpolation on a line averages quantile functions.

    W1 to the exact result in cells, for a kernel of 1.5; measured 0.075, 0.12 and 0.17: every level rounds the edges.
    """
    x = np.arange(128)
    first, second = (np.abs(x - 30.5) < 12) + 0.0, (np.abs(x - 90.5) < 24) + 0.0
    shares = (np.arange(5000) + 0.5) / 5000
    found = bisect(first, second, Grid((128,), 1.5), levels=levels, max_iterations=1000)
    assert found.converged.all()
    for t, density in zip(found.times, found.densities, strict=True):
        exact = (1 - t) * quantiles(first, shares) + t * quantiles(second, shares)
        assert np.abs(quantiles(density, shares) - exact).mean() < within
        assert moments(density)[0][0] == pytest.approx(31 + 60 * t, abs=0.05)


@pytest.mark.parametrize("shape", [(28, 24), (12, 10, 13)])
def test_entropies_stay_below_the_larger_neighbor(shape):
    mus, grid = pair(shape), Grid(shape, 1.2)
    found = bisect(*mus, grid, levels=3)
    first, last = found.entropies[[0, -1]]
    for spacing in (8, 4, 2):
        known = found.entropies[::spacing]
        made = found.entropies[spacing // 2 :: spacing]
        assert (made <= np.maximum(known[:-1], known[1:]) + 1e-6).all()
    assert found.entropies.max() <= max(first, last) + 1e-6
    bare = bisect(*mus, grid, levels=1, entropy_limit=None)
    assert bare.entropies[1] > max(first, last) + 0.01
    numbered = bisect(*mus, grid, levels=2, entropy_limit=max(first, last) - 0.1)
    np.testing.assert_allclose(numbered.entropies[1:-1], max(first, last) - 0.1, atol=1e-6)


def test_bisection_returns_frames_in_order():
    mus, grid = pair((40, 36)), Grid((40, 36), 1.3)
    found = bisect(*mus, grid, levels=3)
    assert found.densities.shape == (9, 40, 36)
    np.testing.assert_allclose(found.densities[[0, -1]], mus, rtol=1e-12)
    np.testing.assert_allclose(found.densities.mean(axis=(1, 2)), 1.0)
    centers = np.array([moments(density)[0] for density in found.densities])
    assert (np.diff(centers, axis=0) > 0).all()
    np.testing.assert_allclose(np.diff(centers, axis=0), (centers[-1] - centers[0]) / 8 * np.ones((8, 2)), atol=0.15)
    assert len(found.iterations) == 3
    assert found.converged.all()
    assert (found.marginal_errors < 1e-2).all()


def test_bisection_at_other_times():
    """In the given order, including duplicates and ends; every frame is solved from the two adjacent to it."""
    shape = (96,)
    mus = gaussian(shape, [36], 16.0), gaussian(shape, [60], 16.0)
    times = [0.9, 0.1, 0.3, 0.5, 0.1, 0.0, 1.0, 0.25]
    found = bisect(*mus, Grid(shape, 1.5), levels=2, times=times, tolerance=1e-5, max_iterations=1000)
    np.testing.assert_array_equal(found.times, times)
    np.testing.assert_array_equal(found.densities[1], found.densities[4])
    np.testing.assert_allclose(found.densities[[5, 6]], mus, rtol=1e-12)
    for t, density in zip(times, found.densities, strict=True):
        assert moments(density)[0][0] == pytest.approx(36 + 24 * t, abs=1e-3)
        assert moments(density)[1][0, 0] == pytest.approx(16.0, abs=1e-5)
    assert len(found.iterations) == 3
    only_known = bisect(*mus, Grid(shape, 1.5), levels=2, times=[0.75, 0.5])
    assert len(only_known.iterations) == 2
    assert moments(only_known.densities[0])[0][0] > moments(only_known.densities[1])[0][0]


def test_one_level_equals_propagation_over_a_line():
    mus, grid = pair((24, 28)), Grid((24, 28), 1.3)
    line = propagate([[0, 1], [1, 2]], 1.0, {0: mus[0], 2: mus[1]}, grid, tolerance=1e-8)
    halved = bisect(*mus, grid, levels=1, entropy_limit=None, tolerance=1e-8)
    np.testing.assert_allclose(halved.densities[1], line.densities[1], atol=1e-12)
    middle = interpolate(*mus, [0.5], grid, tolerance=1e-8, max_iterations=1000)
    np.testing.assert_allclose(halved.densities[1], middle.densities[0], atol=1e-6)


@EACH
def test_backwards_is_the_reverse(solve):
    mus, grid = pair((40,)), Grid((40,), 1.3)
    times = [0.25, 0.6]
    forward = one_of(solve, *mus, times, grid, tolerance=1e-4)
    backward = one_of(solve, *mus[::-1], [1 - t for t in times], grid, tolerance=1e-4)
    assert np.abs(forward.densities - backward.densities).mean() < 1e-3


def one_of(solve, mu0, mu1, times, grid, **options):
    """Interpolate at given times with either function, with a small tolerance."""
    options = {"tolerance": 1e-6, "max_iterations": 2000, **options}
    if solve is bisect:
        return bisect(mu0, mu1, grid, levels=2, times=times, **options)
    return interpolate(mu0, mu1, times, grid, **options)


@EACH
def test_far_numerics_are_reported(solve):
    shape = (29, 29, 29)
    first = np.zeros(shape)
    first[1:4, 1:4, 1:4] = 1.0
    second = np.roll(first, (24, 24, 24), axis=(0, 1, 2))
    options = {"entropy_limit": None, "max_iterations": 3}
    assert one_of(solve, first, second, [0.0, 1.0], Grid(shape, 2.0), **options).numerics == "scaling"
    assert one_of(solve, first, second, [0.1], Grid(shape, 0.4), **options).numerics == "log domain by line"


@EACH
def test_both_can_be_cancelled_at_any_iteration(solve):
    control = CountingControl(last=5)
    with pytest.raises(Cancelled):
        one_of(solve, *pair((17, 13)), [0.5], Grid((17, 13), 1.2), control=control)
    assert control.count == 5


@EACH
def test_an_exceeded_iteration_limit_is_reported(solve):
    found = one_of(solve, *pair((17, 13)), [0.0, 0.5], Grid((17, 13), 1.2), max_iterations=2)
    assert found.converged.tolist() == [True, False]
    assert found.marginal_errors[1] > 1e-6
