# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes reconstructed from known deformation gradients."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from convwass_addon.geometry.deformation.poisson_deformation import (
    Links,
    PoissonDeformation,
    deformation_gradients,
    logarithmic_stretches,
    stretches_of,
)
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from tests.grids import sheet
from tests.shapes import ball, box, joined, torus

AFFINE = np.array([[1.2, 0.3, -0.1], [0.0, 0.8, 0.5], [0.4, -0.2, 1.5]])
NOTHING = np.empty((0, 3))


TWO = joined(ball(points=40), box(center=(3.0, 0.0, 0.0)))


@pytest.mark.parametrize("mesh", [ball(points=300), torus(), sheet(7, 5), TWO])
def test_affine_maps_are_reconstructed(mesh):
    moved = mesh.vertices @ AFFINE.T + (1.0, -2.0, 3.0)
    gradients = np.tile(AFFINE, (len(mesh.faces), 1, 1))
    found = PoissonDeformation(mesh, Links.none()).solve(gradients, NOTHING, moved)
    np.testing.assert_allclose(found, moved, atol=1e-8)


def test_anchors_fix_only_the_translation():
    mesh = ball(points=300)
    turn = Rotation.from_rotvec((0.0, 0.0, 1.0)).as_matrix()
    gradients = np.tile(turn, (len(mesh.faces), 1, 1))
    found = PoissonDeformation(mesh, Links.none()).solve(gradients, NOTHING, mesh.vertices + 5.0)
    np.testing.assert_allclose(found, mesh.vertices @ turn.T + 5.0, atol=1e-3)


def test_gradients_of_a_turned_and_stretched_mesh():
    mesh = ball(points=100)
    turn = Rotation.from_rotvec((0.3, 1.0, -0.4)).as_matrix()
    found = deformation_gradients(mesh.vertices, 2.0 * mesh.vertices @ turn.T, mesh.faces)
    np.testing.assert_allclose(found, np.tile(2.0 * turn, (len(mesh.faces), 1, 1)), atol=1e-9)


@pytest.mark.parametrize("stretches", [(1.0, 3.0), (0.2, 2.0), (0.5, 0.25), (1.0, 1.0), (0.0, 1.0)])
def test_the_largest_stretch_counts_in_either_direction(stretches):
    mesh = sheet(7, 5)
    turn = Rotation.from_rotvec((0.3, 1.0, -0.4)).as_matrix()
    gradients = deformation_gradients(mesh.vertices, mesh.vertices * (*stretches, 1.0) @ turn.T, mesh.faces)
    expected = np.abs(np.log(np.maximum(stretches, 1e-6))).max()
    np.testing.assert_allclose(logarithmic_stretches(gradients), expected, atol=1e-9)


def test_the_stretch_of_a_mesh_does_not_count_its_scaling():
    """One side three times and the other a third as long is a stretch by three, whatever the scale."""
    mesh = sheet(7, 5)
    for scale in (1.0, 4.0):
        found = stretches_of(mesh, scale * mesh.vertices * (3.0, 1.0 / 3.0, 1.0))
        np.testing.assert_allclose(found, np.log(3.0), atol=1e-9)


def test_any_deformation_is_reconstructed_from_its_gradients():
    mesh = ball(points=300)
    moved = mesh.vertices + 0.2 * np.sin(3.0 * mesh.vertices[:, [1, 2, 0]])
    gradients = deformation_gradients(mesh.vertices, moved, mesh.faces)
    found = PoissonDeformation(mesh, Links.none()).solve(gradients, NOTHING, moved)
    np.testing.assert_allclose(found, moved, atol=1e-10)


def test_triangles_without_area_have_no_gradient():
    points = [(0, 0, 0), (1, 0, 0), (2, 0, 0), (0, 1, 0)]
    mesh = TriangleMesh.from_arrays(points, [(0, 1, 2), (0, 1, 3), (0, 0, 1)])
    found = deformation_gradients(mesh.vertices, 3.0 * mesh.vertices, mesh.faces)
    np.testing.assert_allclose(found, [np.eye(3), 3 * np.eye(3), np.eye(3)], atol=1e-12)
    solved = PoissonDeformation(mesh, Links.none()).solve(found, NOTHING, 3.0 * mesh.vertices)
    assert np.isfinite(solved).all()


def test_links_keep_components_together():
    mesh = joined(ball(points=60), ball(0.2, (0.0, 1.3, 0.0), points=40))
    links = Links(np.array([[60, 0], [70, 3]]), np.array([0.5, 0.5]), np.zeros(2, bool))
    turn = Rotation.from_rotvec((0.0, 0.0, np.pi / 2)).as_matrix()
    gradients = np.tile(turn, (len(mesh.faces), 1, 1))
    rest = mesh.vertices[links.ends[:, 0]] - mesh.vertices[links.ends[:, 1]]
    # With anchors alone, the small ball would stay in place.
    poisson = PoissonDeformation(mesh, links)
    found = poisson.solve(gradients, rest @ turn.T, mesh.vertices)
    moved = found - mesh.vertices @ turn.T
    np.testing.assert_allclose(moved, np.broadcast_to(moved[0], moved.shape), atol=2e-3)


def test_it_can_be_pickled():
    mesh = ball(points=60)
    poisson = PoissonDeformation(mesh, Links.none())
    gradients = np.tile(AFFINE, (len(mesh.faces), 1, 1))
    first = poisson.solve(gradients, NOTHING, mesh.vertices)
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(poisson)).solve(gradients, NOTHING, mesh.vertices), first)
