# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from convwass_addon.transport import Grid
from convwass_addon.transport.checks import (
    check_distribution,
    check_distributions,
    check_entropy_limit,
    check_sharpness,
    check_solver,
    check_weights,
)

GRID = Grid((3, 4), 1.0)
# Five elements of different area in two components; the last one belongs to neither and has no area.
AREAS = np.array([0.1, 0.2, 0.3, 0.4, 0.0])
PIECES = SimpleNamespace(shape=(5,), weights=AREAS, pieces=np.array([0, 0, 1, 1, -1]))


def test_distributions_are_normalized_to_mass_one():
    mus = np.random.default_rng(0).random((2, 3, 4))
    found = check_distributions(7.0 * mus, GRID)
    np.testing.assert_allclose(found.mean(axis=(1, 2)), 1.0, rtol=1e-14)
    np.testing.assert_allclose(found, mus / mus.mean(axis=(1, 2), keepdims=True))
    np.testing.assert_allclose(check_distribution(mus[0], GRID, "mu"), found[0])


@pytest.mark.parametrize("kind", [np.float32, np.int8, bool, np.longdouble])
def test_all_real_numbers_become_float64_in_c_order(kind):
    mus = np.asfortranarray(np.ones((2, 3, 4)).astype(kind))
    for found in (check_distributions(mus, GRID), check_distribution(np.asfortranarray(mus[0]), GRID, "mu")):
        assert found.dtype == np.float64
        assert found.flags.c_contiguous
        assert (found == 1.0).all()


def test_inputs_are_copied():
    mus = np.full((2, 3, 4), 5.0)
    check_distributions(mus, GRID)
    check_distribution(mus[0], GRID, "mu")
    assert (mus == 5.0).all()


def test_lists_are_accepted_like_arrays():
    np.testing.assert_array_equal(check_distributions([[1, 3], [2, 2]], Grid((2,), 1.0)), [[0.5, 1.5], [1.0, 1.0]])


@pytest.mark.parametrize("scale", [1e-300, 1e300])
def test_any_total_mass_is_accepted(scale):
    np.testing.assert_allclose(check_distribution(np.full((3, 4), scale), GRID, "mu"), 1.0)


@pytest.mark.parametrize(
    ("mu", "wrong"),
    [
        (np.ones((4, 3)), r"mu0 must have the shape \(3, 4\), got \(4, 3\)"),
        (np.ones((1, 3, 4)), r"mu0 must have the shape \(3, 4\), got \(1, 3, 4\)"),
        (np.ones(12), r"mu0 must have the shape \(3, 4\), got \(12,\)"),
        (np.full((3, 4), np.nan), "mu0 has values that are not numbers"),
        (np.where(np.eye(3, 4), np.inf, 1.0), "mu0 has values that are not numbers"),
        (1.0 - 2.0 * np.eye(3, 4), "mu0 has negative values; a distribution must not"),
        (np.zeros((3, 4)), "mu0 has no mass"),
        (np.full((3, 4), 1e308), "mu0 has more mass than float64 can express"),
    ],
)
def test_invalid_distributions_are_named(mu, wrong):
    with pytest.raises(ValueError, match=f"^{wrong}$"):
        check_distribution(mu, GRID, "mu0")


@pytest.mark.parametrize(
    ("mus", "wrong"),
    [
        (np.ones((3, 4)), r"mus must have the shape \(k, 3, 4\), got \(3, 4\)"),
        (np.ones((0, 3, 4)), r"mus must have the shape \(k, 3, 4\), got \(0, 3, 4\)"),
        (np.ones((2, 4, 3)), r"mus must have the shape \(k, 3, 4\), got \(2, 4, 3\)"),
        (np.stack([np.ones((3, 4)), np.zeros((3, 4))]), r"mus\[1\] has no mass"),
        (np.stack([-np.ones((3, 4)), np.zeros((3, 4))]), r"mus\[0\] has negative values; a distribution must not"),
    ],
)
def test_the_invalid_distribution_among_several_is_named(mus, wrong):
    with pytest.raises(ValueError, match=f"^{wrong}$"):
        check_distributions(mus, GRID)


