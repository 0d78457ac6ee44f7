# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Vertex animation textures: a shader reads the written values within half a quantization step."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.one_mesh.vertex_textures import (
    LARGEST_TEXTURE,
    TextureGrid,
    packed_normals,
    padded_triangles,
    split_steps,
    y_up,
)
from convwass_addon.errors import InputError
from tests.vertex_textures import gathered, joined_steps, unpacked_normals


@pytest.fixture
def points():
    return np.random.default_rng(1).normal(size=(5, 100, 3)) * [1.0, 10.0, 0.0] + 3.0


def test_a_shader_finds_every_vertex_in_every_frame(points):
    """By nearest texels at the coordinates of the mesh, shifted down by whole frames."""
    grid = TextureGrid.of(100, 5)
    image = grid.arranged(points)
    assert image.shape == (grid.height, grid.width, 3)
    for frame in range(5):
        u, v = (grid.coordinates() + np.array([0.0, frame / 5])).T
        read = image[(v * grid.height).astype(int), (u * grid.width).astype(int)]
        np.testing.assert_array_equal(read, points[frame])
    np.testing.assert_array_equal(gathered(grid, image), points)


def test_positions_come_back_within_half_a_quantum(points):
    bounds = np.stack([points.min(axis=(0, 1)), points.max(axis=(0, 1))])
    read = joined_steps(split_steps(points, bounds), bounds)
    quantum = (bounds[1] - bounds[0]) / 65535
    assert (np.abs(read - points) <= 0.5 * quantum + 1e-12).all()
    assert np.abs(read - points).max() > 0.4 * quantum.max()


def test_normals_come_back_within_half_a_quantum(points):
    normals = points / np.linalg.norm(points, axis=2, keepdims=True)
    assert np.abs(unpacked_normals(packed_normals(normals)) - normals).max() <= 1.0 / 255 + 1e-12


def test_frames_of_other_topology_are_padded_by_triangles_without_area():
    rng = np.random.default_rng(2)
    corners = [rng.normal(size=(count, 3, 3)) for count in (4, 7, 1)]
    animation = padded_triangles(corners, corners)
    assert animation.changing and animation.points.shape == (3, 21, 3)
    for frame, own in zip(animation.points.reshape(3, 7, 3, 3), corners, strict=True):
        np.testing.assert_array_equal(frame[: len(own)], own)
        surplus = frame[len(own) :]
        assert (np.cross(surplus[:, 1] - surplus[:, 0], surplus[:, 2] - surplus[:, 0]) == 0.0).all()
        np.testing.assert_allclose(frame.min(axis=(0, 1)), own.min(axis=(0, 1)))


def test_textures_fit_graphics_cards():
    for points, frames in ((1, 1), (5000, 24), (200_000, 100)):
        grid = TextureGrid.of(points, frames)
        assert grid.width <= LARGEST_TEXTURE and 2 * grid.height <= LARGEST_TEXTURE
    with pytest.raises(InputError, match="do not fit a texture"):
        TextureGrid.of(1_000_000, 100)


def test_y_up_turns_without_mirroring():
    np.testing.assert_array_equal(y_up(np.eye(3)), [[1, 0, 0], [0, 0, -1], [0, 1, 0]])
    assert np.linalg.det(y_up(np.eye(3))) == pytest.approx(1.0)
