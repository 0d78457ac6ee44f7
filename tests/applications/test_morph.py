# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import multiprocessing
import os
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor

import numpy as np
import pytest

from convwass_addon.applications import memory
from convwass_addon.applications.background import BackgroundJob
from convwass_addon.applications.morphs.blend_solver import BlendSolver
from convwass_addon.applications.morphs.blending import surfaced_frame
from convwass_addon.applications.morphs.computation import Computation
from convwass_addon.applications.morphs.layouts import Blend, grid_blends, path_blends, single_blend, triangle_blends
from convwass_addon.applications.morphs.morph import morph
from convwass_addon.applications.morphs.morph_inputs import MorphInputs
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.applications.morphs.preparing import prepared_problem
from convwass_addon.applications.morphs.volumes import Lattice
from convwass_addon.errors import Cancelled, InputError, ResourceError
from convwass_addon.geometry.meshes.edges import topology
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.solids.alignment import aligned
from convwass_addon.progress import UNINTERRUPTED, drained
from convwass_addon.sentence import Sentence
from tests.controls import CountingControl, cancelled_control
from tests.shapes import ball, box, joined, square, torus, with_faces

QUICK = MorphSettings(motion="transport", resolution=32)


def frames_of(shapes, blends, settings=QUICK):
    names = [f"shape {i}" for i in range(len(shapes))]
    found = [step.payload for step in morph(MorphInputs.of(shapes, names), blends, settings) if step.payload]
    # Revised frames come last.
    return list({frame.blend: frame for frame in found}.values())


def test_every_blend_is_closed_outward_of_the_right_volume_and_solved():
    shapes = [torus(1.0, 0.35), joined(ball(0.6, (-1, 0, 0)), box(center=(1, 0, 0))), ball(0.9)]
    frames = frames_of(shapes, path_blends(3, 4), MorphSettings(motion="transport", resolution=48))
    volumes = np.array([shape.volume for shape in shapes])
    assert len(frames) == 9
    for frame in frames:
        if frame.blend.source is not None:
            assert frame.mesh is None
            continue
        record = frame.record
        assert topology(frame.mesh).closed
        assert frame.mesh.volume == pytest.approx(record["volume_wanted"], rel=3e-3)
        assert record["volume_wanted"] == pytest.approx(np.dot(frame.blend.weights, volumes), rel=0.01)
        assert record["converged"]
        assert record["invariant_error"] < 1e-6
        assert record["mass_error"] < 5e-3
    assert [frame.blend.source for frame in frames].count(None) == 6


def test_moved_inputs_move_the_blend_by_their_weight():
    shapes = [torus(), box((1, 2, 1), angles=(0.2, 0.4, 0.1))]
    blend = single_blend([0.25, 0.75], 2)
    (here,) = frames_of(shapes, blend)
    (there,) = frames_of([shapes[0].moved((40, 0, 0)), shapes[1].moved((0, -20, 4))], blend)
    np.testing.assert_allclose(
        there.mesh.vertices - here.mesh.vertices, np.tile((10, -15, 3), (len(here.mesh.vertices), 1))
    )


def test_distance_in_the_scene_costs_no_cells():
    near = Lattice.around([ball(), box()], 40, 1.0)
    far = Lattice.around([ball(center=(1000, 0, 0)), box(center=(0, 0, -500))], 40, 1.0)
    assert far.shape == near.shape
    assert far.spacing == pytest.approx(near.spacing)


def test_the_center_does_not_depend_on_which_way_faces_point():
    shapes = [joined(box(), ball(0.6, (2.0, 0.5, 0.0))), box()]
    inverted = [joined(box().flipped(), ball(0.6, (2.0, 0.5, 0.0))), box().flipped()]
    centers, others = (Lattice.around(own, 40, 1.0).centers for own in (shapes, inverted))
    np.testing.assert_allclose(others, centers)


