# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Blends carry the detail of their shapes along."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest

from convwass_addon.applications.morphs.coinciding_solids import CoincidingSolids
from convwass_addon.applications.morphs.computation import Computation
from convwass_addon.applications.morphs.detail import starts_on_readings
from convwass_addon.applications.morphs.layouts import Blend, path_blends
from convwass_addon.applications.morphs.morph import morph
from convwass_addon.applications.morphs.morph_inputs import MorphInputs
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.applications.morphs.moving_problem import MovingProblem
from convwass_addon.applications.morphs.part_labels import unparted
from convwass_addon.applications.morphs.preparing import prepared_problem
from convwass_addon.applications.morphs.volumes import Lattice
from convwass_addon.applications.motions.motion import MovedShape
from convwass_addon.geometry.meshes.closest_points import ClosestPointFinder
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.solids.occupancy import occupancy
from convwass_addon.progress import Control, drained
from tests.shapes import ball, box, turned

NAMES = ("first", "second")
ANGLE = 1.0


def bumpy_ball():
    """Bumps that rise and fall by a sixteenth of the radius, on a ball above the origin."""
    mesh = ball(points=4000)
    bumps = np.sin(14.0 * mesh.vertices).prod(axis=1, keepdims=True)
    return TriangleMesh(mesh.vertices * (1.0 + bumps / 16.0), mesh.faces).moved((0.0, 0.0, 5.0))


BALL = bumpy_ball()
SHAPES = (BALL, turned(BALL, ANGLE))


@dataclass(frozen=True)
class Turning:
    """Both balls turn by their share, exactly."""

    def moved(self, weights):
        turns = (weights[1] * ANGLE, (weights[1] - 1.0) * ANGLE)
        return [MovedShape(shape, turned(shape, turn).vertices) for shape, turn in zip(SHAPES, turns, strict=True)]


def frame_of_balls(detail, share):
    settings = MorphSettings(resolution=40, detail=detail, carry=False)
    still = drained(prepared_problem(MorphInputs.of(SHAPES, NAMES), settings, 1))
    problem = MovingProblem.of(still, Turning(), path_blends(2, 4), NAMES, unparted(2), Control())
    return problem.frame(Blend((1.0 - share, share)), Control()), problem.lattice.spacing


def mean_distance(mesh, other, spacing):
    """From the vertices of the second to the first, in cells."""
    return ClosestPointFinder(mesh.corners).find(other.vertices).distances.mean() / spacing


@pytest.mark.parametrize("share", [1 / 24, 0.5])
def test_a_bumpy_ball_that_turns_keeps_its_bumps(share):
    expected = turned(BALL, share * ANGLE)
    plain, spacing = frame_of_balls(0.0, share)
    detailed, _ = frame_of_balls(None, share)
    assert mean_distance(plain.mesh, expected, spacing) > 0.1
    assert mean_distance(detailed.mesh, expected, spacing) < 0.04
    assert detailed.mesh.volume == pytest.approx(BALL.volume, rel=1e-3)
    assert detailed.record["volume"] == detailed.mesh.volume


@pytest.mark.parametrize(("inner", "outer", "certainty"), [(10.0, 11.0, 1.0), (10.0, 13.0, 2.0 / 3.0)])
def test_vertices_start_on_the_shapes_above_and_below_them(inner, outer, certainty):
    """Balls about one center, in a grid whose cells are a tenth of a unit wide; half a blend is the ball between."""
    spacing, shift, center = 0.1, np.array([5.0, -6.0, 7.0]), np.array([20.3, 19.7, 20.1])
    low = np.array([-1.9, -2.0, -2.1])
    filled = [occupancy(ball(radius, center).corners, (40, 40, 40)) for radius in (inner, outer)]
    between = ball(0.5 * (inner + outer) * spacing, center * spacing + low + shift)
    frame = SimpleNamespace(mesh=between, blend=Blend((0.5, 0.5)), origins=None)
    problem = SimpleNamespace(lattice=Lattice((40, 40, 40), spacing, low, np.stack([shift, shift])))
    found = starts_on_readings(problem, frame, CoincidingSolids.of(filled, (0.5, 0.5)))
    radii = np.linalg.norm(found.points - (center * spacing + low + shift), axis=2) / spacing
    np.testing.assert_allclose(radii.T, np.broadcast_to((inner, outer), radii.T.shape), atol=0.2)
    np.testing.assert_allclose(found.certainty, certainty, atol=0.15)


def test_transport_carries_detail_if_requested():
    """Beside a box the blend has the edges of the box; those of the paper are as round as the grid makes them."""
    shapes = (box(), ball(0.62, points=600))
    found = {}
    for detail in (None, 1.0):
        settings = MorphSettings(resolution=32, motion="transport", detail=detail)
        inputs = MorphInputs.of(shapes, NAMES)
        steps = morph(inputs, path_blends(2, 25), settings, computation=Computation(1, wanted=range(1, 2)))
        found[detail] = [step.payload for step in steps if step.payload is not None][1]
    area = box().area * 23 / 24 + shapes[1].area / 24
    assert found[None].mesh.area < 0.965 * area < 0.98 * area < found[1.0].mesh.area < 1.01 * area
    origins = found[1.0].origins
    assert origins.shape == (2, *found[1.0].mesh.vertices.shape)
    apart = np.linalg.norm(origins[0] * 23 / 24 + origins[1] / 24 - found[1.0].mesh.vertices, axis=1)
    # Beside the corners of the box, a few vertices are moved so that no triangle turns over.
    assert np.quantile(apart, 0.995) < 4e-3
    assert apart.max() < 0.05


def test_all_detail_comes_along_but_in_the_blends_of_the_paper():
    assert MorphSettings().carried_detail == 1.0
    assert MorphSettings(detail=0.3).carried_detail == 0.3
    assert MorphSettings(motion="transport").carried_detail == 0.0
    assert MorphSettings(motion="transport", detail=0.3).carried_detail == 0.3
    assert MorphSettings(level="half-max", detail=1.0).carried_detail == 0.0
