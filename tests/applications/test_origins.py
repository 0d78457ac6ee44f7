# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.linalg import sqrtm

from convwass_addon.applications.morphs.origins import PartTransport, blend_origins, displacements, velocities
from convwass_addon.applications.morphs.volumes import Lattice
from convwass_addon.transport import Grid, Inputs, barycenter
from tests.shapes import even_directions
from tests.transport.ellipsoids import Ellipsoid

CELLS = 48
MIDDLE = np.full(3, CELLS / 2)


def solved_part(shapes, weights, sharpness=0.75, sigma=1.0, volume=1.0, reach=None):
    grid = Grid((CELLS,) * 3, sigma)
    densities = np.stack([shape if isinstance(shape, np.ndarray) else shape.occupancy(CELLS, 2) for shape in shapes])
    inputs = Inputs.of(densities, grid)
    # To half the usual tolerance, so that errors of the map itself are seen.
    solved = barycenter(inputs, weights, grid, sharpness=sharpness, reach=reach, tolerance=5e-3)
    return PartTransport(solved, grid, volume, reach)


def ball(center, radius):
    return Ellipsoid(np.asarray(center, float), np.eye(3) * radius)


def linear_map(one, other):
    """The matrix of the optimal map between two centered ellipsoids."""
    inverse = np.linalg.inv(one.stretch)
    return np.real(inverse @ sqrtm(one.stretch @ other.stretch @ other.stretch @ one.stretch) @ inverse)


@pytest.mark.parametrize("sharpness", [0.0, 0.75, 1.0])
def test_the_origins_of_a_moved_ball_are_on_the_inputs(sharpness):
    shift = np.array([10.0, -7.0, 4.0])
    balls = [ball(MIDDLE - shift / 2, 11.0), ball(MIDDLE + shift / 2, 11.0)]
    part = solved_part(balls, (0.7, 0.3), sharpness)
    here = balls[0].barycenter(balls[1], 0.3)
    points = even_directions(2000) * 11.0 + here.center
    moves = displacements(points, part)
    np.testing.assert_allclose(moves[0], np.broadcast_to(-0.3 * shift, points.shape), atol=0.1)
    np.testing.assert_allclose(moves[1], np.broadcast_to(0.7 * shift, points.shape), atol=0.1)


@pytest.mark.parametrize("t", [0.25, 0.5, 0.9])
def test_ellipsoids_come_from_their_linear_images(t):
    one = Ellipsoid.rotated(MIDDLE, (18.0, 9.0, 11.0), (0.3, 0.2, 0.5))
    other = Ellipsoid.rotated(MIDDLE, (9.0, 15.0, 19.0), (0.8, -0.4, 0.1))
    on_one = even_directions(2000) @ one.stretch
    on_other = on_one @ linear_map(one, other).T
    part = solved_part([one, other], (1 - t, t))
    points = (1 - t) * on_one + t * on_other + MIDDLE
    for moves, images in zip(displacements(points, part), (on_one, on_other), strict=True):
        distance = np.linalg.norm(points + moves - images - MIDDLE, axis=1)
        # The farthest matter moves six cells. The error caused by the blur is proportional to it, in cells.
        assert distance.mean() < 0.45
        assert distance.max() < 0.9


def test_a_scaled_ball_comes_from_its_scaled_place():
    part = solved_part([ball(MIDDLE, 20.0), ball(MIDDLE, 10.0)], (0.5, 0.5))
    moves = displacements(even_directions(2000) * 15.0 + MIDDLE, part)
    np.testing.assert_allclose(np.linalg.norm(moves, axis=2), 5.0, atol=0.45)
    assert (np.einsum("knd,nd->kn", moves, even_directions(2000)) * [[1], [-1]] > 4.5).all()


