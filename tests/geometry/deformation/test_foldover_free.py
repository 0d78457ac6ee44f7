# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Deformed planar triangles: similarities are exact, and nothing folds where a harmonic map does."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import check_grad

from convwass_addon.geometry.deformation import foldover_free as module
from convwass_addon.geometry.deformation.foldover_free import foldover_free
from convwass_addon.geometry.meshes.edges import edge_ends, edge_use
from convwass_addon.geometry.meshes.mesh import TriangleMesh, joined_meshes
from convwass_addon.geometry.plane.planar_fill import filled_boundary
from convwass_addon.geometry.remeshing.planar_mesh import planar_mesh, without_bridges
from tests.flat_shapes import ellipse

RANDOM = np.random.default_rng(3)


def rim_of(mesh):
    use = edge_use(mesh.faces)
    held = np.zeros(len(mesh.vertices), bool)
    held[edge_ends(mesh.faces, use)[use.count == 1]] = True
    return held


def signed_areas(points, faces):
    first, second = points[faces[:, 1]] - points[faces[:, 0]], points[faces[:, 2]] - points[faces[:, 0]]
    return 0.5 * (first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0])


@pytest.fixture(scope="module")
def disc():
    return without_bridges(planar_mesh(filled_boundary([ellipse()], "non-zero"), 0.15))


def test_the_inside_follows_a_similarity_of_the_outline_exactly(disc):
    held, rest = rim_of(disc), disc.vertices[:, :2]
    expected = 1.7 * rest @ np.array([[0.6, 0.8], [-0.8, 0.6]]) + (3.0, -1.0)
    start = np.where(held[:, None], expected, expected + RANDOM.normal(0.0, 0.3, rest.shape))
    assert (signed_areas(start, disc.faces) < 0).any()
    found = foldover_free(disc, start, held).points
    assert found == pytest.approx(expected, abs=0.005)
    assert (found[held] == expected[held]).all()


def test_nothing_folds_in_a_bent_outline(disc):
    """The inside of the horseshoe is not convex, so that the harmonic map leaves it."""
    held, rest = rim_of(disc), disc.vertices[:, :2]
    angle, radius = 2.4 * rest[:, 0], 1.0 + 0.35 * rest[:, 1]
    target = np.stack([radius * np.sin(angle), radius * np.cos(angle)], axis=1)
    start = np.where(held[:, None], target, target[held].mean(axis=0))
    found = foldover_free(disc, start, held).points
    assert (signed_areas(found, disc.faces) > 0).all()
    assert (np.abs(np.linalg.norm(found, axis=1) - 1.0) < 0.36).all()


@pytest.mark.parametrize("factor", [2.0**-20, 2.0**10])
def test_the_scale_does_not_matter(disc, factor):
    """Powers of two are exact; rounding would change where the minimizer stops."""
    held, rest = rim_of(disc), disc.vertices[:, :2]
    bent = rest + 0.4 * np.square(rest)[:, ::-1]
    start = np.where(held[:, None], bent, 0.5 * bent)
    expected = foldover_free(disc, start, held)
    found = foldover_free(TriangleMesh(factor * disc.vertices, disc.faces), factor * start, held)
    assert found.points == pytest.approx(factor * expected.points, rel=1e-9, abs=1e-9 * factor)
    assert found.distortion == pytest.approx(expected.distortion)


@pytest.mark.parametrize("width", [1e-6, 0.3])
def test_the_gradient_of_the_energy_is_that_of_finite_differences(disc, width):
    rest = disc.vertices[:, :2]
    energy = module._Energy.of(disc, rest)
    scale = 0.02 if width < 0.1 else 0.3
    points = rest + RANDOM.normal(0.0, scale, rest.shape)
    error = check_grad(
        lambda x: energy.at(x.reshape(-1, 2), width)[0],
        lambda x: energy.at(x.reshape(-1, 2), width)[1].ravel(),
        points.ravel(),
    )
    assert error < 1e-4 * np.linalg.norm(energy.at(points, width)[1])


def energies(rest, after):
    """The energy of one triangle and another at the same area as all of both."""
    sides = [np.stack([points[1:3] - points[0], points[2:4] - points[0]]) for points in (rest, after)]
    scale = np.sqrt(np.linalg.det(sides[1]).sum() / np.linalg.det(sides[0]).sum())
    jacobians = np.linalg.solve(scale * sides[0], sides[1])
    areas, squares = np.linalg.det(jacobians), np.square(jacobians).sum(axis=(1, 2))
    return (squares + 0.5 * (np.square(areas) + 1.0)) / areas


SQUARE = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
HALVES = TriangleMesh(np.column_stack([SQUARE, np.zeros(4)]), np.array([(0, 1, 2), (0, 2, 3)]))


def test_the_distortion_is_the_mean_energy():
    after = np.array([(0.0, 0.0), (1.5, 0.0), (1.0, 1.0), (0.4, 0.6)])
    found = foldover_free(HALVES, after, np.ones(4, bool))
    expected = energies(SQUARE, after)
    assert expected.max() > 1.5 * expected.min()
    assert found.distortion == pytest.approx(expected.mean())
    # Half of the area is turned over.
    turned = foldover_free(HALVES, np.array([(0.0, 0.0), (0.3, 0.9), (1.0, 1.0), (0.0, 9.0)]), np.ones(4, bool))
    assert turned.distortion > 50.0


@pytest.mark.parametrize("width", [1e-3, 0.3])
def test_the_energy_of_reflected_triangles_is_that_of_the_formula(disc, width):
    reflected = disc.vertices[:, :2] * (1.0, -1.0)
    # The determinant is -1 everywhere, and the matrices have two entries of 1.
    expected = (2.0 + 0.5 * 2.0) / (0.5 * width**2 / (1.0 + np.sqrt(1.0 + width**2)))
    assert module._Energy.of(disc, disc.vertices[:, :2]).at(reflected, width)[0] == pytest.approx(expected)


def test_held_vertices_may_be_all(disc):
    rest = disc.vertices[:, :2]
    assert (foldover_free(disc, 2.0 * rest, np.ones(len(rest), bool)).points == 2.0 * rest).all()


def test_components_are_deformed_as_each_alone(disc):
    """Also if one of them grows from a point."""
    both = joined_meshes([disc, disc.moved((3.0, 0.0, 0.0))])
    held, rest = rim_of(disc), disc.vertices[:, :2]
    bent = rest + 0.2 * np.square(rest)[:, ::-1]
    grown = 200.0 * rest @ np.diag([1.0, 0.5])
    starts = [np.where(held[:, None], bent, 0.5 * bent), grown]
    found = foldover_free(both, np.concatenate(starts), np.tile(held, 2))
    alone = [foldover_free(disc, start, held) for start in starts]
    assert found.distortion == pytest.approx(np.mean([own.distortion for own in alone]))
    assert found.distortion < 3.4
    for points, own in zip(np.split(found.points, 2), alone, strict=True):
        assert points == pytest.approx(own.points, rel=1e-6, abs=1e-6)
