# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The detail of shapes on a surface that was read without it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from convwass_addon.geometry.deformation.upright_turns import rotation_about_z
from convwass_addon.geometry.level_sets.marching_cubes import marching_cubes
from convwass_addon.geometry.level_sets.surface_detail import DetailSource, with_detail
from convwass_addon.geometry.meshes.closest_points import ClosestPointFinder
from convwass_addon.geometry.meshes.edges import topology
from convwass_addon.geometry.meshes.facing_points import FacingShape
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.meshes.normals import triangle_normals, vertex_normals
from tests.shapes import ball, box

RADIUS = 12.0
"""Of the balls, in cells."""


def on_surface(points):
    """Half of the space about points of a surface is filled."""
    return np.full(len(points), 0.5)


def within(points):
    """All of the space about points within a solid is filled."""
    return np.ones(len(points))


def source(mesh, weight, starts, filled=on_surface):
    return DetailSource(FacingShape(mesh), weight, starts, np.ones(len(starts)), filled)


def alone(surface, mesh, filled=on_surface, amount=1.0):
    return with_detail(surface, [source(mesh, 1.0, surface.vertices, filled)], 1.0, amount, mesh.volume)


def scaled(mesh, factors):
    return TriangleMesh(mesh.vertices * factors, mesh.faces)


def away(mesh, points):
    return ClosestPointFinder(mesh.corners).find(points).distances


@pytest.fixture(scope="module")
def smooth():
    return ball(RADIUS, points=2500)


@pytest.fixture(scope="module")
def bumpy():
    """Bumps of half a cell between highest and lowest, two cells wide."""
    mesh = ball(RADIUS, points=12_000)
    bumps = 0.25 * np.sin(1.5 * mesh.vertices).prod(axis=1, keepdims=True)
    return scaled(mesh, 1.0 + bumps / RADIUS)


def test_bumps_are_laid_onto_a_smooth_ball(smooth, bumpy):
    found = alone(smooth, bumpy)
    assert away(smooth, bumpy.vertices).mean() > 0.06
    assert away(found.mesh, bumpy.vertices).mean() < 0.02
    assert topology(found.mesh) == topology(smooth)
    assert found.mesh.volume == pytest.approx(bumpy.volume, rel=1e-3)
    on_shape = found.places[0].interpolated(bumpy.corners)
    np.testing.assert_allclose(found.mesh.vertices, on_shape, atol=0.03)


def test_where_there_is_no_detail_nothing_changes(smooth):
    found = alone(smooth, smooth)
    np.testing.assert_array_equal(found.mesh.faces, smooth.faces)
    np.testing.assert_allclose(found.mesh.vertices, smooth.vertices, atol=1e-9)


def test_a_surface_with_bumps_gets_more_triangles_than_it_had_and_not_too_many(smooth, bumpy):
    found = alone(smooth, bumpy).mesh
    assert 1.2 * len(smooth.faces) < len(found.faces) < 3.01 * len(smooth.faces)


def test_the_highest_bumps_get_the_triangles_where_there_are_not_enough(smooth):
    even = ball(RADIUS, points=12_000)
    heights = np.where(even.vertices[:, [2]] > 0.0, 1.0, 0.25)
    bumpy_above = scaled(even, 1.0 + heights * np.sin(3.0 * even.vertices).prod(axis=1, keepdims=True) / RADIUS)
    found = alone(smooth, bumpy_above).mesh
    assert len(found.faces) == 3 * len(smooth.faces)
    added = found.vertices[len(smooth.vertices) :]
    assert np.mean(added[:, 2] > 0.0) > 0.6


def test_offsets_are_added_with_the_weights(smooth):
    """One shape lies a half above its reading and the other a quarter below: with 1/4 and 3/4 that is -1/16."""
    shapes = [scaled(smooth, 1.0 + height / RADIUS) for height in (0.5, -0.25)]
    sources = [source(shape, w, smooth.vertices) for shape, w in zip(shapes, (0.25, 0.75), strict=True)]
    expected = scaled(smooth, 1.0 - 0.0625 / RADIUS)
    found = with_detail(smooth, sources, 1.0, 1.0, expected.volume).mesh
    assert away(expected, found.vertices).max() < 0.005


def test_offsets_from_places_that_are_half_known_are_halved(smooth):
    larger, half = (scaled(smooth, 1.0 + height / RADIUS) for height in (0.5, 0.25))
    halves = np.full(len(smooth.vertices), 0.5)
    for name in ("certainty", "reliability"):
        unsure = replace(source(larger, 1.0, smooth.vertices), **{name: halves})
        found = with_detail(smooth, [unsure], 1.0, 1.0, half.volume).mesh
        assert away(half, found.vertices).max() < 0.005


def test_half_of_the_detail_is_half_of_the_offset(smooth):
    larger, half = (scaled(smooth, 1.0 + height / RADIUS) for height in (0.5, 0.25))
    found = with_detail(smooth, [source(larger, 1.0, smooth.vertices)], 1.0, 0.5, half.volume).mesh
    assert away(half, found.vertices).max() < 0.005


