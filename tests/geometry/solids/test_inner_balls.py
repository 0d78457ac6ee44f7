# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Balls inside bodies: their positions, and paths through them."""

from __future__ import annotations

import numpy as np
from scipy.sparse.csgraph import dijkstra

from convwass_addon.geometry.solids.inner_balls import InnerBalls, inner_balls
from convwass_addon.geometry.solids.solid_angles import winding_numbers
from tests.shapes import ball, torus


def test_a_ball_contains_one_ball():
    found = inner_balls(ball(2.0, (1.0, 0.0, 0.0)))
    assert np.abs(found.centers - [1.0, 0.0, 0.0]).max() < 0.15
    np.testing.assert_allclose(found.radii, 2.0, rtol=0.07)


def test_the_balls_of_a_torus_lie_on_its_center_circle():
    found = inner_balls(torus(1.0, 0.3))
    away = np.hypot(np.hypot(found.centers[:, 0], found.centers[:, 1]) - 1.0, found.centers[:, 2])
    assert away.max() < 0.05
    np.testing.assert_allclose(found.radii, 0.3, rtol=0.1)


def test_paths_go_around_the_hole():
    mesh = torus(1.0, 0.3)
    found = inner_balls(mesh)
    first, last = (int(np.argmin(np.linalg.norm(found.centers - [x, 0.0, 0.0], axis=1))) for x in (1.0, -1.0))
    length = dijkstra(found.links, indices=first)[last]
    assert 0.95 * np.pi < length < 1.25 * np.pi


def test_links_stay_inside():
    mesh = torus(1.0, 0.2)
    found = inner_balls(mesh)
    links = found.links.tocoo()
    some = np.random.default_rng(0).integers(0, links.nnz, 300)
    middles = 0.5 * (found.centers[links.row[some]] + found.centers[links.col[some]])
    assert (winding_numbers(middles, mesh) > 0.5).all()


def test_points_start_at_the_balls_that_contain_them():
    found = InnerBalls(np.array([[0.0, 0.0, 0.0], [3.0, 0.0, 0.0]]), np.ones(2), np.ones(2), np.empty((0, 2), np.int64))
    assert found.entrances(np.array([0.5, 0.0, 0.0])).tolist() == [0]
    assert found.entrances(np.array([9.0, 0.0, 0.0])).tolist() == [1]
    assert found.links.nnz == 0


def test_thin_limbs_with_long_triangles_are_connected():
    found = inner_balls(torus(1.0, 0.02, segments=(40, 6)))
    assert len(found.centers) == 240
    assert np.abs(np.hypot(found.centers[:, 0], found.centers[:, 1]) - 1.0).max() < 0.02
