# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Alignment of several shapes with known relative poses."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from convwass_addon.geometry.algebra.mutual_alignment import Correspondence, mutual_poses

POINTS = np.random.default_rng(5).normal(size=(40, 3)) * (3.0, 1.0, 0.5)


def placed(vector, offset):
    return POINTS @ Rotation.from_rotvec(vector).as_matrix().T + offset


def laid(shapes, weights, pairs):
    found = [Correspondence.of(pair, shapes[pair[0]], shapes[pair[1]], np.ones(len(POINTS))) for pair in pairs]
    poses = mutual_poses(weights, found)
    return poses, [pose.applied(points) for pose, points in zip(poses, shapes, strict=True)]


@pytest.mark.parametrize("share", [0.001, 0.25, 0.5, 0.99])
def test_two_shapes_meet_at_the_weighted_pose(share):
    vector, offset = np.array([0.4, -1.0, 1.5]), np.array([1.0, 2.0, 3.0])
    shapes = [POINTS, placed(vector, offset)]
    poses, moved = laid(shapes, [1.0 - share, share], [(0, 1), (1, 0)])
    center = POINTS.mean(axis=0)
    expected = (POINTS - center) @ Rotation.from_rotvec(share * vector).as_matrix().T
    expected += (1.0 - share) * center + share * shapes[1].mean(axis=0)
    np.testing.assert_allclose(moved[0], expected, atol=1e-9)
    np.testing.assert_allclose(moved[1], expected, atol=1e-9)
    np.testing.assert_allclose(poses[0].vector, share * vector, atol=1e-9)


def test_many_shapes_meet_for_any_known_pairs():
    rng = np.random.default_rng(6)
    shapes = [placed(rng.normal(size=3), rng.normal(size=3)) for _ in range(4)]
    weights = np.array([0.1, 0.2, 0.3, 0.4])
    poses, moved = laid(shapes, weights, [(0, 1), (2, 1), (2, 3)])
    for other in moved[1:]:
        np.testing.assert_allclose(other, moved[0], atol=1e-8)
    np.testing.assert_allclose(weights @ [pose.vector for pose in poses], 0.0, atol=1e-9)
    np.testing.assert_allclose(moved[0].mean(axis=0), weights @ [shape.mean(axis=0) for shape in shapes], atol=1e-9)


def test_the_order_of_shapes_does_not_matter():
    rng = np.random.default_rng(7)
    shapes = [placed(rng.normal(size=3), 0.0) + 0.1 * rng.normal(size=POINTS.shape) for _ in range(3)]
    weights, order = np.array([0.5, 0.3, 0.2]), [2, 0, 1]
    pairs = [(0, 1), (1, 2), (2, 0)]
    _, moved = laid(shapes, weights, pairs)
    rank = np.argsort(order)
    _, again = laid([shapes[k] for k in order], weights[order], [(rank[a], rank[b]) for a, b in pairs])
    for place, shape in enumerate(order):
        np.testing.assert_allclose(again[place], moved[shape], atol=1e-6)


def test_a_shape_with_all_the_weight_is_unchanged():
    shapes = [placed(np.array([0.2, 0.1, 0.0]), 0.0), placed(np.zeros(3), 5.0), placed(np.array([1.0, 0, 0]), -1.0)]
    poses, moved = laid(shapes, [1.0, 0.0, 0.0], [(0, 1), (1, 2), (2, 0)])
    np.testing.assert_allclose(moved[0], shapes[0], atol=1e-12)
    np.testing.assert_allclose(poses[0].vector, 0.0, atol=1e-12)


def test_a_fraction_of_a_pose_interpolates_it():
    vector = np.array([0.4, -1.0, 1.5])
    shapes = [POINTS, placed(vector, 3.0)]
    poses, _ = laid(shapes, [0.5, 0.5], [(0, 1)])
    center = POINTS.mean(axis=0)
    turn = Rotation.from_rotvec(0.2 * vector).as_matrix()
    expected = (POINTS - center) @ turn.T + 0.8 * center + 0.2 * shapes[1].mean(axis=0)
    np.testing.assert_allclose(poses[0].scaled(0.4).applied(POINTS), expected, atol=1e-9)
