# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Every solver on any grid, densities and kernel: correct results and errors, or a helpful exception."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import assume, given, reject, settings, strategies as st

from convwass_addon.transport import (
    Grid,
    KernelTooNarrowError,
    barycenter,
    barycentric_coordinates,
    bisect,
    distance,
    distance_matrix,
    interpolate,
    nearest_barycenter,
    propagate,
    transport_map,
)
from convwass_addon.transport.log_range import LOG_NOTHING

MANY = settings(max_examples=12, deadline=None, derandomize=True)
SOME = settings(MANY, max_examples=6)
LARGEST_SIZE = {1: 40, 2: 18, 3: 8}


@dataclass(frozen=True)
class Problem:
    """A grid, three densities with holes, weights, tolerance and iteration limit."""

    grid: Grid
    mus: np.ndarray
    weights: np.ndarray
    tolerance: float
    rounds: int

    @property
    def limits(self):
        return {"tolerance": self.tolerance, "max_iterations": self.rounds}

    def normalized(self):
        return self.mus / self.mus.mean(axis=tuple(range(1, self.mus.ndim)), keepdims=True)


@st.composite
def problems(draw, sigmas=(0.03, 30.0), tolerances=(1e-9, 1e-2), rounds=(1, 2, 5, 60)):
    """Sigma from 0.03 to 30 cells: six decades of gamma."""
    dimensions = draw(st.integers(1, 3))
    sizes = st.integers(1, LARGEST_SIZE[dimensions])
    shape = draw(
        st.one_of(st.lists(sizes, min_size=dimensions, max_size=dimensions), st.just([16] * min(dimensions, 2)))
    )
    sigma = 10 ** draw(st.floats(*np.log10(sigmas)))
    grid = Grid(shape, sigma, draw(st.sampled_from(["open", "reflecting"])))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    mus = rng.random((3, *shape)) ** rng.integers(1, 6) * (rng.random((3, *shape)) >= draw(st.floats(0.0, 0.98)))
    for mu in mus:
        mu.flat[rng.integers(mu.size)] += 0.1
    weights = rng.random(3) * (rng.random(3) > 0.3)
    weights[rng.integers(3)] += 0.1
    return Problem(grid, mus, weights, 10 ** draw(st.floats(*np.log10(tolerances))), draw(st.sampled_from(rounds)))


def solvable():
    """Problems that mostly converge."""
    return problems(sigmas=(2.0, 30.0), tolerances=(1e-3, 1e-2), rounds=(200,))


def kernel(grid, logs):
    """log H (a exp(column)) of every column, using the grid's kernel with the largest reach."""
    found = np.empty_like(logs)
    grid.log_apply_far(np.ascontiguousarray(logs), found)
    return found


def misses(logs, densities):
    """Sum of a |exp(column) - density| for every column."""
    return np.abs(np.exp(np.minimum(logs, 50.0)) - densities).reshape(len(logs), -1).mean(axis=1)


def answer(solve, *arguments, **options):
    """Return the result of `solve`; discard examples whose kernel is too narrow and whose error suggests another gamma.

    Hypothesis complains if too few examples remain.
    """
    try:
        return solve(*arguments, **options)
    except KernelTooNarrowError as error:
        assert "too small" in str(error)
        assert "try" in str(error)
        reject()


def assert_densities(densities):
    assert np.isfinite(densities).all()
    assert (densities >= 0).all()
    np.testing.assert_allclose(densities.reshape(len(densities), -1).mean(axis=1), 1.0, rtol=1e-9)


@MANY
@given(problems())
def test_distances(problem):
    found = answer(distance, problem.mus[0], problem.mus[1], problem.grid, **problem.limits)
    assert np.isfinite([found.value, found.entropic_value, found.divergence, found.marginal_error, found.length]).all()
    assert np.isfinite([found.log_v, found.log_w, found.v, found.w]).all()
    assert found.converged == (found.marginal_error < problem.tolerance)


@SOME
@given(solvable())
def test_scalings_of_distances_have_the_marginals(problem):
    mu, nu = problem.normalized()[:2]
    found = answer(distance, problem.mus[0], problem.mus[1], problem.grid, **problem.limits)
    assume(found.converged)
    log_v, log_w = found.log_v[None], found.log_w[None]
    assert misses(np.where(mu > 0, log_v + kernel(problem.grid, log_w), LOG_NOTHING), mu[None]) < 1e-6
    error = misses(np.where(nu > 0, log_w + kernel(problem.grid, log_v), LOG_NOTHING), nu[None])
    assert error < 2 * problem.tolerance + 1e-9
    assert np.isfinite(transport_map(found.log_w, problem.grid)).all()


@MANY
@given(problems())
def test_distance_matrices(problem):
    found = answer(distance_matrix, problem.mus, problem.grid, **problem.limits)
    assert np.isfinite(found.values).all()
    np.testing.assert_array_equal(found.values, found.values.T)
    assert found.converged == (found.marginal_error < problem.tolerance)


@MANY
@given(problems(), st.sampled_from([0.0, 0.5, 1.0]), st.sampled_from([None, "max", -1.0]))
def test_barycenters(problem, sharpness, limit):
    found = barycenter(
        problem.mus,
        problem.weights,
        problem.grid,
        sharpness=sharpness,
        entropy_limit=limit,
        **problem.limits,
    )
    assert_densities(found.density[None])
    assert np.isfinite([found.marginal_error, found.mass_error, found.invariant_error, found.entropy]).all()
    # The error of d is known after the second round.
    assert np.isfinite(found.debias_error) or found.iterations[-1] == 1
    # The last step of d, which an entropy bound excludes, removes about half of its error.
    left = 1.0 if limit is not None else max(0.5, 2.0 * sharpness - 1.0)
    assert found.converged == (max(found.marginal_error, left * found.debias_error) < problem.tolerance)


