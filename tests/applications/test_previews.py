# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Previews: the coarse levels of all blends before the finest of any, and not a bit of the frames depends on them."""

from __future__ import annotations

import gc
import threading
import time
import tracemalloc
import weakref
from types import SimpleNamespace

import numpy as np
import pytest

from convwass_addon.applications import memory
from convwass_addon.applications.morphs import blend_solver, blending, morph_problem, runs
from convwass_addon.applications.morphs.bake_plan import MorphPreview
from convwass_addon.applications.morphs.computation import Computation
from convwass_addon.applications.morphs.extraction import connectivity_of
from convwass_addon.applications.morphs.frame_cache import FrameCache
from convwass_addon.applications.morphs.layouts import path_blends, single_blend
from convwass_addon.applications.morphs.morph import morph
from convwass_addon.applications.morphs.morph_inputs import MorphInputs
from convwass_addon.applications.morphs.morph_problem import MorphFrame
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.applications.morphs.part_labels import FaceLabels, matched, unparted
from convwass_addon.applications.morphs.preparing import prepared_problem
from convwass_addon.applications.morphs.transport_problem import TransportProblem
from convwass_addon.applications.morphs.volumes import voxelized
from convwass_addon.errors import Cancelled
from convwass_addon.progress import Control, payloads
from convwass_addon.transport import Grid
from tests.shapes import ball, box, joined, torus
from tests.stored_frames import assert_as_stored

SHAPES = [torus(1.0, 0.4), box((1.5, 1, 1), center=(4, 0, 0)), ball(0.8)]
NAMES = ["a", "b", "c"]
QUICK = MorphSettings(motion="transport", resolution=32)


def steps_of(shapes=SHAPES, blends=None, settings=QUICK, labels=None, previews=True, **how):
    blends = path_blends(len(shapes), 3) if blends is None else blends
    computation = Computation(previews=previews, **how)
    inputs = MorphInputs.of(shapes, NAMES[: len(shapes)], labels)
    return list(morph(inputs, blends, settings, computation=computation))


def frames_of(steps):
    return [step.payload for step in steps if isinstance(step.payload, MorphFrame)]


def assert_same(some, others):
    for one, other in zip(some, others, strict=True):
        assert one.blend == other.blend
        assert one.record == other.record
        if one.mesh is not None or other.mesh is not None:
            np.testing.assert_array_equal(one.mesh.vertices, other.mesh.vertices)
            np.testing.assert_array_equal(one.mesh.faces, other.mesh.faces)


def test_every_blend_is_previewed_before_any_is_finished():
    blends = path_blends(3, 3)
    steps = steps_of(blends=blends)
    kinds = [("preview" if isinstance(step.payload, MorphPreview) else "frame") for step in steps if step.payload]
    assert kinds == ["preview"] * len(blends) + ["frame"] * len(blends)
    seen = [step.payload.frame.blend for step in steps if isinstance(step.payload, MorphPreview)]
    assert sorted(seen, key=blends.index) == blends
    fractions = [step.fraction for step in steps]
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1.0


def test_previews_have_about_the_volume_and_the_place_of_the_frames():
    steps = steps_of(settings=MorphSettings(motion="transport", resolution=48))
    previews = {preview.frame.blend: preview.frame.mesh for preview in payloads(steps, MorphPreview)}
    compared = 0
    for frame in frames_of(steps):
        preview = previews[frame.blend]
        if frame.mesh is None:
            assert preview is None
            continue
        assert preview.volume == pytest.approx(frame.mesh.volume, rel=0.02)
        assert len(preview.faces) < 0.4 * len(frame.mesh.faces)
        # A cell of the finest grid is a thirtieth of the box's and the torus's size.
        np.testing.assert_allclose(preview.bounds, frame.mesh.bounds, atol=0.15)
        compared += 1
    assert compared == 4


@pytest.mark.parametrize(
    ("settings", "workers"),
    [
        (QUICK, 1),
        (MorphSettings(motion="transport", resolution=40, blur=0.8), 2),
        (MorphSettings(motion="transport", resolution=32, locality=0.4), 2),
        (MorphSettings(motion="transport", resolution=32, entropy_limit="max"), 2),
    ],
)
def test_frames_are_the_same_with_previews_and_without(settings, workers):
    without = frames_of(steps_of(settings=settings, previews=False, workers=1))
    assert_same(frames_of(steps_of(settings=settings, workers=workers)), without)


