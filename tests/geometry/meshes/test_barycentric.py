# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Barycentric coordinates in triangles with and without area."""

import numpy as np
import pytest

from convwass_addon.geometry.meshes.barycentric import barycentric_coordinates

SOUND = ((0.0, 0.0, 0.0), (4.0, 0.0, 0.0), (0.0, 2.0, 0.0))
NEEDLE = ((-1.0, 2.0, 0.0), (1.0, 2.0, 1e-9), (1.0, 2.0, 0.0))
CAP = ((0.0, 0.0, 0.0), (1.0, 1.0, 0.0), (4.0, 4.0, 0.0))


@pytest.mark.parametrize("turn", range(3))
@pytest.mark.parametrize("triangle", [SOUND, NEEDLE, CAP])
def test_points_of_a_triangle_are_found_again(triangle, turn):
    """A triangle without area has only the points of its longest edge."""
    corners = np.roll(triangle, turn, axis=0)
    points = np.linspace(0.0, 1.0, 9)[:, None] * (corners[(turn + 2) % 3] - corners[turn]) + corners[turn]
    shares = barycentric_coordinates(corners[None], points[None])[0]
    np.testing.assert_allclose(shares.sum(axis=1), 1.0)
    np.testing.assert_allclose(shares @ corners, points, atol=1e-8)


def test_a_triangle_that_is_a_point_gives_a_corner():
    found = barycentric_coordinates(np.ones((1, 3, 3)), np.zeros((1, 2, 3)))
    np.testing.assert_array_equal(found[0], [[1.0, 0.0, 0.0]] * 2)
