# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Rotations divided into a turn of the whole, swings and twists."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from convwass_addon.geometry.deformation.limb_axes import LimbAxes
from convwass_addon.geometry.deformation.swing_twist import (
    divided_turns,
    inverse_turns,
    median_rotation,
    turn_matrices,
    turns_with_twists,
)

COUNT = 50
WHOLE = np.array([0.4, -0.9, 0.3])


@pytest.fixture
def random():
    return np.random.default_rng(4)


def units(random):
    vectors = random.normal(size=(COUNT, 3))
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def rotated(vectors, points):
    return Rotation.from_rotvec(vectors).apply(points)


@pytest.fixture
def limbs(random):
    """Axes, and rotation vectors of a swing by up to 90 degrees after a twist by up to 45 degrees."""
    axes = units(random)
    swings = np.cross(axes, units(random))
    swings *= (random.uniform(0.1, 0.5 * np.pi, COUNT) / np.linalg.norm(swings, axis=1))[:, None]
    twists = random.uniform(-0.25 * np.pi, 0.25 * np.pi, COUNT)[:, None] * axes
    vectors = (Rotation.from_rotvec(swings) * Rotation.from_rotvec(twists)).as_rotvec()
    return axes, vectors, swings, twists


def test_a_swing_and_a_twist_are_found_again(limbs):
    axes, vectors, swings, twists = limbs
    turns = divided_turns(WHOLE, vectors, LimbAxes(axes, np.ones(COUNT)))
    np.testing.assert_allclose(turns[:, 1], swings, atol=1e-9)
    np.testing.assert_allclose(turns[:, 2], twists, atol=1e-9)
    expected = Rotation.from_rotvec(WHOLE) * Rotation.from_rotvec(vectors)
    np.testing.assert_allclose(turn_matrices(turns), expected.as_matrix(), atol=1e-9)


def test_a_twisted_limb_swings_in_a_plane(limbs):
    """As one rotation, the limb leaves the plane of its end positions."""
    axes, vectors, swings, _ = limbs
    normals = swings / np.linalg.norm(swings, axis=1, keepdims=True)
    turns = divided_turns(np.zeros(3), vectors, LimbAxes(axes, np.ones(COUNT)))
    halfway = np.einsum("nij,nj->ni", turn_matrices(0.5 * turns), axes)
    np.testing.assert_allclose(np.einsum("nd,nd->n", halfway, normals), 0.0, atol=1e-9)
    as_one = np.einsum("nd,nd->n", rotated(0.5 * vectors, axes), normals)
    assert np.abs(as_one).max() > 0.1


def test_without_axes_rotations_are_swings(limbs):
    axes, vectors, _, _ = limbs
    turns = divided_turns(WHOLE, vectors, LimbAxes(axes, np.zeros(COUNT)))
    np.testing.assert_allclose(turns[:, 1], vectors, atol=1e-9)
    np.testing.assert_allclose(turns[:, 2], 0.0)


def test_rotations_by_more_than_half_a_turn_stay_so(random):
    vectors = 1.3 * np.pi * units(random)
    turns = divided_turns(WHOLE, vectors, LimbAxes(units(random), np.ones(COUNT)))
    np.testing.assert_allclose(turns[:, 1], vectors, atol=1e-9)


@pytest.mark.parametrize("share", [0.25, 0.7])
def test_inverse_turns_pass_through_the_same_rotations(limbs, share):
    _, vectors, _, twists = limbs
    turns = turns_with_twists(WHOLE, vectors, twists)
    there, back = turn_matrices(share * turns), turn_matrices((1.0 - share) * inverse_turns(turns))
    np.testing.assert_allclose(back @ turn_matrices(turns), there, atol=1e-9)


def test_the_median_is_the_rotation_of_most_of_a_surface(random):
    turned = np.where(np.arange(COUNT)[:, None] < 0.3 * COUNT, [2.0, 0.0, 0.0], WHOLE)
    noise = Rotation.from_rotvec(1e-3 * random.normal(size=(COUNT, 3)))
    found = median_rotation((noise * Rotation.from_rotvec(turned)).as_matrix(), np.ones(COUNT))
    assert (Rotation.from_matrix(found) * Rotation.from_rotvec(WHOLE).inv()).magnitude() < 0.02