def test_elements_without_area_hold_no_mass():
    domain = SimpleNamespace(shape=(5,), weights=AREAS, pieces=None)
    for value in (1.0, 1e9):
        found = check_distribution([1.0, 1.0, 1.0, 1.0, value], domain, "mu")
        np.testing.assert_allclose(found, [1.0, 1.0, 1.0, 1.0, 0.0])
        np.testing.assert_array_equal(check_distributions([[1.0, 1.0, 1.0, 1.0, value]], domain)[0], found)
    with pytest.raises(ValueError, match="has no mass"):
        check_distribution([0.0, 0.0, 0.0, 0.0, 1.0], domain, "mu")


def test_masses_have_to_agree_per_component():
    """Areas times densities: 0.3 and 0.7 of the mass; rounding errors are tolerated, larger differences are not."""
    even = np.ones(5)
    moved = np.array([3.0, 0.0, 0.0, 7.0 / 4.0, 0.0])
    np.testing.assert_allclose(check_distributions([even, moved], PIECES)[1], moved)
    check_distributions([even, moved + 1e-7 * np.eye(5)[0]], PIECES)
    assert len(check_distributions([[1.0, 0.0, 0.0, 0.0, 0.0]], PIECES)) == 1
    wrong = (
        r"(mus\[1\] has mass 0\.2 and mus\[0\] 0\.3 on the piece of 2 vertices around vertex 0|"
        r"mus\[0\] has mass 0\.7 and mus\[1\] 0\.8 on the piece of 2 vertices around vertex 2); "
        r"mass cannot cross from one connected piece to another"
    )
    with pytest.raises(ValueError, match=wrong):
        check_distributions([even, [2.0, 0.0, 0.0, 2.0, 0.0]], PIECES)


@pytest.mark.parametrize("weights", [[1, 3], np.array([0.25, 0.75]), [1e-200, 3e-200]])
def test_weights_are_normalized_to_sum_one(weights):
    np.testing.assert_allclose(check_weights(weights, 2), [0.25, 0.75])


@pytest.mark.parametrize(
    ("weights", "wrong"),
    [
        ([1.0], r"weights must be 2 numbers, one per distribution, got shape \(1,\)"),
        ([[1.0, 1.0]], r"weights must be 2 numbers, one per distribution, got shape \(1, 2\)"),
        (1.0, r"weights must be 2 numbers, one per distribution, got shape \(\)"),
        ([1.0, -0.5], r"weights must be zero or positive numbers, got \[1.0, -0.5\]"),
        ([1.0, np.nan], r"weights must be zero or positive numbers, got \[1.0, nan\]"),
        ([np.inf, 1.0], r"weights must be zero or positive numbers, got \[inf, 1.0\]"),
        ([0.0, 0.0], "weights must not all be zero"),
        ([1e308, 1e308], r"weights must have a finite sum, got \[1e\+308, 1e\+308\]"),
    ],
)
def test_invalid_weights_are_refused(weights, wrong):
    with pytest.raises(ValueError, match=f"^{wrong}$"):
        check_weights(weights, 2)


@pytest.mark.parametrize("tolerance", [0.0, -1e-9, np.nan])
def test_invalid_tolerances_are_refused(tolerance):
    with pytest.raises(ValueError, match=f"^tolerance must be positive, got {tolerance}$"):
        check_solver(tolerance, 1)


@pytest.mark.parametrize("rounds", [0, -3])
def test_iteration_limits_below_one_are_refused(rounds):
    with pytest.raises(ValueError, match=f"^max_iterations must be at least 1, got {rounds}$"):
        check_solver(1e-3, rounds)
    check_solver(1e-300, 1)


@pytest.mark.parametrize("sharpness", [-1e-9, 1.0 + 1e-9, np.nan, np.inf])
def test_sharpness_outside_its_range_is_refused(sharpness):
    with pytest.raises(ValueError, match=f"^sharpness must lie between 0 and 1, got {sharpness}$"):
        check_sharpness(sharpness)
    for allowed in (0, 0.3, 1):
        check_sharpness(allowed)


@pytest.mark.parametrize("limit", ["maximum", "", np.nan, [0.0, 1.0]])
def test_invalid_entropy_limits_are_refused(limit):
    with pytest.raises(ValueError, match=r'^entropy_limit must be "max", a number or None, got '):
        check_entropy_limit(limit)
    for allowed in (None, "max", -3, 0.0, np.float64(2.5), np.inf):
        check_entropy_limit(allowed)