def test_and_so_they_are_where_the_blur_has_to_grow(monkeypatch):
    """Then the finest levels of some blends cannot go on from the sketch, nor those after them."""
    monkeypatch.setattr(MorphSettings, "sigma", property(lambda settings: 0.5))
    shapes, settings = [box((4, 0.4, 0.4)), box((0.4, 0.4, 4))], MorphSettings(motion="transport", resolution=56)
    blends = path_blends(2, 3)
    with_previews = frames_of(steps_of(shapes, blends, settings))
    sigmas = {frame.record["sigma"] for frame in with_previews if frame.mesh}
    assert max(sigmas) > 0.5
    assert_same(with_previews, frames_of(steps_of(shapes, blends, settings, previews=False)))


def test_and_so_they_are_in_parts():
    two = joined(box(center=(-1, 0, 0)), box(center=(1, 0, 0)))
    halves = np.repeat([0, 1], 12)
    labels = [FaceLabels(("left", "right"), halves), FaceLabels(("left", "right"), 1 - halves)]
    options = {"shapes": [two, two], "blends": single_blend([1, 2], 2), "labels": labels}
    assert_same(frames_of(steps_of(**options)), frames_of(steps_of(**options, previews=False)))
    assert sum(isinstance(step.payload, MorphPreview) for step in steps_of(**options)) == 1


def problem_of(shapes, settings, labels=None):
    names = NAMES[: len(shapes)]
    matching = unparted(len(shapes)) if labels is None else matched(labels, names)
    steps = prepared_problem(MorphInputs(shapes, names, matching), settings, 1)
    while True:
        try:
            next(steps)
        except StopIteration as end:
            return end.value


def test_sketched_levels_are_not_solved_again(monkeypatch):
    problem, run = problem_of(SHAPES[:2], QUICK), path_blends(2, 3)
    sketches = list(blending.sketch_blends(problem, run))
    begun = []

    def noting(*args, **options):
        begun.append(options["begun"])
        return real(*args, **options)

    real = blend_solver.barycenter
    monkeypatch.setattr(blend_solver, "barycenter", noting)
    blending.solve_blends(problem, run, sketches=sketches)
    assert [id(one) for one in begun] == [id(part.solved) for sketch in sketches for part in sketch.parts]
    assert len(begun) == 2


@pytest.mark.parametrize(
    ("sketched", "solved"),
    [([0, 1], [1]), ([1], [0, 1]), ([0, 1], [2, 1])],
    ids=["no start", "an additional start", "another start"],
)
def test_levels_that_were_sketched_from_another_start_are_solved_again(sketched, solved):
    """After a blend whose blur had to grow, a solve does not start from what its sketch did."""
    problem, blends = problem_of(SHAPES[:2], MorphSettings(motion="transport", resolution=20)), path_blends(2, 4)[1:4]
    (*_, sketch) = blending.sketch_blends(problem, [blends[index] for index in sketched])

    def solved_from(parts):
        solver = blend_solver.BlendSolver(problem.transport)
        for index in solved:
            volumes = problem.transport.blend_volumes(blends[index])
            (part,) = solver.solve(blends[index], volumes, parts if index == solved[-1] else ()).parts
        return part

    found, expected = solved_from(sketch.parts), solved_from(())
    assert found.iterations == expected.iterations
    np.testing.assert_array_equal(found.density, expected.density)


@pytest.mark.parametrize(
    ("sides", "sketched"), [((48, 32, 32), 24), ((104, 88, 96), 52), ((128, 128, 128), 64), ((256, 256, 128), 64)]
)
def test_sketches_are_small_on_any_grid(sides, sketched):
    """Half the resolution, or less of a fine grid: it is to take no longer there."""
    grids = [Grid(sides, 1.0)]
    while (coarser := grids[0].coarser()) is not None:
        grids.insert(0, coarser)
    part = SimpleNamespace(inputs=SimpleNamespace(levels=[SimpleNamespace(domain=grid) for grid in grids]))
    depth = TransportProblem((part,), None, QUICK).sketch_depth
    assert grids[-1 - depth].shape[0] == sketched


