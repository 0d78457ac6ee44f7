# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Fields of rotation vectors, compared with SciPy and with fields known to be continuous."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from convwass_addon.geometry.algebra.rotation_fields import (
    nearest_branches,
    rotation_matrices,
    rotation_vectors,
    unwound,
    unwound_towards,
)

AXIS = np.array([1.0, 2.0, -2.0]) / 3.0


def chain(count):
    return np.stack([np.arange(count - 1), np.arange(1, count)], axis=1)


def shortest(vectors):
    return rotation_vectors(rotation_matrices(vectors))


@pytest.mark.parametrize("size", [0.0, 1e-12, 1e-4, 1.0, 3.1, 8.0])
def test_matrices_agree_with_scipy(size):
    vectors = size * Rotation.random(20, rng=np.random.default_rng(1)).as_matrix()[:, 0]
    np.testing.assert_allclose(rotation_matrices(vectors), Rotation.from_rotvec(vectors).as_matrix(), atol=1e-14)


def test_vectors_are_the_shortest_of_their_rotations():
    vectors = np.array([0.0, 1.0, 3.0, -2.0])[:, None] * AXIS
    np.testing.assert_allclose(rotation_vectors(rotation_matrices(vectors)), vectors, atol=1e-12)
    assert rotation_vectors(np.empty((0, 3, 3))).shape == (0, 3)


def test_a_field_of_more_than_half_a_turn_is_unwound():
    field = np.linspace(0.0, np.radians(250.0), 26)[:, None] * AXIS
    given = shortest(field)
    assert np.linalg.norm(np.diff(given, axis=0), axis=1).max() > np.pi
    found = unwound(given, chain(26))
    # The whole field may differ by full turns.
    full = np.round((found - field) @ AXIS / (2 * np.pi))
    assert len(set(full)) == 1
    np.testing.assert_allclose(found - 2 * np.pi * full[0] * AXIS, field, atol=1e-9)
    np.testing.assert_allclose(rotation_matrices(found), rotation_matrices(given), atol=1e-12)


def test_components_and_the_order_of_vertices_do_not_matter():
    field = np.linspace(0.0, np.radians(250.0), 26)[:, None] * AXIS
    both = np.concatenate([field, -field[::-1]])
    edges = np.concatenate([chain(26), chain(26) + 26])
    order = np.random.default_rng(3).permutation(52)
    rank = np.argsort(order)
    found = unwound(shortest(both)[order], rank[edges])[rank]
    assert np.linalg.norm(np.diff(found[:26], axis=0), axis=1).max() < 0.3
    assert np.linalg.norm(np.diff(found[26:], axis=0), axis=1).max() < 0.3


def test_a_twist_of_nearly_a_full_turn_takes_the_short_way():
    field = np.concatenate([np.zeros(20), np.linspace(0.0, np.radians(340.0), 15)])[:, None] * AXIS
    np.testing.assert_allclose(unwound(shortest(field), chain(35)), shortest(field))


def test_a_smooth_field_is_unchanged():
    field = np.linspace(0.0, 3.0, 10)[:, None] * AXIS
    assert unwound(field, chain(10)) is field


def test_the_branch_nearest_to_a_guess_is_chosen():
    vectors = np.array([[0.5, 0, 0], [0, 3.0, 0], [0, 0, 0]])
    guesses = np.array([[6.5, 0.3, 0], [0, -3.0, 0], [0, 0, 6.0]])
    found = nearest_branches(vectors, guesses)
    expected = [[0.5 + 2 * np.pi, 0, 0], [0, 3.0 - 2 * np.pi, 0], [0, 0, 2 * np.pi]]
    np.testing.assert_allclose(found, expected, atol=1e-12)


def test_a_limb_takes_the_branch_of_the_guess():
    limb = np.concatenate([np.zeros(5), np.full(70, np.radians(175.0))])[:, None] * AXIS
    other_way = np.concatenate([np.zeros(5), np.full(70, np.radians(-185.0))])[:, None] * AXIS
    edges = chain(75)
    assert np.linalg.norm(unwound(limb, edges), axis=1).max() < np.pi
    np.testing.assert_allclose(unwound_towards(limb, other_way, edges), other_way, atol=1e-9)


def test_a_guess_that_would_tear_the_field_is_ignored():
    field = np.full((10, 1), np.radians(170.0)) * AXIS
    guess = np.where(np.arange(10)[:, None] % 2, 1.0, -1.0) * field
    np.testing.assert_allclose(unwound_towards(field, guess, chain(10)), field)
