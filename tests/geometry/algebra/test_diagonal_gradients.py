# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Conjugate gradients with the diagonal as preconditioner."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import csr_array, diags_array

from convwass_addon.errors import Cancelled
from convwass_addon.geometry.algebra.diagonal_gradients import solved_by_gradients
from convwass_addon.geometry.meshes.edge_laplacian import edge_laplacian
from convwass_addon.progress import UNINTERRUPTED, Control
from tests.shapes import ball


@pytest.fixture(scope="module")
def system():
    mesh, rng = ball(points=500), np.random.default_rng(7)
    laplacian = edge_laplacian(mesh.faces, np.ones(len(mesh.vertices)))
    return csr_array(laplacian + diags_array(rng.uniform(0.01, 1.0, 500))), rng.normal(size=(500, 3))


def test_the_solution_is_that_of_elimination(system):
    matrix, right = system
    right[:, 1] = 0.0
    found = solved_by_gradients(matrix, right, 200, UNINTERRUPTED)
    np.testing.assert_allclose(found, np.linalg.solve(matrix.toarray(), right), rtol=1e-10, atol=1e-11)


def test_too_few_iterations_give_no_solution(system):
    assert solved_by_gradients(*system, 3, UNINTERRUPTED) is None


def test_it_can_be_cancelled(system):
    control = Control()
    control.cancel()
    with pytest.raises(Cancelled):
        solved_by_gradients(*system, 200, control)
