# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Nearest points of outlines of few and of many edges."""

import numpy as np
import pytest

from convwass_addon.geometry.meshes.outline_finder import OutlineFinder
from convwass_addon.geometry.plane.planar_fill import Boundary


@pytest.mark.parametrize("divisions", [1, 300])
def test_points_of_a_square_are_found_however_finely_it_is_divided(divisions):
    corners = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])
    along = np.roll(corners, -1, axis=0) - corners
    shares = np.arange(divisions)[:, None, None] / divisions
    starts = (corners + shares * along).reshape(-1, 2)
    finder = OutlineFinder(Boundary(starts, starts + np.tile(along / divisions, (divisions, 1))))
    points = np.array([[0.9, 0.2], [0.3, -0.8], [2.0, 0.5], [-1.5, 3.0], [-1.0, 0.25]])
    nearest = [[1.0, 0.2], [0.3, -1.0], [1.0, 0.5], [-1.0, 1.0], [-1.0, 0.25]]
    np.testing.assert_allclose(finder.nearest(points), nearest, rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(finder.distances(points), [0.1, 0.2, 1.0, np.hypot(0.5, 2.0), 0.0], rtol=0.0, atol=1e-12)


def test_edges_without_length_are_points():
    finder = OutlineFinder(Boundary(np.array([[1.0, 2.0]]), np.array([[1.0, 2.0]])))
    assert finder.distances(np.array([[4.0, 6.0]])) == pytest.approx(5.0)
