# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangles rasterized into a texture: no gaps, no overlaps, the correct value at every pixel."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from convwass_addon.geometry.meshes import uv_pixels as module
from convwass_addon.geometry.meshes.uv_pixels import uv_pixels

SIZE = 32
X, Y = np.meshgrid((np.arange(SIZE) + 0.5) / SIZE, (np.arange(SIZE) + 0.5) / SIZE)
"""Centers of the pixels."""

SQUARE = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
FACES = np.array([[0, 1, 2], [0, 2, 3]])


def test_linear_values_are_exact():
    pixels = uv_pixels(SQUARE[FACES], FACES, SIZE, 0)
    assert len(pixels.places) == SIZE**2
    values = 2 * SQUARE[:, 0] - SQUARE[:, 1] + 3
    np.testing.assert_allclose(pixels.picture(values), 2 * X - Y + 3, atol=1e-6)


@pytest.mark.parametrize("flip", [False, True])
def test_a_single_triangle(flip):
    corners = np.array([[0.1, 0.1], [0.9, 0.2], [0.3, 0.8]])
    faces = np.array([[0, 2, 1] if flip else [0, 1, 2]])
    pixels = uv_pixels(corners[faces], faces, SIZE, 0)
    covered = pixels.picture(np.ones(3)) > 0
    a, b, c = corners

    def left_of(p, q):
        return (q[0] - p[0]) * (Y - p[1]) - (q[1] - p[1]) * (X - p[0]) >= 0

    np.testing.assert_array_equal(covered, left_of(a, b) & left_of(b, c) & left_of(c, a))


@settings(max_examples=30)
@given(
    points=st.lists(st.tuples(st.floats(0.05, 0.95), st.floats(0.05, 0.95)), min_size=1, max_size=12, unique=True),
    block=st.sampled_from([1, 50, 2_000_000]),
)
def test_no_pixel_falls_between_triangles(points, block):
    """Any triangulation covers the square, and linear values stay linear."""
    from scipy.spatial import Delaunay

    places = np.array([*SQUARE.tolist(), *points])
    faces = Delaunay(places).simplices
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "PIXELS_AT_ONCE", block)
        pixels = uv_pixels(places[faces], faces, SIZE, 0)
    assert (pixels.sources >= 0).mean() > 0.999
    seen = pixels.picture(places[:, 0] + 10 * places[:, 1])
    inside = pixels.sources.reshape(SIZE, SIZE) >= 0
    np.testing.assert_allclose(seen[inside], (X + 10 * Y)[inside], atol=1e-4)
    np.testing.assert_allclose(pixels.weights.sum(axis=1), 1, atol=1e-6)


@pytest.mark.parametrize("margin", [0, 1, 3, 100])
def test_margins_repeat_the_nearest_pixel(margin):
    corners = 0.25 + 0.5 * SQUARE
    pixels = uv_pixels(corners[FACES], FACES, SIZE, margin)
    seen = pixels.picture(np.full(4, 5.0))
    outside = np.maximum(np.maximum(8 - np.arange(SIZE), np.arange(SIZE) - 23), 0)
    distance = np.hypot(*np.meshgrid(outside, outside))
    np.testing.assert_array_equal(seen, np.where(distance <= margin, 5.0, 0.0))
    values = pixels.picture(corners[:, 0])
    if margin:
        np.testing.assert_array_equal(values[8:24, 7], values[8:24, 8])


def test_triangles_outside_and_without_area():
    corners = np.array([[[2, 2], [3, 2], [2, 3]], [[-1, 0.5], [0.5, 0.5], [2, 0.5]], [[-1, -1], [-2, -1], [-1, -2]]])
    pixels = uv_pixels(corners.astype(float), np.arange(9).reshape(3, 3), SIZE, 4)
    assert len(pixels.places) == 0
    assert not pixels.picture(np.ones(9)).any()


def test_a_triangle_larger_than_the_texture():
    corners = np.array([[[-5.0, -5], [9, -5], [-5, 9]]])
    pixels = uv_pixels(corners, np.array([[0, 1, 2]]), SIZE, 0)
    np.testing.assert_allclose(pixels.picture(corners[0, :, 0]), X, atol=1e-5)


def test_the_last_of_overlapping_triangles_wins():
    faces = np.array([[0, 1, 2], [3, 4, 5]])
    corners = np.tile([[0.0, 0], [2, 0], [0, 2]], (2, 1, 1))
    seen = uv_pixels(corners, faces, SIZE, 0).picture(np.array([1, 1, 1, 2, 2, 2.0]))
    assert (seen == 2).all()