def test_a_blend_of_a_ball_with_itself_is_the_ball():
    (frame,) = frames_of([ball(), ball()], single_blend([1, 1], 2), MorphSettings(motion="transport", resolution=48))
    radii = np.linalg.norm(frame.mesh.vertices, axis=1)
    cell = 2 / 40
    assert np.abs(radii - 1).max() < 0.5 * cell


def test_balls_blend_to_a_ball_of_the_mean_radius_before_the_volume_is_set():
    """Scaled copies interpolate by scaling, so the half-way level of the density is at the mean radius."""
    settings = MorphSettings(motion="transport", resolution=64, sharpness=1.0, level="half-max")
    (frame,) = frames_of([ball(1.0), ball(0.5)], single_blend([1, 1], 2), settings)
    assert np.linalg.norm(frame.mesh.vertices, axis=1).mean() == pytest.approx(0.75, rel=0.03)


def test_the_level_can_be_half_of_the_maximum():
    shapes = [torus(), box()]
    by_volume, by_half = (
        frames_of(shapes, single_blend([1, 1], 2), MorphSettings(motion="transport", resolution=32, level=level))[0]
        for level in ("volume", "half-max")
    )
    assert by_volume.record["level"] != by_half.record["level"]
    assert topology(by_half.mesh).closed


def test_open_inverted_and_overlapping_meshes_are_welcome():
    whole = ball(points=600)
    holey = with_faces(whole, np.random.default_rng(1).random(len(whole.faces)) > 0.03)
    shapes = [holey, torus().flipped(), joined(box(), box(center=(0.4, 0.3, 0.2)))]
    frames = frames_of(shapes, path_blends(3, 2))
    assert all(topology(frame.mesh).closed for frame in frames if frame.mesh)


def test_a_sheet_is_refused_by_name_and_taken_with_thickness():
    shapes, blend = [ball(), square(2)], single_blend([1, 1], 2)
    with pytest.raises(InputError, match=r"'shape 1' encloses no volume .* thickness"):
        frames_of(shapes, blend)
    (frame,) = frames_of(shapes, blend, MorphSettings(motion="transport", resolution=32, thickness=0.2))
    assert topology(frame.mesh).closed


@pytest.mark.parametrize(
    ("small", "thickness"), [(ball(0.01), 0.0), (box((0.02, 0.02, 0.02)), 0.0), (square(0.02), 0.001)]
)
def test_a_shape_a_hundred_times_smaller_is_refused_for_its_size(small, thickness):
    settings = MorphSettings(motion="transport", resolution=48, thickness=thickness)
    with pytest.raises(InputError, match=r"'shape 1' is too small next to .* 0\.\d+ cells long.* Equal Volume"):
        frames_of([ball(), small], single_blend([1, 1], 2), settings)


def test_equal_volume_helps_a_shape_that_is_too_small():
    pair = [ball(), box((0.02, 0.02, 0.02))]
    moved = [move.moved(shape) for move, shape in zip(aligned(pair, "PLACED", "EQUAL_VOLUME"), pair, strict=True)]
    (frame,) = frames_of(moved, single_blend([1, 1], 2))
    assert frame.mesh.volume == pytest.approx(pair[0].volume, rel=0.02)


def test_a_rod_thinner_than_the_cells_is_not_called_too_small_beside_the_others():
    with pytest.raises(InputError, match="more resolution"):
        frames_of([box((1, 0.01, 0.01)), box((1, 0.01, 0.01))], single_blend([1, 1], 2))


def test_only_automatic_sharpness_rises_towards_the_ends():
    automatic = [MorphSettings(motion="transport").sharpness_at((1 - t, t)) for t in (0.001, 0.1, 0.5, 0.9, 0.999)]
    assert automatic[2] == 0.75
    assert automatic[0] > automatic[1] > 0.75
    assert automatic[0] == pytest.approx(automatic[4])
    assert MorphSettings(motion="transport", sharpness=0.0).sharpness_at((0.001, 0.999)) == 0.0


