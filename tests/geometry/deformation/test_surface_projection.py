# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Projection of a surface onto one close to it."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.errors import Cancelled
from convwass_addon.geometry.deformation import surface_projection as module
from convwass_addon.geometry.deformation.surface_projection import drawn_along_normals
from convwass_addon.geometry.meshes.closest_points import ClosestPointFinder
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.progress import Control
from tests.shapes import ball, box


def test_a_smooth_gap_is_closed_without_folds():
    target = ball(points=3000)
    near = ball(points=700)
    gap = 1.0 + 0.02 * np.sin(3.0 * near.vertices[:, :1])
    drawn = drawn_along_normals(TriangleMesh(near.vertices * gap, near.faces), target, Control())
    before = ClosestPointFinder(target.corners).find(near.vertices * gap).distances
    after = ClosestPointFinder(target.corners).find(drawn).distances
    assert after.max() < 0.1 * before.max()
    corners = drawn[near.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (np.einsum("nd,nd->n", normals, corners.mean(axis=1)) > 0).all()


def test_points_on_the_surface_stay():
    mesh = ball(points=200)
    np.testing.assert_allclose(drawn_along_normals(mesh, mesh, Control()), mesh.vertices, atol=1e-9)


def test_distant_and_differently_oriented_parts_stay():
    mesh = box(center=(9.0, 0.0, 0.0))
    np.testing.assert_allclose(drawn_along_normals(mesh, ball(points=200), Control()), mesh.vertices, atol=1e-6)


def test_surfaces_of_many_vertices_are_projected_in_the_same_way(monkeypatch):
    target, near = ball(points=3000), ball(points=700)
    moved = TriangleMesh(near.vertices * (1.0 + 0.05 * np.sin(3.0 * near.vertices[:, :1])), near.faces)
    factorized = drawn_along_normals(moved, target, Control())
    monkeypatch.setattr(module, "_MANY", 100)
    np.testing.assert_allclose(drawn_along_normals(moved, target, Control()), factorized, rtol=0.0, atol=1e-12)
    # They are factorized after all if conjugate gradients take too long.
    monkeypatch.setattr(module, "_MOST_ITERATIONS", 2)
    np.testing.assert_array_equal(drawn_along_normals(moved, target, Control()), factorized)


def test_it_can_be_cancelled():
    control = Control()
    control.cancel()
    with pytest.raises(Cancelled):
        drawn_along_normals(box(), box(), control)