@SOME
@given(solvable(), st.sampled_from([0.0, 0.5, 1.0]), st.sampled_from([None, "max", -1.0]))
def test_scalings_of_barycenters_have_the_marginals(problem, sharpness, limit):
    options = {"sharpness": sharpness, "entropy_limit": limit, **problem.limits}
    found = barycenter(problem.mus, problem.weights, problem.grid, **options)
    # Beyond 36 sigma the kernel has no entries, and results near the limits of float64 may lack their largest term.
    assume(found.converged and max(problem.grid.shape) <= 36 * problem.grid.sigma)
    last = found.levels[-1]
    log_v = last.region.scatter(last.log_v, LOG_NOTHING)
    mus = problem.normalized()[found.active]
    log_mus = np.log(mus, out=np.full_like(mus, LOG_NOTHING), where=mus > 0)
    log_w = np.where(mus > 0, log_mus - kernel(problem.grid, log_v), LOG_NOTHING)
    assert misses(log_v + kernel(problem.grid, log_w), found.density[None]).max() < 3 * problem.tolerance + 1e-9


EDGES = np.array([(0, 3), (1, 3), (3, 4), (4, 2), (4, 5)])


@MANY
@given(problems(), st.sampled_from([None, "max", -1.0]))
def test_propagations(problem, limit):
    given_ones = dict(enumerate(problem.mus))
    found = answer(propagate, EDGES, 1.0, given_ones, problem.grid, entropy_limit=limit, **problem.limits)
    assert_densities(found.densities)
    assert np.isfinite(found.marginal_errors).all()
    assert np.isfinite(found.entropies).all()
    assert np.isfinite(found.log_scalings).all()


@settings(SOME, max_examples=5)
@given(solvable(), st.sampled_from([None, "max"]))
def test_scalings_of_propagations_have_the_marginals(problem, limit):
    given_ones = dict(enumerate(problem.mus))
    found = answer(propagate, EDGES, 1.0, given_ones, problem.grid, entropy_limit=limit, **problem.limits)
    assume(found.converged.all())
    across = kernel(problem.grid, found.log_scalings[np.arange(10) ^ 1])
    errors = misses(found.log_scalings + across, found.densities[EDGES.ravel()])
    assert errors.max() < 3 * problem.tolerance + 1e-9


@MANY
@given(problems(), st.lists(st.floats(0.0, 1.0), min_size=1, max_size=3))
def test_bisections(problem, times):
    found = answer(bisect, *problem.mus[:2], problem.grid, levels=2, times=times, **problem.limits)
    assert_densities(found.densities)
    assert np.isfinite(found.marginal_errors).all()
    np.testing.assert_array_equal(found.times, times)
    ends = problem.normalized()[:2]
    for t, density in zip(times, found.densities, strict=True):
        if t in (0.0, 1.0):
            np.testing.assert_allclose(density, ends[int(t)], rtol=1e-12)


@MANY
@given(problems(), st.sampled_from([0.0, 0.5, 1.0]), st.lists(st.floats(0.0, 1.0), min_size=1, max_size=3))
def test_interpolations(problem, sharpness, times):
    found = interpolate(*problem.mus[:2], times, problem.grid, sharpness=sharpness, **problem.limits)
    assert_densities(found.densities)
    assert (found.converged <= (found.marginal_errors < problem.tolerance)).all()


@MANY
@given(problems(), st.sampled_from([0.0, 0.5, 1.0]))
def test_coordinates(problem, sharpness):
    found = answer(
        barycentric_coordinates, problem.mus[0], problem.mus[1:], problem.grid, sharpness=sharpness, **problem.limits
    )
    assert (found.weights >= 0).all()
    assert found.weights.sum() == pytest.approx(1.0)
    assert np.isfinite([found.residual, found.marginal_error]).all()


@settings(max_examples=8, deadline=None, derandomize=True)
@given(problems())
def test_nearest_barycenters(problem):
    found = answer(
        nearest_barycenter,
        problem.mus[0],
        problem.mus[1:],
        problem.grid,
        tolerance=max(problem.tolerance, 1e-3),
        max_iterations=problem.rounds,
        max_evaluations=2,
    )
    assert (found.weights >= 0).all()
    assert found.weights.sum() == pytest.approx(1.0)
    assert np.isfinite(found.distance.value)
    assert_densities(found.barycenter.density[None])


@pytest.mark.parametrize(
    ("shape", "sigma"), [((1,), 0.3), ((1, 1), 1.0), ((1, 1, 1), 20.0), ((1, 7), 1.0), ((1, 5), 0.3), ((4, 1, 3), 5.0)]
)
def test_axes_of_one_cell(shape, sigma):
    """They have no effect: the results in cells are the same as without them."""
    rng = np.random.default_rng(0)
    mus = rng.random((2, *shape)) + 0.1
    grid = Grid(shape, sigma)
    flat_shape = tuple(n for n in shape if n > 1) or (1,)
    flat, flat_grid = mus.reshape(2, *flat_shape), Grid(flat_shape, sigma)
    one, other = distance(*mus, grid, tolerance=1e-9), distance(*flat, flat_grid, tolerance=1e-9)
    assert one.value == pytest.approx(other.value, abs=1e-9)
    blend, flat_blend = barycenter(mus, [0.3, 0.7], grid), barycenter(flat, [0.3, 0.7], flat_grid)
    np.testing.assert_allclose(blend.density.reshape(flat_shape), flat_blend.density, rtol=1e-9)
    line = propagate([[0, 1], [1, 2]], 1.0, {0: mus[0], 2: mus[1]}, grid)
    assert_densities(line.densities)
    assert_densities(bisect(*mus, grid, levels=2).densities)
