# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Colors of live blends: on coarse cells, at points of shapes, and of whole blends whose colors are known."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.live.color_fields import CELL, ColorField, centers_of, mixed_colors, places_about
from convwass_addon.applications.live.field_sources import MovingSource
from convwass_addon.applications.live.level_fields import colors_at, mixed
from convwass_addon.applications.live.live_blends import FADE, LiveBlends
from convwass_addon.applications.live.live_settings import LiveSettings
from convwass_addon.applications.live.live_shapes import LiveShapes
from convwass_addon.applications.live.shape_colors import ShapeColors
from convwass_addon.applications.morphs.appearance import Appearance, Painted, Plain
from convwass_addon.applications.morphs.layouts import path_blends
from convwass_addon.applications.morphs.morph_inputs import MorphInputs
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.applications.morphs.moving_problem import MovingProblem
from convwass_addon.applications.morphs.part_labels import unparted
from convwass_addon.applications.morphs.preparing import prepared_problem
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.progress import Control, drained
from tests.applications.live.test_live_blends import CENTERS, RADII, Clock
from tests.applications.test_moving_problem import ANGLE, NAMES, SHAPES, Turning, turned
from tests.shapes import ball

RED, BLUE = (1.0, 0.1, 0.0, 1.0), (0.0, 0.1, 1.0, 1.0)


def painted(mesh: TriangleMesh, colors: np.ndarray) -> Appearance:
    """Return the appearance of a mesh with colors of its vertices, (n, 4)."""
    corners = colors[mesh.faces].astype(np.float32)
    return Appearance(mesh.corners, np.zeros(len(mesh.faces), np.int64), (Painted(corners),), mesh.faces)


def plain(mesh: TriangleMesh, color: tuple[float, float, float, float]) -> Appearance:
    return Appearance(mesh.corners, np.zeros(len(mesh.faces), np.int64), (Plain(color),), mesh.faces)


def by_height(mesh: TriangleMesh, center: np.ndarray, height: float) -> Appearance:
    """Return colors that rise linearly from 0 to 1 along the Z axis."""
    share = 0.5 + (mesh.vertices[:, 2:] - center[2]) / height
    return painted(mesh, np.hstack([share, share, share, np.ones_like(share)]))