def test_the_dial_of_sharpness_ends_where_blends_converge():
    """What the kernel hides of the errors of the debiasing density is 1 / (1 - sharpness) times what it shows."""
    half = (0.5, 0.5)
    usual, crisp, full = (MorphSettings(motion="transport", sharpness=sharpness) for sharpness in (None, 0.9, 1.0))
    assert crisp.sharpness_at(half) == 0.9
    assert full.sharpness_at(half) == MorphSettings(motion="transport").sharpness_at((0.001, 0.999)) == 0.95
    assert usual.stopping_error == full.stopping_error == usual.debias_stopping_error_at(half) == 0.01
    assert full.debias_stopping_error_at(half) == pytest.approx(0.002)
    asked = MorphSettings(motion="transport", sharpness=1.0, tolerance=0.05)
    assert asked.stopping_error == asked.debias_stopping_error_at(half) == 0.05


def test_progress_never_goes_back_and_ends_at_one():
    steps = list(morph(MorphInputs.of([ball(), box()], ["a", "b"]), path_blends(2, 3), QUICK))
    fractions = [step.fraction for step in steps]
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1.0
    assert all(isinstance(step.message, Sentence) and str(step.message) for step in steps)


def test_frames_are_the_same_wherever_they_are_computed():
    shapes, blends = [ball(), box()], path_blends(2, 6)

    def vertices(**where):
        steps = morph(MorphInputs.of(shapes, ["a", "b"]), blends, QUICK, computation=Computation(**where))
        return [step.payload.mesh.vertices for step in steps if step.payload and step.payload.mesh is not None]

    expected = vertices(workers=1)
    assert len(expected) == 5
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as processes:
        for found in (vertices(workers=3), vertices(executor=processes)):
            for one, other in zip(found, expected, strict=True):
                np.testing.assert_array_equal(one, other)


def test_a_job_in_other_processes_can_be_cancelled():
    shapes, blends = [ball(), box()], path_blends(2, 50)
    with ThreadPoolExecutor(1) as elsewhere, pytest.raises(Cancelled):
        computation = Computation(executor=elsewhere)
        list(morph(MorphInputs.of(shapes, ["a", "b"]), blends, QUICK, cancelled_control(), computation=computation))


def test_no_workers_are_refused():
    with pytest.raises(InputError, match="at least one worker"):
        Computation(workers=0)


def test_a_job_can_be_cancelled():
    control = CountingControl(last=6)
    with pytest.raises(Cancelled):
        list(morph(MorphInputs.of([ball(), box()], ["a", "b"]), path_blends(2, 50), QUICK, control))
    # Every run that a thread still begins ends at its first check.
    assert control.count < 6 + os.cpu_count() + 50 / 4


def test_a_background_job_delivers_and_can_be_cancelled():
    shapes, blends = [ball(), box()], path_blends(2, 400)
    job = BackgroundJob(lambda control: morph(MorphInputs.of(shapes, ["a", "b"]), blends, QUICK, control))
    steps = []
    deadline = time.monotonic() + 60
    while sum(step.payload is not None for step in steps) < 3 and time.monotonic() < deadline:
        steps += job.poll()
        time.sleep(0.02)
    assert not job.done
    job.cancel()
    assert job.done
    assert isinstance(job.error, Cancelled)


def test_a_background_job_hands_over_its_error():
    inputs = MorphInputs.of([ball(), square()], ["a", "b"])
    job = BackgroundJob(lambda control: morph(inputs, path_blends(2, 2), QUICK, control))
    while not job.done:
        time.sleep(0.01)
    assert isinstance(job.error, InputError)


def test_memory_is_checked_before_the_work(monkeypatch):
    monkeypatch.setattr(memory, "available_memory", lambda: 300_000_000)
    with pytest.raises(ResourceError, match=r"Resolution 200 needs about .* Resolution (\d+) would fit") as caught:
        Lattice.around([ball(), box()], 200, 1.0)
    fitting = int(str(caught.value).split("Resolution ")[-1].split()[0])
    Lattice.around([ball(), box()], fitting, 1.0)


def test_the_free_memory_of_this_machine_is_known():
    free = memory.available_memory()
    assert free is None or free > 10_000_000


