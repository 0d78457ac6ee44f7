# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Special handling of meshes with very many vertices: more frequent progress, and cancelling anywhere."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.densities import density_preparing
from convwass_addon.applications.densities.density_measures import measuring_steps
from convwass_addon.applications.densities.density_paths import interpolation_steps
from convwass_addon.applications.densities.density_settings import DensitySettings
from convwass_addon.applications.densities.surface_densities import density_surface
from convwass_addon.applications.soft_maps.map_sides import MapSide
from convwass_addon.applications.soft_maps.map_solving import soft_map_steps
from convwass_addon.errors import Cancelled
from convwass_addon.geometry.solids.occupancy import occupancy
from convwass_addon.progress import UNINTERRUPTED
from convwass_addon.transport import mesh_levels
from tests.controls import CountingControl, recorded
from tests.shapes import ball
from tests.transport.spheres import cap, icosphere, sphere

MESH = icosphere(4)
ENDS = cap(sphere(4, 0.01), 0.0), cap(sphere(4, 0.01), 1.0)
SETTINGS = DensitySettings(steps=4)


@pytest.fixture
def all_is_large(monkeypatch):
    """Treat every surface as large, with coarser levels."""
    monkeypatch.setattr(density_preparing, "LARGE", 1)
    monkeypatch.setattr(density_preparing, "DRAWN_SECONDS", 0.0)
    monkeypatch.setattr(mesh_levels, "FEWEST_VERTICES", 500)


def steps_of(control=UNINTERRUPTED):
    surface = density_surface(MESH, control=control)
    return recorded(interpolation_steps(*ENDS, surface, SETTINGS, control=control))


def test_every_sweep_is_reported_and_the_result_is_unchanged(all_is_large, monkeypatch):
    """Fractions never fall; preparations are named."""
    found = steps_of()
    fractions = [step.fraction for step in found.reports]
    assert fractions == sorted(fractions) and fractions[-1] == 1.0
    said = [str(step.message) for step in found.reports]
    assert said[0].startswith("Preparing the flow of heat")
    assert [text for text in said if text.startswith("Coarsening")] == [
        "Coarsening the surface, 1 of 2",
        "Coarsening the surface, 2 of 2",
    ]
    monkeypatch.setattr(density_preparing, "LARGE", 1 << 40)
    fewer = steps_of()
    assert not any(str(step.message).startswith(("Preparing", "Coarsening")) for step in fewer.reports)
    np.testing.assert_allclose(fewer.result.densities, found.result.densities, rtol=1e-12)


def test_measuring_reports_every_round_with_the_same_result(all_is_large):
    surface = density_surface(MESH, 0.3, 20)
    found = recorded(measuring_steps(*ENDS, surface, ("A", "B")))
    fractions = [step.fraction for step in found.reports]
    assert fractions == sorted(fractions) and 0.9 < fractions[-1] <= 1.0
    assert len(found.reports) > found.result.iterations + 2


def test_a_density_can_be_cancelled_between_time_steps_and_while_coarsening(all_is_large):
    every = CountingControl()
    steps_of(every)
    # Every application of the kernel has ten time steps, and no sweep has fewer than two applications.
    assert every.count > 20 * 10
    for last in np.linspace(1, every.count, 4).astype(int):
        with pytest.raises(Cancelled):
            steps_of(CountingControl(last))


def test_coarsening_checks_for_cancelling_often():
    control = CountingControl()
    level = mesh_levels.MeshLevel.of(icosphere(5), control)
    before = control.count
    assert level.coarser is not None
    assert control.count > before + 15


def test_voxelizing_can_be_cancelled():
    mesh, control = ball(11, (16, 16, 16)), CountingControl()
    filled = occupancy(mesh.corners, (32, 32, 32), control)
    np.testing.assert_array_equal(filled, occupancy(mesh.corners, (32, 32, 32)))
    for last in range(1, control.count + 1):
        with pytest.raises(Cancelled):
            occupancy(mesh.corners, (32, 32, 32), CountingControl(last))


def test_a_soft_map_can_be_cancelled_while_it_is_extended_to_all_vertices():
    sides = MapSide(ball(points=300), "A"), MapSide(ball(points=280), "B")
    control, counts = CountingControl(), {}
    for step in soft_map_steps(*sides, [[0, 0]], control=control):
        counts[str(step.message)] = control.count
    assert counts["The map is there"] >= counts["Taking the map to all vertices"] + 6


def test_the_estimated_levels_match_the_actual_ones():
    surface = density_surface(icosphere(6))
    assert surface.shape[0] > 40_000
    found = 0
    level = surface
    while (level := level.coarser()) is not None:
        found += 1
    assert abs(surface.levels_below - found) <= 1
