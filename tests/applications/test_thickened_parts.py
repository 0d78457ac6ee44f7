# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts that are thinner than cells stay whole in solids and in blends."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from convwass_addon.applications.live.field_sources import MovingSource
from convwass_addon.applications.live.level_fields import mixed
from convwass_addon.applications.morphs.coinciding_solids import CoincidingSolids
from convwass_addon.applications.morphs.layouts import Blend, path_blends
from convwass_addon.applications.morphs.morph_inputs import MorphInputs
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.applications.morphs.moving_problem import MovingProblem
from convwass_addon.applications.morphs.part_labels import unparted
from convwass_addon.applications.morphs.preparing import prepared_problem
from convwass_addon.applications.morphs.thickened_parts import WIDTH, ThickenedParts
from convwass_addon.applications.motions.motion import MovedShape
from convwass_addon.geometry.level_sets.connectivity import Connectivity
from convwass_addon.geometry.level_sets.isosurface import surface_at_level
from convwass_addon.geometry.meshes.closest_points import ClosestPointFinder, TriangleSamples
from convwass_addon.geometry.solids.occupancy import occupancy
from convwass_addon.geometry.solids.thin_spans import ThinSpans
from convwass_addon.progress import Control, drained
from tests.shapes import ball, box, joined, rotated, torus, turned

CENTER = np.array([20.0, 20.0, 20.0])
OUTSIDE = -3.0
SHAPE = (40, 40, 40)


def surface_of(depth):
    """The surface at distance zero."""
    return surface_at_level(depth - OUTSIDE, -OUTSIDE)


def thickened(mesh):
    """An empty grid to which the thin parts of a mesh are added."""
    depth = np.full(SHAPE, OUTSIDE, np.float32)
    return depth, ThickenedParts.of(
        depth, occupancy(mesh.corners, SHAPE), ThinSpans.of(mesh, 2.0 * WIDTH).middles(mesh, WIDTH)
    )


@pytest.mark.parametrize("turn", [(0.0, 0.0, 0.0), (0.4, 0.3, 0.0), (0.8, 0.0, 0.6)])
def test_a_sheet_becomes_as_wide_as_the_grid_needs(turn):
    plate = rotated(box((24.0, 20.0, 0.2)), np.array(turn)).moved(CENTER)
    depth, parts = thickened(plate)
    surface = surface_of(depth)
    assert Connectivity.of(surface) == Connectivity(1, 0, 0)
    flat = rotated(surface.mesh.moved(-CENTER), -np.array(turn)).vertices
    inner = (np.abs(flat[:, 0]) < 11.0) & (np.abs(flat[:, 1]) < 9.0)
    assert 2.0 * np.abs(flat[inner, 2]).mean() == pytest.approx(WIDTH, abs=0.2)
    # Rims are half a width too wide on all sides at most.
    assert np.abs(flat[:, 0]).max() < 12.0 + 0.5 * WIDTH
    assert parts.volume() == pytest.approx(surface.mesh.volume - plate.volume, rel=0.1)


@pytest.mark.parametrize("shift", [0.0, 0.25, 0.5])
def test_a_thread_between_cells_stays_whole(shift):
    ring = torus(14.0, 0.1, segments=(200, 12)).moved(CENTER + shift)
    surface = surface_of(thickened(ring)[0])
    assert Connectivity.of(surface) == Connectivity(1, 1, 0)


def test_the_share_of_the_added_volume_is_counted_where_it_was_added():
    plate = box((24.0, 20.0, 0.2)).moved(CENTER)
    parts = thickened(plate)[1]
    left = np.zeros(SHAPE, np.float32)
    left[:20] = 0.5
    assert parts.volume(left) == pytest.approx(0.25 * parts.volume(), rel=0.01)
    assert parts.volume(np.broadcast_to(np.float32(1.0), SHAPE)) == pytest.approx(parts.volume())


