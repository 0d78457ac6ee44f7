# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Rims of thin shapes that a surface at a coarse resolution does not reach."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import map_coordinates

from convwass_addon.applications.morphs.coinciding_solids import CoincidingSolids
from convwass_addon.applications.morphs.extraction import connectivity_of, extract_coinciding
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.geometry.algebra.rotation_fields import rotation_matrices
from convwass_addon.geometry.level_sets import surface_detail
from convwass_addon.geometry.level_sets.missed_rims import MissedRims, missed_rims
from convwass_addon.geometry.level_sets.surface_detail import DetailSource, with_detail
from convwass_addon.geometry.meshes.facing_points import FacingShape
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.solids.occupancy import occupancy
from tests.shapes import ball

RADIUS = 20.0
"""Of the lenses, in cells."""
TURN = rotation_matrices(np.array([[0.4, 0.5, 0.2]]))[0]
CENTER = np.array([24.3, 24.1, 23.8])


def lens(half_thickness, points=12_000):
    """A flat ellipsoid, tilted in a grid of 48 cells."""
    mesh = ball(RADIUS, points=points)
    return TriangleMesh(mesh.vertices * (1.0, 1.0, half_thickness / RADIUS) @ TURN.T + CENTER, mesh.faces)


def rim_radii(mesh):
    """The largest distance from the axis of a lens in every direction, in steps of three degrees, (120,)."""
    x, y, _ = ((mesh.vertices - CENTER) @ TURN).T
    sectors = (np.arctan2(y, x) // np.radians(3.0)).astype(int) + 60
    farthest = np.zeros(121)
    np.maximum.at(farthest, sectors, np.hypot(x, y))
    return farthest[:120]


def coarse_surface(filled):
    """The surface of a shape as blends show it, without its detail."""
    volume, settings = float(filled.sum()), MorphSettings()
    solids = CoincidingSolids.of([filled, filled], [0.5, 0.5], volume)
    return extract_coinciding(solids, volume, [connectivity_of(filled, settings)], settings).surface.mesh


def detailed(coarse, filled, weights):
    """A coarse surface with the detail of some meshes, which are given with their weights."""

    def around(points):
        return map_coordinates(filled, points.T - 0.5, order=1, mode="nearest")

    certainty = np.ones(len(coarse.vertices))
    sources = [DetailSource(FacingShape(mesh), weight, coarse.vertices, certainty, around) for mesh, weight in weights]
    return with_detail(coarse, sources, 1.0, 1.0, coarse.volume).mesh


@pytest.mark.parametrize(("half_thickness", "error"), [(1.5, 0.15), (2.5, 0.02)])
def test_detail_extends_the_surface_to_a_sharp_rim(half_thickness, error):
    shape = lens(half_thickness)
    filled = occupancy(shape.corners, (48, 48, 48))
    coarse = coarse_surface(filled)
    before, after = rim_radii(coarse), rim_radii(detailed(coarse, filled, [(shape, 1.0)]))
    assert before.mean() < RADIUS - 0.4
    assert after.mean() == pytest.approx(RADIUS, abs=error)
    # A rim that is reached only here and there is serrated.
    assert np.quantile(after, 0.05) >= RADIUS - 0.5
    assert np.quantile(after, 0.05) > np.quantile(before, 0.05) + 0.5


@pytest.mark.parametrize(("weight", "sharp"), [(0.5, False), (0.7, True)])
def test_only_rims_of_most_of_a_blend_are_sharp(monkeypatch, weight, sharp):
    """A blend of a lens and of its coarse surface, which has no rim beyond."""
    shape = lens(1.5)
    filled = occupancy(shape.corners, (48, 48, 48))
    coarse = coarse_surface(filled)
    weights = (shape, weight), (coarse, 1.0 - weight)
    with_rims = detailed(coarse, filled, weights)
    none = MissedRims(np.empty(0, np.int64), np.empty((0, 3)))
    monkeypatch.setattr(surface_detail, "missed_rims", lambda *_arguments: none)
    without = detailed(coarse, filled, weights)
    assert np.array_equal(with_rims.vertices, without.vertices) is not sharp
    if sharp:
        assert rim_radii(with_rims).mean() > rim_radii(without).mean() + 0.05


def ring(radius, count=60):
    """Points on a circle in the plane of a lens, and their directions away from its axis."""
    angles = 2.0 * np.pi * np.arange(count) / count
    directions = np.stack([np.cos(angles), np.sin(angles), np.zeros(count)], axis=1)
    return radius * directions @ TURN.T + CENTER, directions @ TURN.T


@pytest.mark.parametrize(
    ("radius", "fraction", "found"),
    [
        (18.5, 0.5, True),
        pytest.param(19.8, 0.5, False, id="reached"),
        pytest.param(16.0, 0.5, False, id="missing altogether"),
        pytest.param(18.5, 0.9, False, id="inside"),
    ],
)
def test_points_on_the_rim_belong_to_the_vertices_next_to_it(radius, fraction, found):
    def filled(points):
        x, y, _ = ((points - CENTER) @ TURN).T
        return np.where(np.hypot(x, y) > RADIUS - 0.2, 0.1, fraction)

    starts, normals = ring(radius)
    rims = missed_rims(lens(1.0), starts, normals, 1.0, filled)
    assert len(rims.vertices) == (len(starts) if found else 0)
    x, y, z = ((rims.points - CENTER) @ TURN).T
    np.testing.assert_allclose(np.hypot(x, y), RADIUS, atol=0.05)
    assert np.abs(z).max(initial=0.0) < 0.1
    # Each is next to its own vertex: at most half of the distance between two of them beside it.
    beside = np.abs(np.einsum("nd,nd->n", np.cross(rims.points - CENTER, normals[rims.vertices]), TURN[:, [2]].T))
    assert beside.max(initial=0.0) <= np.pi * RADIUS / len(starts) + 0.1


@pytest.mark.parametrize("doubled", [False, True])
def test_samples_between_distant_vertices_are_found_too(doubled):
    """A square plate of a few large triangles, also with edges of length zero: its rim lies along four long edges."""
    corners = np.array([[x, y, z] for x in (0.0, 40.0) for y in (0.0, 40.0) for z in (-0.2, 0.2)])
    plate = TriangleMesh(corners, FACES)
    if doubled:
        again = np.array([[0, 0, 8], [3, 11, 3], [5, 13, 13]])
        plate = TriangleMesh(np.concatenate([corners, corners]), np.concatenate([again, FACES, FACES + 8]))
    places = np.linspace(5.0, 35.0, 16)
    starts = np.stack([np.full(16, 39.0), places, np.zeros(16)], axis=1)
    normals = np.tile((1.0, 0.0, 0.0), (16, 1))
    asked = []

    def filled(points):
        asked.append(points)
        return np.where(points[:, 0] > 39.5, 0.1, 0.5)

    rims = missed_rims(plate, starts, normals, 1.0, filled)
    assert asked[0].min() >= -0.2
    assert asked[0].max() <= 40.0
    np.testing.assert_array_equal(rims.vertices, np.arange(16))
    np.testing.assert_allclose(rims.points[:, 0], 40.0)
    np.testing.assert_allclose(rims.points[1:-1, 1], places[1:-1], atol=1.0)


FACES = np.array(
    [
        *[(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5)],
        *[(0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6)],
        *[(0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)],
    ]
)
"""The triangles of a box with its corners in order."""