def test_a_grid_that_cannot_be_halved_has_no_previews():
    settings, shapes = (
        MorphSettings(motion="transport", resolution=16, blur=0.5),
        [box((1.0, 0.9, 0.15)), box((0.9, 1.0, 0.15))],
    )
    assert min(problem_of(shapes, settings).lattice.shape) < 16
    steps = steps_of(shapes, path_blends(2, 2), settings)
    assert not any(isinstance(step.payload, MorphPreview) for step in steps)
    assert len(frames_of(steps)) == 3


def parted_boxes():
    """Two boxes whose halves are parts of their own."""
    two = joined(box(center=(-1, 0, 0)), box(center=(1, 0, 0)))
    return [two, two], [FaceLabels(("left", "right"), np.repeat([0, 1], 12))] * 2


def test_nothing_waits_for_the_connectivity_of_the_shapes(monkeypatch):
    """It is read while all previews are there already."""
    seen, read = threading.Event(), []

    def patient(*args):
        read.append(seen.wait(20))
        return real(*args)

    real = morph_problem.connectivity_of
    monkeypatch.setattr(morph_problem, "connectivity_of", patient)
    for workers in (1, 2):
        seen.clear()
        blends, previews = path_blends(2, 5), 0
        inputs = MorphInputs.of(SHAPES[:2], NAMES[:2])
        for step in morph(inputs, blends, QUICK, computation=Computation(workers, previews=True)):
            previews += isinstance(step.payload, MorphPreview)
            if previews == len(blends):
                seen.set()
    assert read == [True] * 4


def test_a_preview_is_there_as_soon_as_its_blend_is_sketched(monkeypatch):
    """No sketch is begun here before all those before it have been seen."""
    seen, waited = threading.Semaphore(0), []

    def patient(*args):
        if waited:
            waited.append(seen.acquire(timeout=20))
        else:
            waited.append(True)
        return real(*args)

    real = blend_solver.BlendSolver.sketch
    monkeypatch.setattr(blend_solver.BlendSolver, "sketch", patient)
    inputs = MorphInputs.of(SHAPES[:2], NAMES[:2])
    for step in morph(inputs, path_blends(2, 6), QUICK, computation=Computation(1, previews=True)):
        if isinstance(step.payload, MorphPreview) and step.payload.frame.mesh is not None:
            seen.release()
    assert waited == [True] * 5


def test_previews_come_from_everywhere_the_nearest_run_first():
    blends = path_blends(2, 11)
    steps = steps_of(SHAPES[:2], blends, workers=1, looked_at=9)
    order = [blends.index(step.payload.frame.blend) for step in steps if isinstance(step.payload, MorphPreview)]
    assert order == [8, 4, 0, 9, 5, 1, 10, 6, 2, 11, 7, 3]
    assert [frame.blend for frame in frames_of(steps)] == blends


def test_sketches_are_limited_by_the_memory(monkeypatch):
    shapes, blends, coarse = SHAPES[:2], path_blends(2, 11), MorphSettings(motion="transport", resolution=20)
    problem = problem_of(shapes, coarse)
    frames = frames_of(steps_of(shapes, blends, coarse, workers=1))
    for fitting, previews in ((11, 8), (4, 4), (3, 0)):
        free = problem.lattice.memory(shapes, 1, 1) + fitting * problem.transport.sketch_bytes
        monkeypatch.setattr(memory, "available_memory", lambda free=free: free)
        steps = steps_of(shapes, blends, coarse, workers=1)
        assert sum(isinstance(step.payload, MorphPreview) for step in steps) == previews
        assert_same(frames_of(steps), frames)


@pytest.mark.parametrize("shapes", [[ball(), box()], [torus(1.0, 0.2), box((2.0, 0.3, 0.3))], parted_boxes()])
@pytest.mark.parametrize("sharpness", [0.0, 0.75])
def test_the_memory_of_sketches_is_estimated(shapes, sharpness):
    labels, settings = None, MorphSettings(motion="transport", resolution=48, sharpness=sharpness)
    if isinstance(shapes, tuple):
        shapes, labels = shapes
    problem, run = problem_of(shapes, settings, labels), path_blends(2, 5)[1:-1]
    list(blending.sketch_blends(problem, run))
    tracemalloc.start()
    sketches = list(blending.sketch_blends(problem, run))
    kept = tracemalloc.get_traced_memory()[0] / len(sketches)
    tracemalloc.stop()
    assert 0.4 < kept / problem.transport.sketch_bytes < 1.0


