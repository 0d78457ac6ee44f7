# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.errors import Cancelled
from convwass_addon.progress import Control
from convwass_addon.transport import Grid, KernelTooNarrowError, barycenter, propagate
from convwass_addon.transport.graph import line
from convwass_addon.transport.propagation import propagation
from convwass_addon.transport.relaxation import AdaptiveRelaxation
from convwass_addon.transport.sharpening import entropy
from tests.transport import dense
from tests.transport.gaussians import barycenter_covariance, gaussian, moments


def uneven(seed, count, shape):
    """Positive densities of mass 1."""
    densities = np.random.default_rng(seed).random((count, *shape)) ** 2 + 0.02
    return densities / densities.mean(axis=tuple(range(1, len(shape) + 1)), keepdims=True)


def star(mus, weights, grid, **options):
    """The density at a free vertex that is connected with each of `mus` by an edge."""
    edges = [(i, len(mus)) for i in range(len(mus))]
    return propagate(edges, weights, dict(enumerate(mus)), grid, **options)


GRAPHS = {
    "line of three": ([(0, 1), (1, 2), (2, 3)], [1.0, 2.0, 0.5], (0, 3)),
    "star": ([(0, 3), (3, 1), (2, 3)], [0.5, 0.3, 0.2], (0, 1, 2)),
    "cycle and tail": ([(0, 2), (2, 3), (3, 1), (2, 4), (3, 4), (4, 5)], 1.0, (0, 1)),
    "double edge": ([(0, 1), (1, 0), (1, 2), (1, 2)], [1.0, 0.5, 0.3, 0.9], (0, 2)),
}


@pytest.mark.parametrize(("edges", "weights", "given"), GRAPHS.values(), ids=GRAPHS.keys())
@pytest.mark.parametrize(("shape", "sigma"), [((10,), 1.2), ((4, 4), 0.9)])
def test_the_minimum_over_a_graph_is_found(edges, weights, given, shape, sigma):
    """Compared with Newton's method on the dual of the convex problem; measured agreement 1e-12."""
    grid = Grid(shape, sigma)
    fixed = dict(zip(given, uneven(1, len(given), shape), strict=True))
    expected = dense.propagated(edges, weights, fixed, grid)
    found = propagate(edges, weights, fixed, grid, tolerance=1e-11, max_iterations=5000)
    assert found.converged.all()
    np.testing.assert_allclose(found.densities, expected, atol=1e-9)


@pytest.mark.parametrize("count", [1, 2, 3, 10])
def test_barycenters_are_minima_over_a_star(count):
    """Compares the barycenter solver with Newton's method, for weights of any sum."""
    grid = Grid((9,), 1.1)
    mus = uneven(2, count, (9,))
    weights = np.random.default_rng(3).random(count) + 0.1
    edges = [(i, count) for i in range(count)]
    expected = dense.propagated(edges, weights, dict(enumerate(mus)), grid)[-1]
    found = barycenter(mus, weights, grid, tolerance=1e-11, max_iterations=5000)
    np.testing.assert_allclose(found.density, expected, atol=1e-9)


@pytest.mark.parametrize("shape", [(17, 22), (9, 12, 10)])
def test_a_star_is_a_barycenter(shape):
    mus = np.random.default_rng(4).random((3, *shape)) * (np.random.default_rng(5).random((3, *shape)) > 0.5)
    weights = np.array([0.2, 0.5, 0.3])
    grid = Grid(shape, 1.2)
    found = star(mus, weights, grid, tolerance=1e-10, max_iterations=2000)
    expected = barycenter(mus, weights, grid, tolerance=1e-10, max_iterations=2000)
    np.testing.assert_allclose(found.densities[3], expected.density, atol=1e-8)
    np.testing.assert_allclose(found.densities[:3], mus / mus.mean(axis=tuple(range(1, mus.ndim)), keepdims=True))
    # Only ratios of weights matter.
    scaled = star(mus, 7.0 * weights, grid, tolerance=1e-10, max_iterations=2000)
    np.testing.assert_allclose(scaled.densities, found.densities, atol=1e-9)


def test_a_vertex_between_two_is_their_midpoint():
    mus, grid = uneven(6, 2, (20, 16)), Grid((20, 16), 1.3)
    found = propagate(line(3), 1.0, {0: mus[0], 2: mus[1]}, grid, tolerance=1e-10, max_iterations=2000)
    middle = barycenter(mus, [0.5, 0.5], grid, tolerance=1e-10, max_iterations=2000)
    np.testing.assert_allclose(found.densities[1], middle.density, atol=1e-8)


