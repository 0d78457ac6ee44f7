# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Inside and outside of bodies, and the nearest point inside."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.solids.solid_angles import Inside, winding_numbers
from tests.shapes import ball, box, joined, torus, with_faces


def test_winding_numbers_count_the_surrounding_solids():
    mesh = joined(box(), box(center=(0.4, 0.0, 0.0)))
    points = [[-0.3, 0.0, 0.0], [0.2, 0.1, 0.1], [2.0, 0.0, 0.0]]
    np.testing.assert_allclose(winding_numbers(points, mesh), [1.0, 2.0, 0.0], atol=1e-12)


def test_many_points_equal_single_points():
    mesh = torus(segments=(30, 20))
    points = np.random.default_rng(0).uniform(-1.5, 1.5, (500, 3))
    expected = [winding_numbers(point, mesh)[0] for point in points]
    np.testing.assert_allclose(winding_numbers(points, mesh), expected, atol=1e-12)


@pytest.mark.parametrize("sides", [1, 2, 5])
def test_a_side_of_a_cube_is_a_sixth_of_all_directions(sides):
    np.testing.assert_allclose(winding_numbers(np.zeros(3), with_faces(box(), slice(0, 2 * sides))), sides / 6)


def test_open_bodies_have_an_inside():
    mesh = ball()
    open_ball = with_faces(mesh, mesh.corners[..., 2].max(axis=1) < 0.8)
    assert Inside(open_ball).contains([[0.0, 0.0, 0.0], [0.0, 0.0, 2.0]]).tolist() == [True, False]


def test_the_nearest_point_inside_is_at_the_given_depth():
    inside = Inside(box())
    found = inside.nearest([[0.9, 0.1, 0.2], [0.5, 0.0, 0.0]], 0.1)
    np.testing.assert_allclose(found.positions, [[0.4, 0.1, 0.2], [0.4, 0.0, 0.0]], atol=1e-6)
    assert found.found.all()


def test_thin_bodies_are_entered_up_to_their_middle():
    found = Inside(box(size=(1.0, 1.0, 0.02))).nearest([[0.1, 0.2, 1.0]], 0.1)
    np.testing.assert_allclose(found.positions, [[0.1, 0.2, 0.0]], atol=1e-5)


@pytest.mark.parametrize("mesh", [torus(), ball(), box(angles=(0.4, 0.2, 0.9))], ids=["torus", "ball", "box"])
def test_all_points_have_a_nearest_point_inside(mesh):
    inside = Inside(mesh)
    points = np.random.default_rng(1).uniform(-2.0, 2.0, (60, 3))
    found = inside.nearest(points, 0.05)
    assert found.found.all()
    assert inside.contains(found.positions).all()
    assert np.linalg.norm(found.positions - points, axis=1).max() < inside.distances(points).max() + 0.15


def test_without_an_inside_there_is_none():
    flat = with_faces(box(), [0])
    found = Inside(flat).nearest([[0.0, 0.0, 2.0]], 0.1)
    assert not found.found.any()
    np.testing.assert_array_equal(found.positions, [[0.0, 0.0, 2.0]])
