# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import csc_array, diags_array
from scipy.sparse.linalg import spsolve

from convwass_addon.geometry.algebra import kept_factor
from convwass_addon.geometry.algebra.kept_factor import KeptFactor
from convwass_addon.geometry.deformation.unit_shape import UnitShape
from tests.shapes import ball

RANDOM = np.random.default_rng(4)


@pytest.fixture(scope="module")
def stiffness():
    return UnitShape.of(ball(points=300)).laplacian.matrix


@pytest.fixture
def factorizations(monkeypatch):
    """Count the factorizations."""
    counted = []
    original = kept_factor.factorize
    monkeypatch.setattr(kept_factor, "factorize", lambda matrix: (counted.append(matrix), original(matrix))[1])
    return counted


def with_diagonal(stiffness, values):
    return csc_array(stiffness + diags_array(values))


def test_slightly_changed_systems_reuse_the_factorization(stiffness, factorizations):
    count = stiffness.shape[0]
    solver, held, right = KeptFactor(), RANDOM.uniform(0.5, 1.0, count), RANDOM.normal(size=(count, 3))
    for _ in range(4):
        matrix = with_diagonal(stiffness, held)
        exact = np.stack([spsolve(matrix, column) for column in right.T], axis=1)
        found = solver.solve(matrix, right, np.zeros((count, 3)))
        assert np.linalg.norm(found - exact) < 1e-4 * np.linalg.norm(exact)
        held = held * RANDOM.uniform(0.8, 1.25, count)
    assert len(factorizations) == 1


def test_strongly_changed_systems_are_factorized_again(stiffness, factorizations):
    count = stiffness.shape[0]
    solver, right = KeptFactor(), RANDOM.normal(size=(count, 2))
    for held in (np.full(count, 1e-3), 10.0 ** RANDOM.uniform(-3.0, 5.0, count)):
        matrix = with_diagonal(stiffness, held)
        exact = np.stack([spsolve(matrix, column) for column in right.T], axis=1)
        np.testing.assert_allclose(solver.solve(matrix, right, np.zeros((count, 2))), exact, atol=1e-7)
    assert len(factorizations) == 2


def test_an_exact_start_is_returned_unchanged(stiffness, factorizations):
    count = stiffness.shape[0]
    matrix, exact = with_diagonal(stiffness, np.ones(count)), RANDOM.normal(size=(count, 3))
    solver = KeptFactor()
    for start in (np.zeros((count, 3)), exact):
        np.testing.assert_allclose(solver.solve(matrix, matrix @ exact, start), exact, atol=1e-9)
    assert len(factorizations) == 1