def test_at_a_leaf_mass_only_spreads():
    """At a leaf, the plan is the kernel, one more blur; an inner vertex is blurred from both sides.

    Between the fixed and the inner vertex, S0 = S1 - 3 sigma^2 + 2 sigma^4 / S1.
    """
    mu = gaussian((90,), [45], 9.0)
    grid = Grid((90,), 1.5)
    one = propagate([(0, 1)], 1.0, {0: mu}, grid, tolerance=1e-10)
    np.testing.assert_allclose(one.densities[1], gaussian((90,), [45], 9.0 + 1.5**2), atol=1e-8)
    two = propagate(line(3), 1.0, {0: mu}, grid, tolerance=1e-10, max_iterations=2000)
    half = 0.5 * (9.0 + 3 * 1.5**2)
    middle = half + np.sqrt(half**2 - 2 * 1.5**4)
    for variance, density in zip((9.0, middle, middle + 1.5**2), two.densities, strict=True):
        np.testing.assert_allclose(density, gaussian((90,), [45], variance), atol=1e-7)


def chain_variances(first, last, weights, sigma):
    """Variances along a chain of Gaussians: each vertex is the plain barycenter of its neighbors."""
    variances = np.linspace(first, last, len(weights) + 1)
    for _ in range(20000):
        before = variances.copy()
        for i in range(1, len(weights)):
            shares = weights[i - 1 : i + 1] / weights[i - 1 : i + 1].sum()
            neighbors = variances[i - 1], variances[i + 1]
            # One fixed-point step of the barycenter, from the vertex's own variance.
            roots = [0.5 * (sigma**2 + np.sqrt(sigma**4 + 4 * variances[i] * n)) for n in neighbors]
            variances[i] = shares @ roots
        if np.abs(variances - before).max() < 1e-13:
            break
    return variances


@pytest.mark.parametrize("count", [2, 3, 5, 8])
def test_chains_of_gaussians(count):
    """Means divide the distance by the inverse weights, variances have the closed form; measured: 4e-6 of the mass."""
    shape, sigma = (120,), 1.5
    weights = np.arange(1.0, count + 1)
    found = propagate(
        line(count + 1),
        weights,
        {0: gaussian(shape, [48], 16.0), count: gaussian(shape, [72], 36.0)},
        Grid(shape, sigma),
        tolerance=1e-6,
    )
    shares = np.concatenate([[0.0], np.cumsum(1 / weights)]) / (1 / weights).sum()
    variances = chain_variances(16.0, 36.0, weights, sigma)
    if count == 2:
        matrices = [np.eye(1) * 16, np.eye(1) * 36]
        assert variances[1] == pytest.approx(barycenter_covariance(matrices, weights / 3, sigma, 0.0)[0, 0])
    for share, variance, density in zip(shares, variances, found.densities, strict=True):
        assert moments(density)[0][0] == pytest.approx(48 + 24 * share, abs=1e-4)
        assert np.abs(density - gaussian(shape, [48 + 24 * share], variance)).mean() < 1e-5


def test_edges_between_fixed_vertices_change_nothing():
    mus, grid = uneven(7, 3, (12, 9)), Grid((12, 9), 1.1)
    edges, weights = [(0, 3), (1, 3), (2, 3)], [1.0, 2.0, 3.0]
    fixed = dict(enumerate(mus))
    plain = propagate(edges, weights, fixed, grid)
    more = propagate([(1, 0), *edges, (1, 2)], [5.0, *weights, 0.1], fixed, grid)
    np.testing.assert_array_equal(more.densities, plain.densities)
    assert more.log_scalings.shape == plain.log_scalings.shape
    assert more.iterations == plain.iterations


def test_a_graph_without_free_vertices_needs_no_sweeps():
    mus, grid = uneven(8, 2, (12, 9)), Grid((12, 9), 1.1)
    found = propagate([(0, 1)], 1.0, dict(enumerate(3 * mus)), grid)
    np.testing.assert_allclose(found.densities, mus)
    assert found.converged.all()
    assert found.marginal_error == 0.0
    assert found.iterations == 1
    np.testing.assert_allclose(found.entropies, [entropy(mu, grid.weights) for mu in mus])


