# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Points that follow a surface."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.deformation.attachment import Attachment, rigidly_moved
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from tests.shapes import ball

TURN = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
SHIFT = np.array([3.0, -2.0, 0.5])


@pytest.fixture(scope="module")
def points():
    return 1.3 * ball(points=150).vertices


def test_points_turn_move_and_scale_with_a_body(points):
    body = ball(points=400)
    attached = Attachment.of(points, body)
    np.testing.assert_allclose(attached.followed(body.vertices), points, atol=1e-12)
    followed = attached.followed(2.0 * body.vertices @ TURN.T + SHIFT)
    np.testing.assert_allclose(followed, 2.0 * points @ TURN.T + SHIFT, atol=1e-9)


def test_a_sleeve_stays_at_its_distance_when_the_arm_bends():
    """A sleeve around a tube that is bent by a radian keeps its distance from the tube."""
    angles = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)

    def tube(radius, rows):
        return np.array([[radius * np.cos(a), radius * np.sin(a), z] for z in rows for a in angles])

    here = (24 * np.arange(24)[:, None] + np.arange(24)).ravel()
    aside = (24 * np.arange(24)[:, None] + (np.arange(24) + 1) % 24).ravel()
    faces = np.concatenate([np.stack([here, aside, aside + 24], 1), np.stack([here, aside + 24, here + 24], 1)])
    arm = TriangleMesh(tube(0.5, np.linspace(-3.0, 3.0, 25)), faces)
    sleeve = tube(0.6, np.linspace(-1.5, 1.5, 9))

    def bent(points):
        angle = points[:, 2] / 6.0
        radius = 6.0 + points[:, 0]
        return np.stack([radius * np.cos(angle) - 6.0, points[:, 1], radius * np.sin(angle)], axis=1)

    followed = Attachment.of(sleeve, arm).followed(bent(arm.vertices))
    np.testing.assert_allclose(followed, bent(sleeve), atol=0.03)


def test_slivers_that_open_do_not_throw_points_far_away():
    """Beside a square, a triangle without area becomes as large as the square's."""
    corners = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [1.0 + 1e-9, 0.5, 0.0]])
    surface = TriangleMesh(corners, np.array([[0, 1, 2], [0, 2, 3], [1, 4, 2]]))
    attached = Attachment.of(np.array([[1.1, 0.5, 0.3]]), surface)
    opened = corners + np.array([[0.0, 0.0, 0.0]] * 4 + [[0.5, 0.0, 0.0]])
    np.testing.assert_allclose(attached.followed(opened), [[1.6, 0.5, 0.3]], atol=0.1)


def test_rigid_parts_are_turned_and_scaled_whole(points):
    parts = np.repeat([0, 1], [len(points), 5])
    both = np.concatenate([points, np.tile([[9.0, 9.0, 9.0]], (5, 1))])
    noise = np.random.default_rng(1).normal(scale=1e-3, size=both.shape)
    exact = np.concatenate([1.5 * points @ TURN.T + SHIFT, np.tile([[1.0, 2.0, 3.0]], (5, 1))])
    moved = rigidly_moved(both, exact + noise, parts)
    np.testing.assert_allclose(moved, exact, atol=2e-3)
    lengths = np.linalg.norm(np.diff(moved[: len(points)], axis=0), axis=1)
    ratio = lengths / np.linalg.norm(np.diff(points, axis=0), axis=1)
    assert np.ptp(ratio) < 1e-9