def test_paths():
    blends = path_blends(3, 4)
    assert [blend.frame for blend in blends] == list(range(9))
    assert [blend.source for blend in blends if blend.source is not None] == [0, 1, 2]
    np.testing.assert_allclose([sum(blend.weights) for blend in blends], 1.0)


def test_sheets():
    grid, triangle = grid_blends(4, 5), triangle_blends(3, 5)
    assert (len(grid), len(triangle)) == (25, 15)
    for blends, corners in ((grid, 4), (triangle, 3)):
        assert sorted(blend.source for blend in blends if blend.source is not None) == list(range(corners))
        assert len({blend.place for blend in blends}) == len(blends)
        np.testing.assert_allclose([sum(blend.weights) for blend in blends], 1.0)
        assert all(blend.frame is None for blend in blends)
    assert next(b for b in grid if b.place == (2.0, 1.0)).weights == pytest.approx((0.375, 0.375, 0.125, 0.125))


def test_a_single_blend_is_scaled_to_sum_one():
    assert single_blend([2, 6], 2) == [Blend((0.25, 0.75))]


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: path_blends(1, 4), "two shapes"),
        (lambda: path_blends(2, 1), "2 frames"),
        (lambda: grid_blends(3, 4), "four shapes"),
        (lambda: triangle_blends(4, 4), "three shapes"),
        (lambda: grid_blends(4, 1), "at least 2"),
        (lambda: single_blend([1], 2), "2 inputs, but there are 1"),
        (lambda: single_blend([1, -1], 2), "positive"),
        (lambda: single_blend([0, 0], 2), "zero"),
        (lambda: single_blend([1, float("nan")], 2), "positive numbers"),
        (lambda: MorphSettings(motion="transport", resolution=4), "Resolution"),
        (lambda: MorphSettings(motion="transport", blur=0.1), "Blur"),
        (lambda: MorphSettings(motion="transport", sharpness=1.2), "Sharpness"),
        (lambda: MorphSettings(motion="transport", entropy_limit=float("nan")), "Entropy Limit"),
        (lambda: MorphSettings(motion="transport", level="middle"), "Surface"),
        (lambda: MorphSettings(motion="transport", thickness=-1), "Thickness"),
        (lambda: MorphSettings(motion="transport", tolerance=0), "Tolerance"),
        (lambda: MorphSettings(motion="transport", max_iterations=0), "Iterations"),
        (lambda: Lattice.around([ball(), box()], 12, 1.0), "too coarse"),
    ],
)
def test_invalid_input_is_refused(make, message):
    with pytest.raises(InputError, match=message):
        make()


def test_the_automatic_blur_is_widened_if_it_is_too_narrow(monkeypatch):
    monkeypatch.setattr(MorphSettings, "sigma", property(lambda settings: 0.5))
    shapes = [box((4, 0.4, 0.4)), box((0.4, 0.4, 4))]
    frames = frames_of(shapes, path_blends(2, 2), MorphSettings(motion="transport", resolution=72))
    solved = [frame.record for frame in frames if frame.mesh]
    assert all(record["converged"] for record in solved)
    assert max(record["sigma"] for record in solved) > 0.5
    assert {record["numerics"] for record in solved} == {"scaling"}


def test_the_surface_of_a_blend_can_be_cancelled():
    settings = MorphSettings(motion="transport", resolution=16)
    problem = drained(prepared_problem(MorphInputs.of((ball(), box()), ("a", "b")), settings, 1))
    blend = Blend((0.5, 0.5))
    solved = BlendSolver(problem.transport, UNINTERRUPTED).solve(blend, problem.transport.blend_volumes(blend))
    with pytest.raises(Cancelled):
        surfaced_frame(problem, solved, control=cancelled_control())


def test_meshes_without_area_are_named():
    point = TriangleMesh(np.zeros((3, 3)), np.array([[0, 1, 2]]))
    with pytest.raises(InputError, match="Dot has no faces with an area"):
        drained(morph(MorphInputs.of([ball(), point], ["Ball", "Dot"]), path_blends(2, 2), QUICK))