@settings(max_examples=5)
@given(
    st.lists(st.floats(0.05, 1.0), min_size=3, max_size=3),
    st.sampled_from([None, 10.0]),
)
def test_the_mean_of_all_origins_is_the_vertex(shares, reach):
    weights = np.array(shares) / np.sum(shares)
    shapes = [
        ball(MIDDLE + np.array([6, 0, 0]), 10.0),
        Ellipsoid.rotated(MIDDLE, (14.0, 7.0, 9.0), (0.3, 0.2, 0.5)),
        ball(MIDDLE - (0, 8, 0), 7.0),
    ]
    part = solved_part(shapes, weights, reach=reach)
    centers = np.array([[0.0, 0, 0], [10, 0, 0], [0, -4, 2]])
    lattice = Lattice((CELLS,) * 3, 0.05, np.array([-1.6, -1.6, -1.6]), centers)
    surface = np.random.default_rng(1).uniform(0, CELLS, (500, 3))
    origins = blend_origins(surface, [part], lattice, tuple(weights))
    assert origins.shape == (3, 500, 3)
    assert origins.dtype == np.float32
    vertices = surface * lattice.spacing + lattice.origin + weights @ centers
    np.testing.assert_allclose(np.tensordot(weights, origins, 1), vertices, atol=1e-5)


def test_vertices_outside_of_the_blend_go_with_the_nearest_part_of_it():
    side = np.array([7.0, 0, 0])
    balls = [ball(MIDDLE - side, 10.0), ball(MIDDLE + side, 10.0)]
    part = solved_part(balls, (0.5, 0.5))
    moves = displacements(np.array([[0.0, 0.0, 0.0], [CELLS, CELLS / 2, 0.0]]), part)
    np.testing.assert_allclose(moves[0], np.broadcast_to([-7.0, 0, 0], (2, 3)), atol=0.3)


def test_every_vertex_goes_with_the_part_that_it_is_on():
    above = np.array([0, 0, 11.0])
    up, low = MIDDLE + above, MIDDLE - above
    side = np.array([6.0, 0, 0])
    parts = [
        solved_part([ball(up - side, 8.0), ball(up + side, 8.0)], (0.5, 0.5), volume=500.0),
        solved_part([ball(low + side, 8.0), ball(low - side, 8.0)], (0.5, 0.5), volume=500.0),
    ]
    lattice = Lattice((CELLS,) * 3, 1.0, np.zeros(3), np.zeros((2, 3)))
    surface = np.concatenate([even_directions(200) * 8.0 + up, even_directions(200) * 8.0 + low])
    origins = blend_origins(surface, parts, lattice, (0.5, 0.5))
    expected = np.concatenate([np.tile(-side, (200, 1)), np.tile(side, (200, 1))])
    np.testing.assert_allclose(origins[0] - surface, expected, atol=0.1)


def test_an_input_of_no_weight_has_a_place_at_every_vertex():
    balls = [ball(MIDDLE, 10.0), ball(MIDDLE, 14.0), ball(MIDDLE, 12.0)]
    part = solved_part(balls, (0.5, 0.0, 0.5))
    centers = np.array([[0.0, 0, 0], [40, 0, 0], [0, 6, 0]])
    lattice = Lattice((CELLS,) * 3, 1.0, np.zeros(3), centers)
    surface = even_directions(100) * 11.0 + MIDDLE
    origins = blend_origins(surface, [part], lattice, (0.5, 0.0, 0.5))
    assert np.isfinite(origins).all()
    np.testing.assert_allclose(origins[1], surface + centers[1], atol=1e-4)


def test_a_grid_without_coarser_ones_will_do():
    grid = Grid((20, 18, 22), 1.0)
    densities = np.zeros((2, *grid.shape))
    densities[0, 4:12, 5:13, 6:14] = densities[1, 8:16, 5:13, 6:14] = 1.0
    inputs = Inputs.of(densities, grid)
    inputs = replace(inputs, levels=inputs.levels[-1:])
    part = PartTransport(barycenter(inputs, (0.5, 0.5), grid, sharpness=1.0), grid, 1.0)
    moves = displacements(np.array([[10.0, 9.0, 10.0], [13.0, 9.0, 10.0]]), part)
    np.testing.assert_allclose(moves[1], [[2.0, 0, 0]] * 2, atol=0.1)


def test_velocities_are_differences_of_origins():
    origins = np.array([[[0.0, 0, 0], [1, 0, 0]], [[0, 2, 0], [1, 0, 4]]], dtype=np.float32)
    np.testing.assert_allclose(velocities(origins, (-0.5, 0.5)), [[0, 1, 0], [0, 0, 2]])
