# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Moved blends that are kept give the same frames as those that are moved again."""

import pickle
from dataclasses import dataclass, replace

import numpy as np
import pytest

from convwass_addon.applications.morphs.blend_store import BlendStore
from convwass_addon.applications.morphs.demands import Demand
from convwass_addon.applications.morphs.layouts import Blend, path_blends
from convwass_addon.applications.morphs.morph_inputs import MorphInputs
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.applications.morphs.moving_problem import MovingProblem
from convwass_addon.applications.morphs.part_labels import unparted
from convwass_addon.applications.morphs.preparing import prepared_problem
from convwass_addon.applications.morphs.runs import as_solved
from convwass_addon.applications.morphs.solving_again import again_in_threads
from convwass_addon.applications.motions.motion import MovedShape
from convwass_addon.geometry.level_sets.connectivity import Connectivity
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.progress import Control, drained
from tests.shapes import ball

SHAPES = tuple(
    TriangleMesh(mesh.vertices, mesh.faces) for mesh in (ball(1.0, (0, 0, 0), 500), ball(1.2, (3, 0, 0), 500))
)
NAMES = ("small", "large")
MIDDLE = Blend((0.5, 0.5), frame=2)


@dataclass
class Sliding:
    """Both balls move to the place between them; counts its calls."""

    calls: int = 0

    def moved(self, weights):
        self.calls += 1
        place = (3.0 * weights[1], 0.0, 0.0)
        return [
            MovedShape(shape, shape.vertices - center + place)
            for shape, center in zip(SHAPES, ((0, 0, 0), (3, 0, 0)), strict=True)
        ]


@pytest.fixture
def problem() -> MovingProblem:
    still = drained(prepared_problem(MorphInputs.of(SHAPES, NAMES), MorphSettings(resolution=24, on_floor=False), 1))
    return MovingProblem.of(still, Sliding(), path_blends(2, 3), NAMES, unparted(2), Control())


def demand(problem, reach):
    """A limit on the distance to the small ball in the place of the blend."""
    near = SHAPES[0].moved((1.5, 0.0, 0.0))
    return Demand(problem.still.connectivity[0], near, reach)


def calls(problem):
    return problem.motion.motion.calls


def test_a_kept_blend_obeys_a_demand_and_is_not_moved_again(problem):
    keeping = replace(problem, kept=BlendStore(1 << 26))
    asked = {MIDDLE: demand(problem, 0.05)}
    free = keeping.frame(MIDDLE, Control())
    before = calls(problem)
    (kept,) = keeping.frames_again((MIDDLE,), asked)
    # Only velocities still need the motion.
    only_velocities = calls(problem) - before
    (alone,) = problem.frames_again((MIDDLE,), asked)
    assert calls(problem) - before == 2 * only_velocities + 1
    np.testing.assert_array_equal(kept.mesh.vertices, alone.mesh.vertices)
    np.testing.assert_array_equal(kept.mesh.faces, alone.mesh.faces)
    assert kept.record["held"] == alone.record["held"] > 0
    assert len(free.mesh.vertices) != len(kept.mesh.vertices)


def test_a_frame_that_is_of_no_use_is_not_finished(problem):
    one, two = Connectivity(1, 0, 0), Connectivity(2, 0, 0)
    free = problem.frame(MIDDLE, Control())
    before = calls(problem)
    (missed,) = problem.frames_again((MIDDLE,), {MIDDLE: Demand(one, has=one)})
    # There are no velocities.
    assert calls(problem) - before == 1
    assert missed.origins is missed.triangles is None
    assert missed.record["found"] == free.record["found"]
    (better,) = problem.frames_again((MIDDLE,), {MIDDLE: Demand(one, has=two)})
    np.testing.assert_array_equal(better.mesh.vertices, free.mesh.vertices)
    np.testing.assert_array_equal(better.origins, free.origins)


def test_blends_of_a_run_are_computed_again_side_by_side(problem):
    run = tuple(path_blends(2, 5)[1:4])
    asked = {run[place]: demand(problem, 0.05) for place in (0, 2)}
    with again_in_threads(problem, {7: run}, asked, Control(), 2) as pending:
        assert list(pending.values()) == [7, 7]
        frames = [frame for solved in as_solved(pending, Control()) for frame in solved.frames]
    frames.sort(key=lambda frame: run.index(frame.blend))
    assert [frame.blend for frame in frames] == [run[0], run[2]]
    for frame, alone in zip(frames, problem.frames_again(run, asked), strict=True):
        np.testing.assert_array_equal(frame.mesh.vertices, alone.mesh.vertices)


def test_blends_beyond_the_memory_are_not_kept(problem):
    first = replace(problem, kept=BlendStore(1 << 26)).moved_blend(MIDDLE, Control())
    kept = BlendStore(first.bytes)
    other = Blend((0.25, 0.75), frame=3)
    kept.keep(MIDDLE, first, first.bytes)
    kept.keep(other, first, first.bytes)
    assert kept.get(MIDDLE) is first
    assert kept.get(other) is None


def test_nothing_is_sent_to_other_processes(problem):
    keeping = replace(problem, kept=BlendStore(1 << 26))
    keeping.moved_blend(MIDDLE, Control())
    there = pickle.loads(pickle.dumps(keeping.kept))
    assert there.get(MIDDLE) is None
    there.keep(MIDDLE, keeping.kept.get(MIDDLE), 1)
    assert there.get(MIDDLE) is None
