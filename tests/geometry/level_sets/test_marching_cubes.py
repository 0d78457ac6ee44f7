# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Marching cubes on whole arrays."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from skimage import measure

from convwass_addon.geometry.level_sets.marching_cubes import marching_cubes
from convwass_addon.geometry.meshes.mesh import TriangleMesh


def distances(shape: tuple[int, int, int], center: tuple[float, float, float], radius: float) -> NDArray[np.float64]:
    """Return how deep grid points are inside a ball."""
    points = np.stack(np.meshgrid(*map(np.arange, shape), indexing="ij"), axis=-1)
    return radius - np.linalg.norm(points - center, axis=-1)


def directed_edges(mesh: TriangleMesh) -> NDArray[np.int64]:
    return np.concatenate([mesh.faces[:, [i, (i + 1) % 3]] for i in range(3)])


def test_a_ball_has_its_radius_volume_and_orientation():
    center, radius = (9.3, 8.7, 10.1), 6.5
    ball = marching_cubes(distances((20, 18, 21), center, radius), 0.0)
    np.testing.assert_allclose(np.linalg.norm(ball.vertices - center, axis=1), radius, atol=0.02)
    assert ball.volume == pytest.approx(4.0 / 3.0 * np.pi * radius**3, rel=0.02)


def test_linear_values_give_an_exact_plane():
    values = np.full((5, 6, 7), -10.0)
    values[1:-1, 1:-1, 1:-1] = (3.3 - np.arange(7))[None, None, 1:-1]
    top = marching_cubes(values, 0.0).vertices
    top = top[(top[:, 2] > 2.0) & (np.abs(top[:, :2] - np.round(top[:, :2])).max(axis=1) == 0.0)]
    np.testing.assert_allclose(top[:, 2], 3.3, atol=1e-12)
    assert len(top) == 3 * 4


def test_smooth_values_give_the_surface_of_scikit_image():
    one, other = distances((30, 20, 20), (9.2, 9.6, 9.1), 6.0), distances((30, 20, 20), (19.4, 9.3, 9.8), 6.5)
    values = np.maximum(one, other).astype(np.float32)
    own = marching_cubes(values, 0.0)
    vertices, faces, _, _ = measure.marching_cubes(values, 0.0, gradient_direction="ascent")
    known = TriangleMesh(vertices.astype(np.float64), faces.astype(np.int64))
    order, known_order = (np.lexsort(points.round(3).T) for points in (own.vertices, known.vertices))
    np.testing.assert_allclose(own.vertices[order], known.vertices[known_order], atol=1e-5)
    assert len(own.faces) == len(known.faces)
    assert own.volume == pytest.approx(known.volume, rel=1e-3)


def test_the_surface_of_noise_is_closed_with_two_faces_at_every_edge():
    values = np.full((24, 24, 24), -9.0)
    values[1:-1, 1:-1, 1:-1] = np.random.default_rng(5).normal(size=(22, 22, 22))
    surface = marching_cubes(values, 0.0)
    edges = directed_edges(surface)
    assert len(np.unique(edges, axis=0)) == len(edges)
    np.testing.assert_array_equal(np.unique(edges, axis=0), np.unique(edges[:, ::-1], axis=0))
    assert set(surface.faces.ravel()) == set(range(len(surface.vertices)))
    assert surface.volume > 0.0


@pytest.mark.parametrize("place", [(0, 2, 2), (2, 4, 2), (2, 2, 0)])
def test_an_outermost_sample_above_the_level_is_refused(place):
    values = np.zeros((5, 5, 5))
    values[place] = 1.0
    with pytest.raises(ValueError, match="outermost"):
        marching_cubes(values, 0.5)
