# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import pickle

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from convwass_addon.geometry.deformation.solid_blend import SolidBlend, SolidNodes

RANDOM = np.random.default_rng(5)


def bar():
    """A bar with a foot and cells of different mass."""
    mass = np.zeros((14, 6, 6))
    mass[1:13, 2:4, 2:4] = 1.0
    mass[1:3, 1:5, 1:5] = 0.3
    return SolidNodes(mass)


def middle(points, nodes):
    weights = np.bincount(nodes.corners.ravel(), np.repeat(nodes.mass, 8))
    return weights @ points / weights.sum()


@pytest.mark.parametrize("degrees", [30.0, 90.0, 150.0])
@pytest.mark.parametrize("t", [0.0, 0.25, 0.5, 1.0])
def test_interpolated_rotations_are_rotations(degrees, t):
    nodes = bar()
    turn = np.radians(degrees) * np.array([2.0, -1.0, 2.0]) / 3.0
    shift = np.array([3.0, -2.0, 1.0])
    blend = SolidBlend(nodes, [Rotation.from_rotvec(turn).apply(nodes.positions) + shift])
    found = blend.at([t])
    center = middle(nodes.positions, nodes)
    to = (1.0 - t) * center + t * (Rotation.from_rotvec(turn).apply(center) + shift)
    expected = Rotation.from_rotvec(t * turn).apply(nodes.positions - center) + to
    np.testing.assert_allclose(found, expected, atol=1e-4)


def test_weight_one_returns_the_deformation():
    nodes = bar()
    ends = [nodes.positions + RANDOM.normal(scale=0.1, size=nodes.positions.shape) for _ in range(3)]
    blend = SolidBlend(nodes, ends)
    for number, end in enumerate(ends):
        np.testing.assert_allclose(blend.at(np.eye(3)[number]), end, atol=1e-4)
    np.testing.assert_allclose(blend.at([0.0, 0.0, 0.0]), nodes.positions, atol=1e-4)


def test_square_roots_of_stretches_are_blended_evenly():
    nodes = bar()
    blend = SolidBlend(nodes, [nodes.positions * (2.0, 1.0, 1.0), nodes.positions * (1.0, 1.0, 0.5)])
    lengths = np.square([0.7 + 0.3 * np.sqrt(2.0), 1.0, 0.5 + 0.5 * np.sqrt(0.5)])
    # The center moves along a straight line.
    center = middle(nodes.positions, nodes)
    expected = (nodes.positions - center) * lengths + center * (1.3, 1.0, 0.75)
    np.testing.assert_allclose(blend.at([0.3, 0.5]), expected, atol=1e-4)


def test_stretches_along_other_axes_than_those_of_the_grid():
    nodes, turn = bar(), Rotation.from_rotvec([0.3, -0.8, 0.5])
    stretch = turn.as_matrix() @ np.diag([2.25, 1.0, 0.64]) @ turn.as_matrix().T
    half = turn.as_matrix() @ np.diag([1.25**2, 1.0, 0.9**2]) @ turn.as_matrix().T
    found = SolidBlend(nodes, [nodes.positions @ stretch]).at([0.5])
    center = middle(nodes.positions, nodes)
    expected = (nodes.positions - center) @ half + 0.5 * (center + center @ stretch)
    np.testing.assert_allclose(found, expected, atol=1e-4)


def test_an_inverted_cell_does_not_collapse_sideways():
    nodes = SolidNodes(np.ones((1, 1, 1)))
    inverted = nodes.positions * (1.0, 1.0, -0.9)
    blend = SolidBlend(nodes, [inverted])
    for t in (0.25, 0.5, 0.75):
        np.testing.assert_allclose(np.ptp(blend.at([t]), axis=0)[:2], 1.0, atol=1e-4)
    np.testing.assert_allclose(blend.at([1.0]), inverted, atol=1e-4)


def test_a_bent_bar_keeps_its_length():
    nodes = bar()
    # Bent to a quarter of a circle, with its center line as long as the bar.
    along, radius = nodes.positions[:, 0] - 7.0, 12.0 / (np.pi / 2)
    angle = along / radius
    out = radius + nodes.positions[:, 1] - 3.0
    bent = np.stack([out * np.sin(angle), out * np.cos(angle), nodes.positions[:, 2]], axis=1)
    blend = SolidBlend(nodes, [bent])
    line = [np.argmin(np.abs(nodes.positions - (x, 3.0, 3.0)).sum(axis=1)) for x in range(1, 14)]
    for t in (0.25, 0.5, 0.75):
        length = np.linalg.norm(np.diff(blend.at([t])[line], axis=0), axis=1).sum()
        assert length == pytest.approx(12.0, rel=0.01)


def test_nodes_are_interpolated():
    nodes = bar()
    points = RANDOM.uniform((1.0, 2.0, 2.0), (13.0, 4.0, 4.0), (40, 3))
    np.testing.assert_allclose(nodes.interpolation(points) @ nodes.positions, points, atol=1e-12)


def test_it_can_be_pickled():
    nodes = bar()
    blend = SolidBlend(nodes, [nodes.positions + RANDOM.normal(scale=0.1, size=nodes.positions.shape)])
    before = blend.at([0.4])
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(blend)).at([0.4]), before)
