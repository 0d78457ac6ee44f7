# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The measures of shape keys, for deformations with known results."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.mesh_cases import shrinkwrapped
from benchmarks.mesh_measures import MeshFigures, PlayedKeys, median_stretch, volume_error
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from tests.shapes import ball, joined


def straight(mesh, vertices):
    return PlayedKeys(mesh, (1.0,), np.asarray(vertices)[None])


def test_a_growing_ball_has_only_a_volume_error():
    """Its volume is (1 + t)^3 instead of 1 + 7 t; the vertices end on those of the other ball."""
    mesh, larger = ball(points=400), ball(2.0, points=400)
    figures = MeshFigures.of(straight(mesh, larger.vertices), larger)
    assert (figures.turned, figures.collapsed, figures.keys) == (0, 0, 1)
    assert figures.distance == pytest.approx(0.0, abs=1e-9)
    assert figures.uncovered == pytest.approx(0.0, abs=1e-9)
    assert figures.normals == pytest.approx(0.0, abs=1e-3)
    assert (figures.crossing, figures.crossing_way) == (0.0, 0.0)
    assert figures.stretch == pytest.approx(1.0, abs=1e-3)
    worst = max(abs((1.0 + t) ** 3 / (1.0 + 7.0 * t) - 1.0) for t in np.arange(1, 16) / 16)
    assert figures.volume == pytest.approx(worst, rel=1e-6)


def test_keys_are_interpolated_linearly():
    mesh = ball(points=100)
    keys = mesh.vertices + np.array([[[1.0, 0.0, 0.0]], [[1.0, 1.0, 0.0]]])
    played = PlayedKeys(mesh, (0.25, 1.0), keys)
    for t, shift in ((0.0, (0, 0)), (0.125, (0.5, 0)), (0.25, (1, 0)), (0.625, (1, 0.5)), (1.0, (1, 1))):
        np.testing.assert_allclose(played.at(t).vertices, mesh.vertices + np.array([*shift, 0.0]), atol=1e-12)
    assert volume_error(played, mesh.volume) == pytest.approx(0.0, abs=1e-9)


def test_stretch_is_the_ratio_of_the_singular_values():
    x, y = np.meshgrid(np.arange(8.0), np.arange(8.0), indexing="ij")
    vertices = np.stack([x.ravel(), y.ravel(), np.zeros(64)], axis=1)
    corner = (8 * np.arange(7)[:, None] + np.arange(7)).ravel()
    faces = np.concatenate(
        [np.stack([corner, corner + 8, corner + 9], 1), np.stack([corner, corner + 9, corner + 1], 1)]
    )
    assert median_stretch(TriangleMesh(vertices, faces), vertices * [3.0, 1.0, 1.0]) == pytest.approx(3.0)


def test_folded_collapsed_and_crossing_triangles_are_counted():
    """Wrapped onto a ball above, the far half of a ball ends on the near half of the other, inside out."""
    mesh, target = ball(points=400), ball(center=(0.0, 0.0, 3.0), points=600)
    figures = MeshFigures.of(straight(mesh, shrinkwrapped(mesh, target)), target)
    assert figures.distance == pytest.approx(0.0, abs=1e-9)
    assert 0.3 * len(mesh.faces) < figures.turned < 0.6 * len(mesh.faces)
    assert figures.normals > 45.0
    pair = joined(ball(points=200), ball(center=(3.0, 0.0, 0.0), points=200))
    moved = pair.vertices.copy()
    moved[len(moved) // 2 :] -= [2.0, 0.0, 0.0]
    moved[:3] = moved[0]
    figures = MeshFigures.of(straight(pair, moved), pair)
    assert figures.crossing > 0.0
    assert figures.collapsed > 0


def test_parts_that_are_not_reached_are_uncovered():
    """One of two balls is all that the mesh takes; the other is as far away as the nearest points of both."""
    mesh, other = ball(points=200), ball(points=200, center=(8.0, 0.0, 0.0))
    target = joined(mesh, other)
    figures = MeshFigures.of(straight(mesh, mesh.vertices), target)
    assert figures.distance == pytest.approx(0.0, abs=1e-9)
    assert 6.0 < figures.uncovered * target.diagonal < 9.0
