# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Lengths of maps compared with the Wasserstein distance."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from convwass_addon.applications.registrations.map_detour import map_detour
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from tests.shapes import ball, joined

LONG = TriangleMesh(ball(points=3000).vertices * (3.0, 1.0, 1.0), ball(points=3000).faces)


def mapped(first, second):
    """The detour between meshes of the same triangles whose vertices correspond."""
    return map_detour((first, second), (second.vertices, first.vertices))


def moved(mesh, points):
    return TriangleMesh(points, mesh.faces)


def test_a_growing_body_makes_no_detour():
    """The map x -> 1.3 x + b is the gradient of a convex function, so it is the shortest one."""
    assert mapped(LONG, moved(LONG, 1.3 * LONG.vertices + (5.0, 0.0, 1.0))) == pytest.approx(1.0, abs=0.05)


def test_pieces_that_change_places_travel_as_far_as_they_are_apart():
    """Two small balls at distance d from their middle grow; exchanging them moves both by 2 d."""
    small, distance, growth = ball(0.3, points=800), 2.0, 2.0
    one, other = (
        joined(*(moved(small, factor * small.vertices + (side * distance, 0.0, 0.0)) for side in (-1.0, 1.0)))
        for factor in (1.0, growth)
    )
    exchanged = np.roll(other.vertices, len(small.vertices), axis=0), np.roll(one.vertices, len(small.vertices), axis=0)
    growing = 0.3 * (growth - 1.0)
    expected = np.hypot(2.0 * distance, growing) / growing
    assert map_detour((one, other), exchanged) == pytest.approx(expected, rel=0.05)
    assert mapped(one, other) == pytest.approx(1.0, abs=0.05)


def test_a_body_that_turns_over_makes_a_detour():
    """Half a turn about the y axis maps (x, y, z) to 1.3 (-x, y, -z), where 1.3 (x, y, z) is nearest."""
    other = moved(LONG, 1.3 * LONG.vertices)
    over = Rotation.from_rotvec((0.0, np.pi, 0.0)).as_matrix()
    images = other.vertices @ over.T, LONG.vertices @ over.T
    spread = LONG.vertex_areas @ np.square(LONG.vertices)
    expected = np.sqrt((2.3**2 * (spread[0] + spread[2]) + 0.3**2 * spread[1]) / (0.3**2 * spread.sum()))
    assert map_detour((LONG, other), images) == pytest.approx(expected, rel=0.05)


def test_a_map_of_a_body_to_itself_makes_no_detour():
    assert mapped(LONG, LONG) == 1.0
    assert mapped(LONG, LONG.moved((5.0, 0.3, 0.0))) == 1.0