def test_the_mean_of_solids_has_the_thin_parts_that_all_of_them_have():
    """The blade is lost without; the ball keeps its size although the blade becomes larger."""
    shape = joined(ball(8.0, (14.0, 20.0, 20.0), 3000), box((24.0, 12.0, 0.2), (26.0, 20.2, 20.0)))
    occupancies = [occupancy(shape.corners, SHAPE)] * 2
    middles = ThinSpans.of(shape, 2.0 * WIDTH).middles(shape, WIDTH)
    volume = float(occupancies[0].sum())
    found = CoincidingSolids.of(occupancies, (0.5, 0.5), volume, [middles] * 2)
    # The rims become wider, too.
    assert 1.0 < found.surplus / (16.0 * 12.0 * (WIDTH - 0.2)) < 1.3
    reaches = []
    for solids in (found, CoincidingSolids.of(occupancies, (0.5, 0.5), volume)):
        mesh = surface_at_level(solids.density, 0.5).mesh
        reaches.append(mesh.bounds[1, 0])
        assert mesh.bounds[0, 0] == pytest.approx(6.0, abs=0.3)
    assert reaches[0] == pytest.approx(38.0, abs=1.0)
    assert reaches[1] < 30.0


FIN_TURN = np.array([0.2, 0.3, 0.0])
FINNED = joined(ball(0.5, points=2000), rotated(box((2.4, 0.9, 0.03)), FIN_TURN))
SHAPES = (FINNED, turned(FINNED, 1.0))


@dataclass(frozen=True)
class Turning:
    """Both shapes turn by their share, exactly."""

    def moved(self, weights):
        turns = (weights[1], weights[1] - 1.0)
        return [MovedShape(shape, turned(shape, turn).vertices) for shape, turn in zip(SHAPES, turns, strict=True)]


def problem_with(detail):
    settings = MorphSettings(resolution=40, detail=detail, carry=False, on_floor=False)
    still = drained(prepared_problem(MorphInputs.of(SHAPES, ("first", "second")), settings, 1))
    return MovingProblem.of(still, Turning(), path_blends(2, 4), ("first", "second"), unparted(2), Control())


@pytest.fixture(scope="module")
def problem():
    return problem_with(1.0)


@pytest.mark.parametrize("share", [0.2, 0.5])
def test_blends_have_fins_of_half_a_cell(problem, share):
    frame = problem.frame(Blend((1.0 - share, share)), Control())
    expected = turned(FINNED, share)
    cell = problem.lattice.spacing
    assert cell > 0.05
    assert frame.record["found"]["handles"] == 0
    # Every point of the fins is there, and nothing else.
    fins = TriangleSamples.of(expected.corners).points
    fins = fins[np.linalg.norm(fins, axis=1) > 0.5]
    assert np.quantile(ClosestPointFinder(frame.mesh.corners).find(fins).distances, 0.98) < 0.5 * cell
    away = ClosestPointFinder(expected.corners).find(frame.mesh.vertices).distances / cell
    assert np.quantile(away, 0.99) < 0.3
    assert away.max() < 0.75
    assert frame.mesh.volume == pytest.approx(frame.record["volume_wanted"], rel=5e-3)


def test_a_lost_fin_is_only_reported_if_blends_lose_it(problem):
    first = path_blends(2, 4)[0]
    assert first.source == 0
    assert "thin" not in problem.frame(first, Control()).record
    plain = problem_with(0.0)
    assert plain.frame(first, Control()).record["thin"]["share"] > 0.0
    share = 0.2
    assert plain.frame(Blend((1.0 - share, share)), Control()).mesh.area < 0.6 * FINNED.area


def test_fins_of_live_fields_are_thick_and_take_nothing_from_the_ball(problem):
    weights = (0.8, 0.2)
    mesh = mixed([MovingSource(problem).field(weights)], [1.0]).surface()
    placed = problem.still.lattice.to_scene(mesh, np.array(weights))
    upright = rotated(turned(placed, -weights[1]), -FIN_TURN).vertices
    assert np.ptp(upright[:, 0]) == pytest.approx(2.4, abs=0.15)
    ball_radii = np.linalg.norm(upright[np.abs(upright[:, 2]) > 0.2], axis=1)
    assert ball_radii.mean() == pytest.approx(0.5, abs=0.02)