def test_parts_joined_only_by_fixed_vertices_are_independent():
    """Together they take as long as the slower part, and each stops when it would alone."""
    mus, grid = uneven(9, 3, (14, 12)), Grid((14, 12), 1.1)
    one = ([(0, 3), (3, 1)], {0: mus[0], 1: mus[1]})
    other = ([(1, 4), (4, 5), (5, 6), (6, 2)], {1: mus[1], 2: mus[2]})
    together = propagate([*one[0], *other[0]], 1.0, dict(enumerate(mus)), grid, tolerance=1e-6)
    short = propagate([(0, 2), (2, 1)], 1.0, one[1], grid, tolerance=1e-6)
    long = propagate(line(5), 1.0, {0: mus[1], 4: mus[2]}, grid, tolerance=1e-6)
    np.testing.assert_allclose(together.densities[3], short.densities[2], rtol=1e-12)
    np.testing.assert_allclose(together.densities[[4, 5, 6]], long.densities[[1, 2, 3]], rtol=1e-12)
    assert short.iterations < long.iterations == together.iterations
    assert together.converged.all()
    cut = propagate(
        [*one[0], *other[0]], 1.0, dict(enumerate(mus)), grid, tolerance=1e-6, max_iterations=long.iterations - 1
    )
    assert cut.converged.tolist() == [True, True, True, True, False, False, False]


def test_the_order_of_edges_and_their_direction_do_not_matter():
    mus, grid = uneven(10, 2, (11, 9)), Grid((11, 9), 1.1)
    edges, weights, _ = GRAPHS["line of three"]
    options = {"tolerance": 1e-10, "max_iterations": 2000}
    one = propagate(edges, weights, {0: mus[0], 3: mus[1]}, grid, **options)
    other = propagate([e[::-1] for e in edges[::-1]], weights[::-1], {3: mus[1], 0: mus[0]}, grid, **options)
    np.testing.assert_allclose(other.densities, one.densities, atol=1e-8)


def test_the_numbering_of_vertices_does_not_matter():
    mus, grid = uneven(11, 2, (11, 9)), Grid((11, 9), 1.1)
    options = {"tolerance": 1e-10, "max_iterations": 2000}
    one = propagate(line(4), 1.0, {0: mus[0], 3: mus[1]}, grid, **options).densities
    names = np.array([2, 0, 3, 1])
    other = propagate(names[line(4)], 1.0, {2: mus[0], 1: mus[1]}, grid, **options).densities
    np.testing.assert_allclose(other[names], one, atol=1e-8)


def boxes():
    mus = np.zeros((2, 28, 24))
    mus[0, 3:11, 4:18], mus[1, 15:25, 6:14] = 1.0, 1.0
    return mus / mus.mean(axis=(1, 2), keepdims=True), Grid((28, 24), 1.4)


@pytest.mark.parametrize("limit", ["max", -1.9, [9.0, -1.9, -2.0, np.inf, 9.0]])
def test_entropy_limits_hold_vertex_by_vertex(limit):
    mus, grid = boxes()
    fixed = {0: mus[0], 4: mus[1]}
    free = propagate(line(5), 1.0, fixed, grid)
    bounded = propagate(line(5), 1.0, fixed, grid, entropy_limit=limit, max_iterations=2000)
    largest = max(entropy(mu, grid.weights) for mu in mus)
    limits = np.broadcast_to(largest if limit == "max" else limit, 5)[1:4]
    acts = np.isfinite(limits)
    assert (free.entropies[1:4] > limits + 0.01)[acts].all()
    np.testing.assert_allclose(bounded.entropies[1:4][acts], limits[acts], atol=1e-6)
    assert bounded.converged.all()
    assert (bounded.marginal_errors < 1e-2).all()
    np.testing.assert_allclose(bounded.entropies, [entropy(mu, grid.weights) for mu in bounded.densities])
    np.testing.assert_allclose(bounded.densities[[0, 4]], mus)


def test_a_loose_entropy_limit_changes_nothing():
    mus, grid = uneven(12, 2, (15, 13)), Grid((15, 13), 1.1)
    fixed = {0: mus[0], 3: mus[1]}
    options = {"tolerance": 1e-8, "max_iterations": 2000}
    free = propagate(line(4), 1.0, fixed, grid, **options)
    loose = propagate(line(4), 1.0, fixed, grid, entropy_limit=5.0, **options)
    np.testing.assert_allclose(loose.densities, free.densities, atol=1e-6)


def test_starting_from_a_similar_solution_saves_sweeps():
    mus, grid = uneven(13, 2, (20, 18)), Grid((20, 18), 1.2)
    options = {"tolerance": 1e-7, "max_iterations": 2000}
    before = propagate(line(6), 1.0, {0: mus[0], 5: mus[1]}, grid, **options)
    changed = {0: mus[0] + 0.001 * mus[1], 5: mus[1]}
    cold = propagate(line(6), 1.0, changed, grid, **options)
    warm = propagate(line(6), 1.0, changed, grid, initial=before, **options)
    again = propagate(line(6), 1.0, {0: mus[0], 5: mus[1]}, grid, initial=before, **options)
    assert warm.iterations < 0.8 * cold.iterations
    assert again.iterations <= 2
    np.testing.assert_allclose(warm.densities, cold.densities, atol=1e-5)
    np.testing.assert_allclose(again.densities, before.densities, atol=1e-5)


