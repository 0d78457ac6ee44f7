# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.deformation.edge_energy import EdgeEnergy
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from tests.applications.maps import turn
from tests.shapes import ball, box, torus


@pytest.mark.parametrize("mesh", [box((1, 2, 3)), ball(points=200), torus(segments=(12, 8))])
def test_a_global_linear_map_is_exact(mesh):
    """L x = pulls for x = G v, with any weights of the triangles."""
    matrix = np.diag([1.0, 2.0, 0.5]) @ turn()
    energy = EdgeEnergy.of(mesh)
    pulls = energy.pulls(np.broadcast_to(matrix, (len(mesh.faces), 3, 3)))
    np.testing.assert_allclose(energy.stiffness @ (mesh.vertices @ matrix.T), pulls, atol=1e-12)


def test_the_matrix_is_that_of_the_energy():
    mesh = ball(points=60)
    rng = np.random.default_rng(0)
    gradients, x = rng.normal(size=(len(mesh.faces), 3, 3)), rng.normal(size=mesh.vertices.shape)
    energy = EdgeEnergy.of(mesh)

    def total(positions):
        value = 0.0
        for face, corners in enumerate(mesh.faces):
            for place in range(3):
                i, j = corners[(place + 1) % 3], corners[(place + 2) % 3]
                wanted = gradients[face] @ (mesh.vertices[i] - mesh.vertices[j])
                value += energy.weights[face, place] * np.square(positions[i] - positions[j] - wanted).sum()
        return value

    slope = 2.0 * (energy.stiffness @ x - energy.pulls(gradients))
    step = rng.normal(size=x.shape)
    # The energy is quadratic, so the central difference is exact.
    assert (total(x + step) - total(x - step)) / 2.0 == pytest.approx((slope * step).sum(), rel=1e-9)


def test_all_weights_are_positive():
    needle = TriangleMesh.from_arrays([(0, 0, 0), (1, 0, 0), (0.5, 1e-9, 0), (2, 2, 2)], [(0, 1, 2), (0, 0, 1)])
    energy = EdgeEnergy.of(needle)
    assert (energy.weights > 0).all() and np.isfinite(energy.weights).all()
    matrix = energy.stiffness.toarray()
    assert (matrix - np.diag(np.diag(matrix)) <= 0).all()
    np.testing.assert_allclose(matrix.sum(axis=0), 0.0, atol=1e-12)
    assert not matrix[3].any()
