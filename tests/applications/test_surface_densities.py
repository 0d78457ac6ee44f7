# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, strategies as st

from convwass_addon.applications import memory
from convwass_addon.applications.densities.density_settings import DensitySettings
from convwass_addon.applications.densities.surface_densities import (
    blur_notice,
    blur_of,
    density_figures,
    density_surface,
    distribution,
    heat_map,
)
from convwass_addon.errors import InputError, ResourceError
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from tests.transport.sheets import sheet_mesh
from tests.transport.spheres import icosphere

SHEET = sheet_mesh(20, 20)
"""A square of 20 by 20 units, 441 vertices."""


def with_loose_vertices(mesh, count=3):
    """The mesh with a few additional vertices that no face uses."""
    return TriangleMesh.from_arrays(np.concatenate([mesh.vertices, np.full((count, 3), 7.0)]), mesh.faces)


SURFACE = density_surface(with_loose_vertices(SHEET), 2.0)


def test_blur_is_a_standard_deviation_in_scene_units():
    """A unit mass at the center of a large sheet has that deviation after one application of the kernel."""
    mesh = sheet_mesh(40, 40)
    for scale in (1.0, 30.0):
        surface = density_surface(TriangleMesh(scale * mesh.vertices, mesh.faces), 2.0 * scale)
        assert blur_of(surface) == pytest.approx(2.0 * scale)
        middle = 20 * 41 + 20
        density = np.zeros(surface.shape)
        density[middle] = 1.0 / surface.weights[middle]
        mass = surface.apply(density) * surface.weights
        away = mesh.vertices - mesh.vertices[middle]
        assert mass.sum() == pytest.approx(1.0)
        # Measured 3.944: the first time steps see only a single vertex and its edges.
        np.testing.assert_allclose(mass @ away[:, :2] ** 2, 4.0, rtol=0.02)


def test_the_default_blur_depends_on_the_mesh():
    mesh = icosphere(3)
    surface = density_surface(mesh, substeps=7)
    assert surface.gamma == pytest.approx(max(0.01, 0.7 * surface.mean_edge_length))
    assert surface.steps == 7


@pytest.mark.parametrize(
    ("blur", "message"),
    [
        (0.9, "finer than the mesh can carry.*edges are 1.1.*at least 1.1"),
        (21.0, "longer than the whole surface is wide .20"),
        (-1.0, "positive length"),
        (0.0, "positive length"),
        (np.nan, "positive length"),
    ],
)
def test_impossible_blurs_are_refused_with_numbers(blur, message):
    with pytest.raises(InputError, match=message):
        density_surface(SHEET, blur)


def test_a_blur_of_few_edges_is_reported():
    assert "edges of 1.1" in str(blur_notice(density_surface(SHEET, 1.5)))
    assert blur_notice(density_surface(SHEET, 2.5)) is None


def test_a_mesh_without_area_is_refused():
    with pytest.raises(InputError, match="no area"):
        density_surface(TriangleMesh.from_arrays([(0, 0, 0), (1, 0, 0), (2, 0, 0)], [(0, 1, 2)]), 0.1)


def test_more_vertices_than_memory_are_refused(monkeypatch):
    monkeypatch.setattr(memory, "available_memory", lambda: 100_000)
    with pytest.raises(ResourceError, match="441 vertices"):
        density_surface(SHEET)


def test_weights_become_mass_by_area():
    """Uniform weights on a sheet give the uniform density, although vertices at the rim have less area."""
    density = distribution(np.full(SURFACE.shape, 0.3), SURFACE, "all")
    np.testing.assert_allclose(density[:-3], 1.0)
    np.testing.assert_array_equal(density[-3:], 0.0)


@given(st.floats(1e-300, 1e300), st.integers(0, 2**32))
def test_scale_does_not_matter(scale, seed):
    weights = np.random.default_rng(seed).random(SURFACE.shape)
    weights[weights < 0.5] = 0.0
    density = distribution(weights, SURFACE, "group")
    assert density @ SURFACE.weights == pytest.approx(1.0)
    np.testing.assert_allclose(distribution(scale * weights, SURFACE, "group"), density, rtol=1e-9)
    np.testing.assert_allclose(distribution(density, SURFACE, "group"), density, rtol=1e-12)


def painted(values):
    weights = np.zeros(SURFACE.shape)
    for vertex, value in values.items():
        weights[vertex] = value
    return weights


@pytest.mark.parametrize(
    ("weights", "message"),
    [
        (painted({}), "Moss is empty; paint"),
        (painted({4: 1.0, 5: -0.25}), "Moss has negative weights, down to -0.25 .vertices: 1, the first is 5"),
        (painted({4: np.nan, 9: np.inf}), "Moss has weights that are not numbers .vertices: 2, the first is 4"),
        (painted({-1: 1.0, -2: 0.5}), "Moss has weight on loose vertices only"),
        (np.ones(7), "Moss has 7 weights and the mesh 444 vertices"),
    ],
)
def test_weights_that_are_no_distribution_are_refused_by_name(weights, message):
    with pytest.raises(InputError, match=message):
        distribution(weights, SURFACE, "Moss")


def test_figures_of_a_disc():
    """A uniform disc of radius 6 at the center of the sheet: its radius, its fraction of the area, its entropy."""
    away = np.linalg.norm(SURFACE.positions[:, :2] - 10.0, axis=1)
    figures = density_figures(np.where(away < 6.2, 0.4, 0.0), SURFACE, "disc")
    assert figures.radius == pytest.approx(6.0, rel=0.05)
    assert figures.covered == pytest.approx(np.pi * figures.radius**2 / 400)
    assert figures.entropy == pytest.approx(np.log(figures.covered))
    assert figures.loose == 3
    assert density_figures(painted({0: 1.0, -1: 1.0}), SURFACE, "corner").loose == 1


def test_heat_maps_state_their_scale():
    density = distribution(painted({40: 1.0, 41: 3.0}), SURFACE, "group")
    shown = heat_map(density)
    assert shown.weights.max() == 1.0
    np.testing.assert_allclose(shown.weights * shown.scale, density)
    assert not heat_map(np.zeros(5)).weights.any()


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"steps": 0}, "Steps"),
        ({"steps": 2.5}, "whole number"),
        ({"blur": -1.0}, "Blur"),
        ({"blur": np.inf}, "Blur"),
        ({"entropy_limit": "most"}, "Entropy Limit"),
        ({"entropy_limit": np.nan}, "Entropy Limit"),
        ({"entropy_limit": True}, "Entropy Limit"),
        ({"blend_sharpness": 1.5}, "sharpness"),
        ({"pieces": "drop"}, "Pieces"),
        ({"tolerance": 0.0}, "Tolerance"),
        ({"max_iterations": 0}, "iteration"),
        ({"substeps": 0}, "Substeps"),
    ],
)
def test_invalid_settings_are_refused(settings, message):
    with pytest.raises(InputError, match=message):
        DensitySettings(**settings)


def test_settings_are_listed_as_a_table():
    assert DensitySettings(steps=5, entropy_limit=-2.0).as_dict() == {
        "steps": 5,
        "blur": None,
        "entropy_limit": -2.0,
        "blend_sharpness": 0.75,
        "pieces": "keep",
        "tolerance": 1e-2,
        "max_iterations": 500,
        "substeps": 10,
    }