def test_sketches_are_let_go_once_their_blends_are_finished(monkeypatch):
    sketched = []

    def noting(*args, **options):
        solved = real(*args, **options)
        if "begun" not in options:
            sketched.append(weakref.ref(solved))
        return solved

    real = blend_solver.barycenter
    monkeypatch.setattr(blend_solver, "barycenter", noting)

    def alive():
        gc.collect()
        return sum(one() is not None for one in sketched)

    # What was there before takes most of the time of each collection.
    gc.collect()
    gc.freeze()
    blends, most, made = path_blends(2, 11), 0, 0
    for step in morph(MorphInputs.of(SHAPES[:2], NAMES[:2]), blends, QUICK, computation=Computation(1, previews=True)):
        if isinstance(step.payload, MorphPreview):
            most = max(most, alive())
        made += isinstance(step.payload, MorphFrame)
        if made == len(blends):
            # The last frame waits to be taken, and the thread that solved it may be about to let go.
            deadline = time.monotonic() + 10
            while alive() and time.monotonic() < deadline:
                time.sleep(0.005)
            assert not alive()
    gc.unfreeze()
    assert made == len(blends)
    assert most == 10


def test_connectivity_is_that_of_the_occupancy():
    shapes, labels = parted_boxes()
    for problem, own in ((problem_of(SHAPES, QUICK), SHAPES), (problem_of(shapes, QUICK, labels), shapes)):
        filled = [voxelized(one, NAMES[index], index, problem.lattice, 0.0) for index, one in enumerate(own)]
        assert problem.connectivity == tuple(connectivity_of(one, QUICK) for one in filled)
    assert [one.handles for one in problem_of(SHAPES, QUICK).connectivity] == [1, 0, 0]


def test_frames_of_the_cache_need_no_previews(tmp_path):
    cache = FrameCache(tmp_path)
    first = steps_of(cache=cache, wanted=range(4))
    again = steps_of(cache=cache)
    assert sum(isinstance(step.payload, MorphPreview) for step in first) == runs.RUN_LENGTH
    assert sum(isinstance(step.payload, MorphPreview) for step in again) == 7 - runs.RUN_LENGTH
    for one, other in zip(frames_of(again)[:4], frames_of(first), strict=True):
        assert one.blend == other.blend
        assert_as_stored(one, other)


def test_a_job_can_be_stopped_among_its_previews():
    control = Control()
    inputs = MorphInputs.of(SHAPES[:2], NAMES[:2])
    steps = morph(inputs, path_blends(2, 60), QUICK, control, computation=Computation(previews=True))
    assert any(isinstance(step.payload, MorphPreview) for step in steps)
    control.cancel()
    with pytest.raises(Cancelled):
        list(steps)


def test_a_coarse_preview_comes_first():
    blends, fine = path_blends(2, 11), MorphSettings(motion="transport", resolution=96)
    inputs = MorphInputs.of(SHAPES[:2], NAMES[:2])
    steps = morph(inputs, blends, fine, computation=Computation(previews=True, looked_at=7))
    first = next(steps)
    steps.close()
    assert first.fraction == 0.0
    assert blends.index(first.payload.frame.blend) == 7
    share = 7 / 11
    volume = (1 - share) * SHAPES[0].volume + share * SHAPES[1].volume
    assert abs(first.payload.frame.mesh.volume) == pytest.approx(volume, rel=0.1)


@pytest.mark.parametrize(("looked_at", "expected"), [(0, 1), (11, 10), (5, 5)])
def test_the_first_preview_is_of_the_nearest_unknown_blend(looked_at, expected):
    blends = path_blends(2, 11)
    inputs, settings = MorphInputs.of(SHAPES[:2], NAMES[:2]), MorphSettings(motion="transport", resolution=96)
    steps = morph(inputs, blends, settings, computation=Computation(previews=True, looked_at=looked_at))
    assert blends.index(next(steps).payload.frame.blend) == expected
    steps.close()


def test_without_anything_to_preview_the_morph_just_begins():
    thin, beside = box((2.0, 0.01, 0.01)), box((2.0, 0.01, 0.01), center=(0, 1, 0))
    for shapes, resolution in ((SHAPES[:2], 64), ((thin, beside), 96)):
        inputs, settings = MorphInputs.of(shapes, NAMES[:2]), MorphSettings(motion="transport", resolution=resolution)
        steps = morph(inputs, path_blends(2, 3), settings, computation=Computation(previews=True))
        assert next(steps).payload is None
        steps.close()