@pytest.mark.parametrize("low", [(0, 0, 0), (-3, 4, 5), (2, -7, 1)])
def test_places_are_the_coarse_cells_about_cells(low):
    inside = np.zeros((5, 6, 4), bool)
    inside[0, 2, 3] = inside[4, 5, 0] = True
    cells = np.argwhere(inside) + low
    near = {tuple(cell // CELL + step) for cell in cells for step in np.ndindex(3, 3, 3)}
    expected = {tuple(int(n) - 1 for n in place) for place in near}
    found = places_about(inside, np.array(low))
    assert {tuple(place) for place in found.tolist()} == expected and len(found) == len(expected)


def test_colors_between_coarse_cells_are_interpolated():
    places = np.argwhere(np.ones((6, 5, 4), bool)).astype(np.int32) - 3
    slopes = np.array([[0.5, 0.0, 0.0], [0.0, 0.25, 0.0], [0.0, 0.0, 0.125]])
    field = ColorField(places, (centers_of(places) @ slopes).astype(np.float16))
    points = np.random.default_rng(1).uniform(-4.0, 0.0, (50, 3))
    np.testing.assert_allclose(mixed_colors([field], [1.0], points), points @ slopes, atol=1e-6)


def test_fields_that_do_not_know_a_place_take_no_part():
    known = ColorField(np.array([[0, 0, 0], [1, 0, 0]], np.int32), np.ones((2, 3), np.float16))
    other = ColorField(np.array([[0, 0, 0]], np.int32), np.zeros((1, 3), np.float16))
    both, alone = mixed_colors([known, other], [0.25, 0.75], centers_of(known.places))[:, 0]
    assert (both, alone) == (0.25, 1.0)


def test_colors_are_found_near_samples_and_move_with_the_shape():
    rod, angle = SHAPES[0], ANGLE / 3.0
    share = (rod.vertices[:, :1] + 2.0) / 4.0
    colors = ShapeColors.of(painted(rod, np.hstack([share, share, share, np.ones_like(share)])))
    points = rod.corners.mean(axis=1)
    np.testing.assert_allclose(colors.near(points)[:, 0], (points[:, 0] + 2.0) / 4.0, atol=0.03)
    moved = Turning().moved((1.0 - angle / ANGLE, angle / ANGLE))[0]
    along = turned(TriangleMesh(points, rod.faces[:1]), angle).vertices
    np.testing.assert_allclose(colors.moved(moved).near(along)[:, 0], (points[:, 0] + 2.0) / 4.0, atol=0.03)


@pytest.fixture(scope="module")
def filled() -> LiveBlends:
    """Return a lattice of two balls, one red, one blue."""
    meshes = tuple(ball(radius, center, 400) for radius, center in zip(RADII, CENTERS, strict=True))
    looks = tuple(plain(mesh, color) for mesh, color in zip(meshes, (RED, BLUE), strict=True))
    shapes = LiveShapes(MorphInputs.of(meshes, ("one", "other")), appearances=looks)
    clock = Clock()
    live = LiveBlends(shapes, MorphSettings(motion="transport"), LiveSettings(live_resolution=24), clock)
    drained(live.work(Control()))
    clock.now = 2 * FADE
    return live


@pytest.mark.parametrize("share", [0.0, 0.37, 1.0])
def test_plain_colors_are_mixed_by_the_weights(filled, share):
    filled.point((1.0 - share, share))
    expected = (1.0 - share) * np.array(RED[:3]) + share * np.array(BLUE[:3])
    shown = filled.shown()
    assert not shown.is_solved and shown.colors.shape == shown.mesh.vertices.shape
    np.testing.assert_allclose(shown.colors, np.tile(expected, (len(shown.colors), 1)), atol=2e-3)
    filled.rest()
    drained(filled.work(Control()))
    shown = filled.shown()
    assert shown.is_solved
    np.testing.assert_allclose(shown.colors, np.tile(expected, (len(shown.colors), 1)), atol=1e-5)


@pytest.mark.parametrize("cells", [32, 72])
def test_colors_of_transported_matter_stay_in_their_places(cells):
    meshes = tuple(ball(radius, center, 400) for radius, center in zip(RADII, CENTERS, strict=True))
    looks = [
        by_height(mesh, np.array(center), 2 * radius)
        for mesh, center, radius in zip(meshes, CENTERS, RADII, strict=True)
    ]
    shapes = LiveShapes(MorphInputs.of(meshes, ("one", "other")), appearances=tuple(looks))
    live = LiveBlends(shapes, MorphSettings(motion="transport"), LiveSettings(live_resolution=cells))
    work = live.work(Control())
    while live.shown() is None:
        next(work)
    work.close()
    # Concentric balls are scaled by transport: the color depends on the relative height.
    shown = live.shown()
    height = shown.mesh.vertices[:, 2]
    expected = 0.5 + 0.5 * height / height.max()
    np.testing.assert_allclose(shown.colors[:, 0], expected, atol=0.08)
    assert abs(shown.colors[:, 0] - expected).mean() < 0.02


def test_colors_of_moved_shapes_move_with_them():
    still = drained(prepared_problem(MorphInputs.of(SHAPES, NAMES), MorphSettings(resolution=48, on_floor=False), 1))
    problem = MovingProblem.of(still, Turning(), path_blends(2, 4), NAMES, unparted(2), Control())
    colors = []
    for mesh, angle in zip(SHAPES, (0.0, ANGLE), strict=True):
        along = turned(mesh, -angle).vertices[:, :1]
        share = 0.5 + along / (2.0 * np.abs(along).max())
        colors.append(ShapeColors.of(painted(mesh, np.hstack([share, share, share, np.ones_like(share)]))))
    field = MovingSource(problem, colors).field((0.7, 0.3))
    surface = mixed([field], [1.0]).surface()
    placed = still.lattice.to_scene(surface, np.array((0.7, 0.3)))
    along = turned(placed, -0.3 * ANGLE).vertices[:, 0]
    found = colors_at([field], [1.0], surface.vertices)[:, 0]
    np.testing.assert_allclose(found, 0.5 + along / (2.0 * np.abs(along).max()), atol=0.06)
