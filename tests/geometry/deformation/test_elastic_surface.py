# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces that resist bending and shearing, and either spread strain or concentrate it in joints."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.deformation.unit_shape import UnitShape
from tests.grids import figure, sheet
from tests.shapes import ball, box, joined

WIDTH = 0.04


@pytest.fixture(scope="module")
def strip():
    """A flat strip along x, three times as long as wide."""
    mesh = sheet(31, 11)
    shape = UnitShape.of(type(mesh)(mesh.vertices * (3.0, 1.0, 1.0), mesh.faces))
    return shape, shape.elastic


def test_without_give_it_equals_uniform_springs():
    shape = UnitShape.of(figure()[0])
    surface = shape.elastic
    rng = np.random.default_rng(0)
    points = shape.vertices + 0.02 * rng.normal(size=shape.vertices.shape)
    weights = shape.areas * rng.uniform(1.0, 100.0, len(points))
    pulls = weights[:, None] * (shape.vertices * (1.2, 1.0, 0.9))
    expected = surface.relaxed(points, weights, pulls, WIDTH)
    springs = weights[:, None, None] * np.eye(3)
    found = surface.relaxed_robustly(points, springs, pulls, WIDTH, give=1e6)
    np.testing.assert_allclose(found, expected, atol=1e-3 * np.linalg.norm(expected, axis=1).max())


def test_large_strain_stays_concentrated(strip):
    """A strip with a stretched middle, held at both ends: its halves keep their lengths or get longer."""
    shape, surface = strip
    x = shape.vertices[:, 0]
    apart = 0.1 * np.clip(x / 0.2, -1.0, 1.0)
    start = shape.vertices + np.stack([apart, 0 * x, 0 * x], axis=1)
    held = np.abs(x) > 0.95 * x.max()
    springs = np.where(held, 10.0, 0.0)[:, None, None] * np.eye(3)
    pulls = np.einsum("nij,nj->ni", springs, start)

    def stretched(give):
        points = start
        for _ in range(12):
            points = surface.relaxed_robustly(points, springs, pulls, WIDTH, give)
        quarter, end = (np.abs(x - share * x.max()) < 0.02 * x.max() for share in (0.4, 1.0))
        return (points[end, 0].mean() - points[quarter, 0].mean()) / (0.6 * x.max()) - 1.0

    # With even strain, every part would get longer by this fraction; after twelve rounds, by more than half of it.
    evenly = 0.1 / x.max()
    assert stretched(1e6) > 0.5 * evenly
    assert stretched(0.03) < 0.2 * evenly


def test_edges_without_length_may_open():
    """Two coincident vertices that are pulled apart, as on a mirrored mesh that was not merged, do not overflow."""
    mesh = sheet(7, 7)
    middle = int(np.argmin(np.linalg.norm(mesh.vertices - mesh.vertices.mean(axis=0), axis=1)))
    triangle = mesh.faces[(mesh.faces == middle).any(axis=1)][0]
    beside = next(int(vertex) for vertex in triangle if vertex != middle)
    vertices = mesh.vertices.copy()
    vertices[beside] = vertices[middle]
    shape = UnitShape.of(type(mesh)(vertices, mesh.faces))
    start = shape.vertices.copy()
    start[beside, 2] += 0.1
    springs = np.broadcast_to(np.eye(3), (len(start), 3, 3))
    found = shape.elastic.relaxed_robustly(start, springs, start, WIDTH, give=0.03)
    assert np.isfinite(found).all()
    assert found[beside, 2] - found[middle, 2] > 0.0


def test_normal_springs_allow_sliding(strip):
    shape, surface = strip
    start = shape.vertices + np.array([0.1, 0.0, 0.05])
    springs = 100.0 * shape.areas[:, None, None] * np.diag([0.0, 0.0, 1.0])
    pulls = np.einsum("nij,nj->ni", springs, shape.vertices)
    found = surface.relaxed_robustly(start, springs, pulls, WIDTH, give=0.2)
    np.testing.assert_allclose(found, shape.vertices + np.array([0.1, 0.0, 0.0]), atol=1e-3)


def test_a_flat_surface_that_is_turned_over_in_its_plane_is_strained(strip):
    """Its nearest rotation in the plane has the scale zero, so the energy is that of the edges: twice the area."""
    shape, surface = strip
    assert surface.strain(shape.vertices * (-1.0, 1.0, 1.0), 10.0) == pytest.approx(2.0, rel=1e-3)
    turned = shape.vertices @ np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    assert surface.strain(turned, WIDTH) == pytest.approx(0.0, abs=1e-12)


def test_a_flat_surface_may_leave_its_plane(strip):
    shape, surface = strip
    upright = shape.vertices[:, [2, 1, 0]] * (1.0, 1.0, -1.0)
    assert surface.strain(upright, WIDTH) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("size", [1e-6, 1e-8])
def test_bodies_too_small_to_be_held_by_their_areas_stay_in_place(size):
    """Systems with such a body, like a speck beside a scan, were singular within rounding."""
    speck = box((size, size, size), (2.0, 0.3, 0.1), (0.1, 0.2, 0.3))
    shape = UnitShape.of(joined(ball(points=400), speck))
    weights = 1e-3 * shape.areas
    pulls = weights[:, None] * shape.vertices
    found = shape.elastic.relaxed(shape.vertices, weights, pulls, WIDTH)
    np.testing.assert_allclose(found, shape.vertices, atol=1e-3)
    springs = weights[:, None, None] * np.eye(3)
    robust = shape.elastic.relaxed_robustly(shape.vertices, springs, pulls, WIDTH, give=0.3)
    np.testing.assert_allclose(robust, shape.vertices, atol=1e-3)
