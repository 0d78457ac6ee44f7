# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.morphs.appearance import Appearance, Painted, Plain, Textured, carried
from convwass_addon.geometry.meshes.closest_points import ClosestPoints
from tests.shapes import ball, box

RED, BLUE = (1.0, 0.0, 0.0, 1.0), (0.0, 0.0, 1.0, 1.0)


def appearance_of(mesh, *paints, materials=None, groups=None):
    slots = np.zeros(len(mesh.faces), np.int64) if materials is None else np.asarray(materials)
    return Appearance(mesh.corners, slots, paints, mesh.faces, groups or {})


def at_corners(shares):
    count = len(shares)
    return ClosestPoints(np.zeros(count, np.int64), np.array(shares), np.zeros(count))


def linear_paint(mesh):
    """Red, green and blue are x, y and z."""
    return Painted(np.concatenate([mesh.corners, np.ones((*mesh.corners.shape[:2], 1))], axis=2).astype(np.float32))


def test_painted_corners_are_interpolated_in_the_closest_triangle():
    mesh = box((2, 2, 2))
    points = np.random.default_rng(0).uniform(-2, 2, (200, 3))
    seen = appearance_of(mesh, linear_paint(mesh)).at(points)
    outside = np.abs(points).max(axis=1) > 1
    np.testing.assert_allclose(seen.colors[outside, :3], np.clip(points[outside], -1, 1), atol=1e-5)


def test_every_material_has_its_own_color():
    mesh = box((2, 2, 2))
    upper = mesh.corners.mean(axis=1)[:, 2] > 0.5
    seen = appearance_of(mesh, Plain(RED), Plain(BLUE), materials=upper.astype(int)).at(
        np.array([[0.0, 0, 3], [0, 0, -3], [5, 0, 0]])
    )
    np.testing.assert_array_equal(seen.colors, [BLUE, RED, RED])
    np.testing.assert_array_equal(seen.materials, [1, 0, 0])


def test_an_image_is_looked_up_between_the_centers_of_its_pixels():
    pixels = np.zeros((2, 4, 4), np.float32)
    pixels[0, :, 0] = [0, 1, 2, 3]
    pixels[1, :, 0] = [10, 11, 12, 13]
    uvs = np.array([[[0.125, 0.25], [0.875, 0.25], [0.125, 0.75]]], dtype=np.float32)
    paint = Textured(pixels, uvs)
    found = paint.at(at_corners([[1.0, 0, 0], [0, 1, 0], [0, 0, 1], [0.5, 0.5, 0], [0.5, 0, 0.5]]))
    np.testing.assert_allclose(found[:, 0], [0, 3, 10, 1.5, 5], atol=1e-5)


@pytest.mark.parametrize(("repeats", "beyond"), [(True, 0.5), (False, 1.0)])
def test_an_image_is_repeated_or_extended_beyond_its_edges(repeats, beyond):
    pixels = np.zeros((1, 2, 4), np.float32)
    pixels[0, 1] = 1.0
    uvs = np.full((1, 3, 2), (1.0, 0.5), np.float32)
    np.testing.assert_allclose(Textured(pixels, uvs, repeats).at(at_corners([[1.0, 0, 0]])), [[beyond] * 4])


def test_texture_coordinates_do_not_cross_seams():
    """Adjacent triangles at opposite edges of an image: no color from the middle of the image appears."""
    corners = np.array([[[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[1, 0, 0], [1, 1, 0], [0, 1, 0]]], dtype=float)
    uvs = np.array([np.full((3, 2), 0.1), np.full((3, 2), 0.9)], dtype=np.float32)
    pixels = np.zeros((10, 10, 4), np.float32)
    pixels[2:8, 2:8] = 1.0
    appearance = Appearance(corners, np.zeros(2, np.int64), (Textured(pixels, uvs),), np.array([[0, 1, 2], [1, 3, 2]]))
    points = np.random.default_rng(2).uniform(0, 1, (300, 3)) * (1, 1, 0)
    assert appearance.at(points).colors.max() == 0.0


def test_a_blend_mixes_the_appearance_at_its_origins():
    one, other = ball(1.0), ball(2.0, (10, 0, 0))
    groups = {"head": one.vertices[:, 2].astype(np.float32), "tail": np.ones(len(one.vertices), np.float32)}
    appearances = [
        appearance_of(one, linear_paint(one), groups=groups),
        appearance_of(other, Plain(BLUE), groups={"head": np.ones(len(other.vertices), np.float32)}),
        appearance_of(one, Plain(RED)),
    ]
    directions = one.vertices[::7]
    origins = np.stack([directions, 2 * directions + (10, 0, 0), directions]).astype(np.float32)
    found = carried(origins, np.empty((0, 3), np.int64), appearances, (0.75, 0.25, 0.0))
    assert list(found.inputs) == [0, 1]
    expected = 0.75 * np.c_[directions, np.ones(len(directions))] + 0.25 * np.array(BLUE)
    np.testing.assert_allclose(found.color, expected, atol=1e-5)
    assert list(found.groups) == ["head"]
    np.testing.assert_allclose(found.groups["head"], 0.75 * directions[:, 2] + 0.25, atol=1e-5)


def test_colors_are_means_over_the_faces_about_a_vertex():
    """A step between two colors becomes softer, and everything else is unchanged."""
    mesh = ball(1.0, points=3000)
    paint = Painted((mesh.corners[..., [2, 2, 2, 2]] > 0).astype(np.float32))
    found = carried(mesh.vertices[None].astype(np.float32), mesh.faces, [appearance_of(mesh, paint)], (1.0,))
    height, colors = mesh.vertices[:, 2], found.color[:, 0]
    np.testing.assert_array_equal(colors[np.abs(height) > 0.12], height[np.abs(height) > 0.12] > 0)
    near = np.abs(height) < 0.03
    assert 0 < colors[near].min() < 0.5 < colors[near].max() < 1


def test_shapes_of_one_color_are_not_searched():
    """Points that are not numbers have no closest place."""
    appearance = appearance_of(ball(), Plain(RED))
    seen = appearance.at(np.full((3, 3), np.nan))
    np.testing.assert_array_equal(seen.colors, [RED] * 3)
    np.testing.assert_array_equal(seen.materials, [0] * 3)
