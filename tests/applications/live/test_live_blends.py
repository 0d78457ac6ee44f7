# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Live blends of balls, whose blends are known, and of a rod that turns exactly."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.live.field_sources import MovingSource, estimated_field_bytes
from convwass_addon.applications.live.level_fields import mixed
from convwass_addon.applications.live.live_blends import FADE, LiveBlends
from convwass_addon.applications.live.live_settings import LiveSettings
from convwass_addon.applications.live.live_shapes import LiveShapes
from convwass_addon.applications.live.weight_layouts import path_weights
from convwass_addon.applications.morphs.layouts import Blend, path_blends
from convwass_addon.applications.morphs.morph_inputs import MorphInputs
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.applications.morphs.moving_problem import MovingProblem
from convwass_addon.applications.morphs.part_labels import unparted
from convwass_addon.applications.morphs.preparing import prepared_problem
from convwass_addon.applications.morphs.volumes import Lattice
from convwass_addon.applications.motions.motion_choice import MotionChoice
from convwass_addon.applications.motions.motion_memory import MotionMemory
from convwass_addon.errors import Cancelled, InputError
from convwass_addon.geometry.meshes.centroid import centroid
from convwass_addon.geometry.meshes.closest_points import ClosestPointFinder
from convwass_addon.progress import Control, Work, drained
from tests.applications.test_moving_problem import ANGLE, NAMES, ROD, SHAPES, Turning, turned
from tests.shapes import ball

RADII, CENTERS = (0.5, 0.9), ((0.0, 0.0, 0.0), (4.0, 1.0, 0.0))


class Clock:
    """Time that stands still."""

    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        return self.now


class TurningFound(MotionMemory):
    """A memory that knows how rods turn."""

    def chosen(self, *_arguments: object) -> Work[MotionChoice]:
        return MotionChoice("guided", "ASKED", Turning())
        yield


class NothingFound(MotionMemory):
    """A memory that knows of no motion."""

    def chosen(self, *_arguments: object) -> Work[MotionChoice]:
        return MotionChoice("transport", "SOLID")
        yield


def live_balls(clock: Clock, count: int = 2, motion: str = "transport", **live: int) -> LiveBlends:
    """Return live blends of balls; of more than two the last ones are like the first."""
    meshes = tuple(ball(RADII[i % 2], CENTERS[i % 2], 400) for i in range(count))
    names = tuple(f"ball {i}" for i in range(count))
    settings = LiveSettings(**{"live_resolution": 32} | live)
    return LiveBlends(LiveShapes(MorphInputs.of(meshes, names)), MorphSettings(motion=motion), settings, clock=clock)


@pytest.fixture(scope="module")
def filled() -> LiveBlends:
    clock = Clock()
    live = live_balls(clock)
    drained(live.work(Control()))
    clock.now = 2 * FADE
    return live


@pytest.mark.parametrize("share", [0.0, 0.2, 0.63, 1.0])
def test_mixed_balls_are_balls(filled, share):
    filled.point((1.0 - share, share))
    shown = filled.shown()
    assert not shown.is_solved
    np.testing.assert_allclose(shown.center, share * np.array(CENTERS[1]), atol=1e-5)
    volume = (1.0 - share) * ball(RADII[0], points=400).volume + share * ball(RADII[1], points=400).volume
    assert shown.mesh.volume == pytest.approx(volume, rel=0.02)
    radius = np.cbrt(0.75 * volume / np.pi)
    spacing = 2 * RADII[1] / 24
    np.testing.assert_allclose(centroid(shown.mesh), 0.0, atol=0.05 * spacing)
    distances = np.linalg.norm(shown.mesh.vertices, axis=1)
    assert abs(distances - radius).mean() < 0.15 * spacing


def test_a_blend_is_solved_in_full_where_the_hand_rests(filled):
    filled.point((0.4, 0.6))
    mixture = filled.shown()
    assert not filled.has_work
    filled.rest()
    assert filled.has_work
    drained(filled.work(Control()))
    solved = filled.shown()
    assert solved.is_solved and not filled.has_work
    away = ClosestPointFinder(solved.mesh.corners).find(mixture.mesh.vertices).distances
    assert away.mean() < 0.1 * 2 * RADII[1] / 24
    filled.point((0.41, 0.59))
    assert not filled.shown().is_solved


def test_shapes_themselves_are_shown_exactly_where_the_hand_rests(filled):
    filled.point((0.0, 1.0))
    filled.rest()
    drained(filled.work(Control()))
    shown, own = filled.shown(), ball(RADII[1], CENTERS[1], 400)
    np.testing.assert_allclose(shown.mesh.vertices + shown.center, own.vertices)