def test_over_relaxation_saves_sweeps_with_the_same_result(monkeypatch):
    mus, grid = uneven(14, 2, (16, 15)), Grid((16, 15), 1.2)
    fixed = {0: mus[0], 10: mus[1]}
    fast = propagate(line(11), 1.0, fixed, grid, tolerance=1e-8, max_iterations=5000)
    monkeypatch.setattr(AdaptiveRelaxation, "learn", lambda self, errors, live: None)
    plain = propagate(line(11), 1.0, fixed, grid, tolerance=1e-8, max_iterations=5000)
    np.testing.assert_allclose(fast.densities, plain.densities, atol=1e-5)
    assert fast.iterations < 0.6 * plain.iterations
    assert plain.converged.all()


@pytest.mark.parametrize("tolerance", [1e-2, 1e-6])
@pytest.mark.parametrize("limit", [None, "max"])
def test_errors_are_those_of_the_plans(tolerance, limit):
    """Recomputed from the scalings with the grid's own kernel."""
    mus, grid = boxes()
    edges = np.array(GRAPHS["cycle and tail"][0])
    found = propagate(
        edges, 1.0, {0: mus[0], 1: mus[1]}, grid, entropy_limit=limit, tolerance=tolerance, max_iterations=1000
    )
    scalings = np.exp(found.log_scalings)
    plans = scalings * grid.apply(scalings[np.arange(12) ^ 1])
    errors = np.abs(plans - found.densities[edges.ravel()]).mean(axis=(1, 2))
    assert found.converged.all()
    assert found.marginal_error < tolerance
    assert errors.max() < 2 * tolerance


def test_scalings_at_free_vertices_have_product_one():
    """prod_e s_e^alpha_e = 1 distinguishes the barycenter of these weights from that of others."""
    mus, grid = uneven(16, 3, (15, 12)), Grid((15, 12), 1.1)
    weights = np.array([0.2, 0.5, 0.3])
    found = star(mus, weights, grid, tolerance=1e-9, max_iterations=2000)
    np.testing.assert_allclose(weights @ found.log_scalings[1::2].reshape(3, -1), 0.0, atol=1e-7)


def test_an_exceeded_iteration_limit_is_reported():
    mus, grid = uneven(17, 2, (12, 9)), Grid((12, 9), 1.1)
    found = propagate(line(4), 1.0, {0: mus[0], 3: mus[1]}, grid, tolerance=1e-12, max_iterations=2)
    assert found.iterations == 2
    assert found.converged.tolist() == [True, False, False, True]
    assert found.marginal_error > 1e-12


def test_far_numerics_take_over():
    shape = (29, 29, 29)
    first = np.zeros(shape)
    first[1:4, 1:4, 1:4] = 1.0
    second = np.roll(first, (24, 24, 24), axis=(0, 1, 2))
    grid = Grid(shape, 0.5)
    found = propagate(line(3), 1.0, {0: first, 2: second}, grid, tolerance=1e-4)
    assert found.numerics == "log domain by line"
    assert found.converged.all()
    np.testing.assert_allclose(moments(found.densities[1])[0], 14.5, atol=1e-6)


def test_a_kernel_that_is_too_narrow_is_refused():
    first, second = np.zeros((2, 200))
    first[2:6], second[190:195] = 1.0, 1.0
    with pytest.raises(KernelTooNarrowError, match="try"):
        propagate(line(3), 1.0, {0: first, 2: second}, Grid((200,), 0.2))


def test_every_sweep_is_reported_and_can_be_cancelled():
    mus, grid = uneven(18, 2, (12, 9)), Grid((12, 9), 1.1)
    control, rounds = Control(), []
    with pytest.raises(Cancelled):
        for report in propagation(line(5), 1.0, {0: mus[0], 4: mus[1]}, grid, tolerance=1e-12, control=control):
            rounds.append(report.payload)
            if len(rounds) == 4:
                control.cancel()
    assert [(done.elements, done.iteration) for done in rounds] == [(108, i) for i in (1, 2, 3, 4)]
    assert all(np.isfinite(done.error) for done in rounds)


def test_a_start_is_copied():
    mus, grid = uneven(19, 2, (12, 9)), Grid((12, 9), 1.1)
    before = propagate(line(3), 1.0, {0: mus[0], 2: mus[1]}, grid)
    kept = before.log_scalings.copy()
    propagate(line(3), 1.0, {0: mus[1], 2: mus[0]}, grid, initial=before)
    np.testing.assert_array_equal(before.log_scalings, kept)
