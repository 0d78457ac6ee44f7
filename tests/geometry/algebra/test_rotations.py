# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Nearest rotations to matrices, compared with singular value decompositions."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given, strategies as st
from hypothesis.extra.numpy import arrays
from scipy.spatial.transform import Rotation

from convwass_addon.geometry.algebra.rotations import nearest_rotations, nearest_rotations_in_plane


def by_singular_values(matrix):
    left, sizes, right = np.linalg.svd(matrix)
    turned = np.sign(np.linalg.det(left @ right))
    left[:, 2] *= turned
    return left @ right, sizes[0] + sizes[1] + turned * sizes[2]


def test_a_stretched_rotation_is_separated_from_its_stretch():
    turns = Rotation.random(50, rng=np.random.default_rng(1)).as_matrix()
    stretches = np.random.default_rng(2).uniform(0.01, 10.0, (50, 3))
    axes = Rotation.random(50, rng=np.random.default_rng(3)).as_matrix()
    matrices = turns @ np.einsum("nij,nj,nkj->nik", axes, stretches, axes)
    found = nearest_rotations(np.moveaxis(matrices, 0, 2))
    np.testing.assert_allclose(np.moveaxis(found.rotations, 2, 0), turns, atol=1e-9)
    np.testing.assert_allclose(found.traces, stretches.sum(axis=1), rtol=1e-12)


@pytest.mark.parametrize("condition", [1.0, 1e2, 1e4, 1e8, 1e16])
@pytest.mark.parametrize("size", [1e-300, 1e-12, 1.0, 1e12, 1e150])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_any_condition_scale_and_orientation_is_accepted(condition, size, side):
    turn, axes = Rotation.random(2, rng=np.random.default_rng(4)).as_matrix()
    matrix = size * turn @ (axes * [1.0, condition**-0.5, side / condition]) @ axes.T
    expected, trace = by_singular_values(matrix)
    found = nearest_rotations(matrix[:, :, None])
    np.testing.assert_allclose(found.rotations[:, :, 0], expected, atol=1e-6)
    assert found.traces[0] == pytest.approx(trace, rel=1e-9)


@given(arrays(float, (3, 3), elements=st.floats(-1e6, 1e6)))
@example(np.full((3, 3), 1e-160))
def test_they_are_rotations_and_no_other_is_nearer(matrix):
    found = nearest_rotations(matrix[:, :, None])
    rotation = found.rotations[:, :, 0]
    np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-9)
    assert np.linalg.det(rotation) == pytest.approx(1.0)
    _, best = by_singular_values(matrix)
    assert found.traces[0] == pytest.approx(best, rel=1e-9, abs=1e-9 * (1.0 + np.abs(matrix).max()))


def test_no_matrices_give_no_rotations():
    assert nearest_rotations(np.empty((3, 3, 0))).rotations.shape == (3, 3, 0)


@given(arrays(float, (2, 2), elements=st.floats(-1e6, 1e6)))
@example(np.full((2, 2), 2e-313))
def test_no_other_rotation_in_the_plane_is_nearer(matrix):
    found = nearest_rotations_in_plane(np.pad(matrix, ((0, 1), (0, 1)))[:, :, None])
    rotation = found.rotations[:, :, 0]
    angles = np.radians(np.arange(3600) / 10.0)
    turns = np.array([[np.cos(angles), -np.sin(angles)], [np.sin(angles), np.cos(angles)]])
    best = np.einsum("ijn,ij->n", turns, matrix).max()
    size = np.abs(matrix).max()
    assert found.traces[0] == pytest.approx(best, rel=1e-5, abs=1e-9 * size)
    assert np.sum(rotation[:2, :2] * matrix) == pytest.approx(found.traces[0], rel=1e-9, abs=1e-9 * size)
    np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-9)
    np.testing.assert_allclose(rotation[2], (0.0, 0.0, 1.0), atol=1e-12)


def test_a_reflection_of_the_plane_does_not_turn_it_over():
    matrices = np.stack([np.diag([-2.0, 1.0, 0.0]), np.zeros((3, 3))], axis=-1)
    found = nearest_rotations_in_plane(matrices)
    np.testing.assert_allclose(found.rotations[:, :, 0], np.diag([-1.0, -1.0, 1.0]), atol=1e-12)
    np.testing.assert_allclose(found.rotations[:, :, 1], np.eye(3))
    np.testing.assert_allclose(found.traces, [1.0, 0.0])
