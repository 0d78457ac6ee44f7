# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Intersections of tangent planes on creases."""

from __future__ import annotations

import numpy as np

from convwass_addon.geometry.meshes.tangent_planes import meeting_points

UP, ASIDE = np.array([[0.0, 0.0, 1.0]]), np.array([[1.0, 0.0, 0.0]])


def test_points_on_two_sides_of_a_crease_lead_to_the_crease():
    """The crease of the planes z = 0 and x = 0 is the y axis; the midpoint of the points has y = 2."""
    first, second = np.array([[-0.3, 1.5, 0.0]]), np.array([[0.0, 2.5, -0.4]])
    np.testing.assert_allclose(meeting_points(first, UP, second, ASIDE), [[0.0, 2.0, 0.0]], atol=1e-12)


def test_a_blunt_crease_is_found_as_well():
    slope = np.array([[0.6, 0.0, 0.8]])
    first, second = np.array([[-1.0, 0.0, 0.0]]), np.array([[0.8, 0.0, -0.6]])
    np.testing.assert_allclose(meeting_points(first, UP, second, slope), [[0.0, 0.0, 0.0]], atol=1e-12)


def test_nearly_parallel_planes_give_the_midpoint():
    first, second = np.array([[-1.0, 0.0, 0.0]]), np.array([[1.0, 0.0, -0.1]])
    nearly = np.array([[0.1, 0.0, 1.0]]) / np.sqrt(1.01)
    far = np.array([[-0.6, 0.0, 0.8]])
    for normals in (UP, nearly):
        np.testing.assert_allclose(meeting_points(first, UP, second, normals), [[0.0, 0.0, -0.05]])
    np.testing.assert_allclose(meeting_points(first, UP, 4.0 * ASIDE - 8.0 * UP, far), [[1.5, 0.0, -4.0]])