def test_the_first_shape_is_there_before_the_lattice(filled):
    live = live_balls(Clock())
    assert live.shown() is None and live.has_work
    live.point((2.0, 2.0))
    assert live.hand == (0.5, 0.5)
    work = live.work(Control())
    while live.shown() is None:
        next(work)
    assert live.filled == 0
    filled.point((0.5, 0.5))
    assert live.shown().mesh.volume == pytest.approx(filled.shown().mesh.volume, rel=0.01)
    # Until the clock advances, the lattice has no effect; the blend at the cursor is solved wherever that is.
    live.point((0.3, 0.7))
    while live.shown().center[0] != pytest.approx(2.8) or live.filled == 0:
        next(work)
    next(work)
    filled.point((0.3, 0.7))
    assert live.shown().mesh.volume == pytest.approx(filled.shown().mesh.volume, rel=0.01)


def test_the_shape_follows_the_hand_while_the_finer_grid_is_voxelized():
    live = live_balls(Clock(), live_resolution=64)
    work, volumes = live.work(Control()), []
    for share in (0.3, 0.7):
        live.point((1.0 - share, share))
        version = live.version
        while live.version == version:
            next(work)
        volumes.append(live.shown().mesh.volume)
    assert live.filled == 0
    small, large = (ball(radius, points=400).volume for radius in RADII)
    assert volumes == pytest.approx([0.7 * small + 0.3 * large, 0.3 * small + 0.7 * large], rel=0.02)


def test_a_coarser_substitute_has_the_same_position_and_size():
    live = live_balls(Clock(), live_resolution=72)
    work = live.work(Control())
    while live.shown() is None:
        next(work)
    work.close()
    shown = live.shown()
    volume = np.mean([ball(radius, points=400).volume for radius in RADII])
    assert shown.mesh.volume == pytest.approx(volume, rel=0.02)
    np.testing.assert_allclose(centroid(shown.mesh), 0.0, atol=0.1 * 2 * RADII[1] / 64)


def test_where_memory_is_short_the_lattice_is_coarser():
    live = live_balls(Clock(), count=4, live_memory=5, live_resolution=32)
    work = live.work(Control())
    while not live.notices:
        next(work)
    work.close()
    assert live.notices[0].values["levels"] == 8


def test_the_memory_of_fields_is_known_beforehand(filled):
    meshes = [ball(radius, center, 400) for radius, center in zip(RADII, CENTERS, strict=True)]
    lattice = Lattice.around(meshes, 32, MorphSettings(resolution=32).sigma)
    estimate = estimated_field_bytes(meshes, lattice, [path_weights(place / 4, 2) for place in range(5)])
    assert estimate * filled.filled == pytest.approx(filled.bytes, rel=0.15)


def test_the_work_stops_when_cancelled():
    control = Control()
    work = live_balls(Clock()).work(control)
    next(work)
    control.cancel()
    with pytest.raises(Cancelled):
        drained(work)


def test_weights_that_are_no_numbers_are_refused(filled):
    with pytest.raises(InputError, match="finite"):
        filled.point((np.nan, 1.0))


def test_a_motion_takes_over_from_plain_transport():
    clock = Clock()
    shapes = LiveShapes(MorphInputs.of(SHAPES, NAMES))
    live = LiveBlends(shapes, MorphSettings(on_floor=False), LiveSettings(live_resolution=32), clock, TurningFound())
    live.point((0.499, 0.501))
    reaches = []
    for _ in live.work(Control()):
        clock.now += 0.1
        if (shown := live.shown()) is not None:
            reaches.append(np.linalg.norm((shown.mesh.vertices + shown.center)[:, :2], axis=1).max())
    clock.now += FADE
    live.settle()
    # Transport makes the rod shorter half way; the motion turns it.
    assert reaches[0] < 1.75
    found = live.shown().mesh.vertices + live.shown().center
    assert np.linalg.norm(found[:, :2], axis=1).max() == pytest.approx(2.0, abs=2.0 / 12)
    expected = turned(ROD, ANGLE / 2)
    assert ClosestPointFinder(expected.corners).find(found).distances.mean() < 0.5 / 12


def test_shapes_without_a_motion_get_the_complete_lattice():
    shapes = LiveShapes(MorphInputs.of(SHAPES, NAMES))
    live = LiveBlends(shapes, MorphSettings(), LiveSettings(live_resolution=24), Clock(), NothingFound())
    drained(live.work(Control()))
    assert live.filled >= 17 and not live.has_work


def test_fields_of_moved_shapes_turn_with_them():
    still = drained(prepared_problem(MorphInputs.of(SHAPES, NAMES), MorphSettings(resolution=48, on_floor=False), 1))
    problem = MovingProblem.of(still, Turning(), path_blends(2, 4), NAMES, unparted(2), Control())
    source = MovingSource(problem)
    blend = Blend((0.7, 0.3))
    mesh = mixed([source.field(blend.weights)], [1.0]).surface()
    # Its cells are those of the lattice of the shapes at rest.
    placed = still.lattice.to_scene(mesh, np.array(blend.weights))
    expected = turned(ROD, 0.3 * ANGLE)
    assert placed.volume == pytest.approx(ROD.volume, rel=0.01)
    away = ClosestPointFinder(expected.corners).find(placed.vertices).distances
    assert away.mean() < 0.25 * still.lattice.spacing