@pytest.mark.parametrize(("height", "filled"), [(-0.5, within), (3.0, on_surface)])
def test_inner_shells_and_what_is_far_away_are_no_detail(smooth, height, filled):
    shape = scaled(smooth, 1.0 + height / RADIUS)
    found = with_detail(smooth, [source(shape, 1.0, smooth.vertices, filled)], 1.0, 1.0, smooth.volume).mesh
    np.testing.assert_allclose(found.vertices, smooth.vertices, atol=1e-9)


def test_sharp_edges_become_edges_of_the_surface():
    """A ball that is squeezed towards a cube is rounder than the cube by less than a cell."""
    cube = box((2 * RADIUS,) * 3)
    round_ball = ball(1.0, points=4000)
    cubed = np.sign(round_ball.vertices) * np.abs(round_ball.vertices) ** 0.12
    rounded = TriangleMesh(RADIUS * cubed / np.abs(cubed).max() * 0.99, round_ball.faces)
    found = alone(rounded, cube).mesh
    near_edge = (np.abs(found.vertices) > RADIUS - 0.05).sum(axis=1) >= 2
    assert near_edge.sum() > 100
    assert away(cube, found.vertices).max() < 0.3
    assert (
        np.quantile(away(found, sampled_edges(cube)), 0.9) < 0.1 < np.quantile(away(rounded, sampled_edges(cube)), 0.1)
    )


def sampled_edges(cube):
    """Points on the edges of a cube, none next to a corner."""
    along = np.linspace(-0.8, 0.8, 33) * RADIUS
    points = []
    for axis in range(3):
        for one in (-RADIUS, RADIUS):
            for other in (-RADIUS, RADIUS):
                edge = np.insert(np.full((len(along), 2), (one, other)), axis, along, axis=1)
                points.append(edge)
    return np.concatenate(points)


def test_no_triangle_is_turned_over(smooth):
    """Bumps steeper than the ball's triangles can follow."""
    rng = np.random.default_rng(5)
    rough = TriangleMesh(smooth.vertices + 0.6 * rng.standard_normal(smooth.vertices.shape), smooth.faces)
    found = alone(smooth, rough).mesh
    outward = np.einsum("md,md->m", triangle_normals(found.corners), found.corners.mean(axis=1))
    assert (outward > 0.0).all()


ROUNDING = 2.0
"""Radius of the rounded edges of a box's reading, in cells."""


@pytest.fixture(scope="module")
def turned():
    """A box that is turned by 5 degrees, its axes, and a reading of it with rounded edges."""
    size, turn, counts = np.array([20.0, 20.0, 30.0]), np.radians(5.0), np.array([15, 15, 19])
    axes = rotation_about_z(turn).T
    cells = np.moveaxis(np.indices(2 * counts + 1), 0, -1) - counts
    beyond = np.abs(cells @ axes.T) - (0.5 * size - ROUNDING)
    depth = ROUNDING - np.linalg.norm(np.maximum(beyond, 0.0), axis=-1) - np.minimum(beyond.max(axis=-1), 0.0)
    return box(size, angles=(0.0, 0.0, turn)), axes, marching_cubes(depth.astype(np.float32), 0.0).moved(-counts)


def test_edges_stay_straight_where_rows_of_cells_pass_from_one_side_to_the_other(turned):
    """Some triangles have all corners on an edge of the sharp box."""
    mesh, axes, surface = turned
    found = alone(surface, mesh).mesh
    along = np.linspace(-7.0, 7.0, 57)
    for side in (-10.0, 10.0):
        edge = np.stack([np.full(57, side), along, np.full(57, 15.0)], axis=1) @ axes
        assert away(surface, edge).min() > 0.7
        assert away(found, edge).max() < 0.15


def test_vertices_are_on_the_points_and_triangles_that_belong_to_them(turned):
    """Only at the edges of the box folds are removed and triangles reach around."""
    mesh, _, surface = turned
    found = alone(surface, mesh)
    on_shape = found.places[0].interpolated(mesh.corners)
    assert np.quantile(np.linalg.norm(found.mesh.vertices - on_shape, axis=1), 0.99) < 0.05
    below = triangle_normals(mesh.corners)[found.triangles[0]]
    facing = np.einsum("md,md->m", triangle_normals(found.mesh.corners), below)
    assert found.mesh.face_areas[facing > 0.9].sum() > 0.99 * found.mesh.area


def test_points_deep_below_an_edge_belong_to_the_edge(turned):
    """The closest points of the box are on either side of the edge, a cell and more away from it."""
    mesh, axes, surface = turned
    normals = vertex_normals(surface.vertices, surface.faces)
    starts = surface.vertices - 0.7 * normals
    found = with_detail(surface, [source(mesh, 1.0, starts)], 1.0, 1.0, mesh.volume)
    below = np.flatnonzero((normals @ axes.T @ [1.0, 1.0, 0.0] > 1.41) & (np.abs(surface.vertices[:, 2]) < 10.0))
    assert len(below) > 10
    to_edge = np.linalg.norm((found.places[0].interpolated(mesh.corners)[below] @ axes.T)[:, :2] - 10.0, axis=1)
    assert np.linalg.norm((starts[below] @ axes.T)[:, :2] - 10.0, axis=1).min() > 1.4
    assert to_edge.max() < 0.8
