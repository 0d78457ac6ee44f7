# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Blends between frames: those that a solve of their own would give, for a part of its rounds."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from convwass_addon.applications.morphs import between_frames as between
from convwass_addon.applications.morphs.between_frames import between_frames, places_at
from convwass_addon.applications.morphs.computation import Computation
from convwass_addon.applications.morphs.frame_cache import FrameCache
from convwass_addon.applications.morphs.frame_file import read_frame, write_frame
from convwass_addon.applications.morphs.layouts import path_blends, single_blend
from convwass_addon.applications.morphs.morph import morph
from convwass_addon.applications.morphs.morph_inputs import MorphInputs
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.applications.morphs.part_labels import FaceLabels
from convwass_addon.applications.motions.motion_choice import MotionChoice
from convwass_addon.applications.motions.motion_memory import MotionMemory
from convwass_addon.errors import InputError
from convwass_addon.geometry.meshes.centroid import centroid
from convwass_addon.geometry.meshes.closest_points import ClosestPointFinder
from convwass_addon.progress import drained
from tests.shapes import ball, box, joined

QUICK = MorphSettings(motion="transport", resolution=24)
# Solves at this resolution are so accurate that a hundredth of a frame and every setting show.
FINE = MorphSettings(motion="transport", resolution=32)
PATH = path_blends(2, 12)
# No two balls: something turns and something changes its size.
SHAPES = (
    joined(box((1, 0.4, 0.4)), ball(0.2, (0.9, 0, 0), 300)),
    joined(box((0.4, 1, 0.6)), ball(0.3, (-0.9, 0, 0), 300)),
)
NAMES = ("a", "b")
LABELS = [FaceLabels(("box", "ball"), np.repeat([0, 1], [12, len(shape.faces) - 12])) for shape in SHAPES]


def at(cache, *numbers, options=QUICK, labels=None):
    inputs = MorphInputs.of(SHAPES, NAMES, labels)
    steps = list(between_frames(inputs, PATH, numbers, options, Computation(2, cache=cache)))
    fractions = [step.fraction for step in steps]
    assert fractions == sorted(fractions)
    assert fractions[-1] == pytest.approx(1.0)
    return [step.payload for step in steps if step.payload]


def solved(weights, options=QUICK, labels=None):
    blend = single_blend(weights, 2)
    return next(s.payload for s in morph(MorphInputs.of(SHAPES, NAMES, labels), blend, options) if s.payload)


def distance(one, other):
    """Largest distance from a vertex of one surface to the other surface, however both are meshed."""
    meshes = (one.mesh, other.mesh)
    pairs = (meshes, meshes[::-1])
    return max(ClosestPointFinder(a.corners).find_about(b.vertices).distances.max() for a, b in pairs)


@pytest.fixture(scope="module")
def cache(tmp_path_factory):
    """All frames of the path."""
    kept = FrameCache(tmp_path_factory.mktemp("frames"))
    steps = morph(MorphInputs.of(SHAPES, NAMES), PATH, FINE, computation=Computation(2, cache=kept))
    assert len(list(steps)) >= len(PATH)
    return kept


@pytest.fixture
def cold(monkeypatch):
    """The weights of blends that were solved from nothing."""
    found = []

    def solve(problem, blends, control, real=between.solve_blends):
        found.extend(blend.weights for blend in blends)
        return real(problem, blends, control)

    monkeypatch.setattr(between, "solve_blends", solve)
    return found


@pytest.mark.parametrize("number", [4.35, 6.5, 7.9])
def test_between_frames_it_is_the_blend_for_a_part_of_the_rounds(cache, cold, number):
    (found,) = at(cache, number, options=FINE)
    truth = solved([1 - number / 12, number / 12], FINE)
    cell = 2.5 / 28
    assert found.record["between"] == (int(number), int(number) + 1)
    assert found.record["converged"]
    assert cold == []
    assert len(found.record["iterations"]) == 1
    assert found.record["iterations"][0] <= 0.5 * truth.record["iterations"][-1]
    assert found.mesh.volume == pytest.approx(truth.mesh.volume, rel=5e-3)
    assert distance(found, truth) < 0.75 * cell
    # Much closer than the neighboring frames.
    assert np.linalg.norm(centroid(found.mesh) - centroid(truth.mesh)) < 0.05 * cell


def spread(mesh):
    """Second moment of the solid along x, per volume."""
    x, volumes = mesh.corners[:, :, 0], mesh.face_volumes
    # Of tetrahedra with a corner at the origin.
    moments = volumes * ((x**2).sum(axis=1) + x.sum(axis=1) ** 2) / 20.0
    return moments.sum() / volumes.sum()


def test_from_frame_to_frame_it_moves_in_one_direction(cache, cold):
    found = [spread(frame.mesh) for frame in at(cache, 5, 5.02, 5.25, 5.5, 5.75, 5.98, 6, options=FINE)]
    steps = np.diff(found)
    assert cold == []
    # Next to a frame it hardly moves, and the remaining error of the solver dominates.
    assert (np.sign(steps[1:-1]) == np.sign(found[-1] - found[0])).all()
    assert np.abs(steps[[0, -1]]).max() < 0.2 * np.abs(found[-1] - found[0])


def test_whole_numbers_return_stored_frames(cache, monkeypatch):
    steps = morph(MorphInputs.of(SHAPES, NAMES), PATH, FINE, computation=Computation(cache=cache))
    stored = [step.payload for step in steps if step.payload]
    monkeypatch.setattr(between, "prepared_problem", None)
    found = at(cache, 12.0, 0, 7, options=FINE)
    assert [frame.blend.place for frame in found] == [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0)]
    for frame, index in zip(found, (12, 0, 7), strict=True):
        assert frame.record == stored[index].record
        assert frame.blend.weights == PATH[index].weights
        assert (frame.mesh is None) == (stored[index].mesh is None)
    np.testing.assert_array_equal(found[2].mesh.vertices, stored[7].mesh.vertices)
    np.testing.assert_array_equal(found[2].mesh.faces, stored[7].mesh.faces)


def test_numbers_count_the_blends_of_a_path_not_scene_frames(tmp_path):
    """There may be several scene frames from one blend to the next."""
    computation, path = Computation(2, cache=FrameCache(tmp_path)), path_blends(2, 8, 4)
    steps = between_frames(MorphInputs.of(SHAPES, NAMES), path, [1.0, 1.5], QUICK, computation)
    middle, between_both = (step.payload for step in steps if step.payload)
    assert middle.blend.weights == middle.record["weights"] == (0.5, 0.5)
    assert between_both.blend.weights == between_both.record["weights"] == (0.25, 0.75)


@pytest.mark.parametrize("number", [0.05, 0.5, 11.6])
def test_next_to_a_shape_it_starts_from_the_only_neighbor(cache, cold, number):
    (found,) = at(cache, number, options=FINE)
    truth = solved([1 - number / 12, number / 12], FINE)
    assert cold == []
    assert found.record["converged"]
    assert found.record["weights"] == pytest.approx((1 - number / 12, number / 12))
    assert found.mesh.volume == pytest.approx(truth.mesh.volume, rel=5e-3)
    assert distance(found, truth) < 2.5 / 28


def test_only_runs_about_the_numbers_are_computed_and_they_are_kept(tmp_path):
    kept = FrameCache(tmp_path)
    first = at(kept, 5.5, 6)
    assert len(list(tmp_path.iterdir())) == 4
    before = {path: path.stat().st_mtime_ns for path in tmp_path.iterdir()}
    again = at(kept, 5.5, 6)
    assert {path: path.stat().st_mtime_ns for path in tmp_path.iterdir()} == before
    for one, other in zip(first, again, strict=True):
        np.testing.assert_array_equal(one.mesh.vertices, other.mesh.vertices)


@pytest.mark.parametrize("options", [{"locality": 0.5}, {"entropy_limit": "max"}, {"blur": 1.5}, {"sharpness": 0.0}])
def test_settings_hold_between_frames_too(tmp_path, options):
    chosen = dataclasses.replace(FINE, **options)
    (found,) = at(FrameCache(tmp_path), 5.5, options=chosen)
    truth = solved([6.5 / 12, 5.5 / 12], chosen)
    assert found.record["between"] == (5, 6)
    assert distance(found, truth) < 2.5 / 28
    assert found.mesh.volume == pytest.approx(truth.mesh.volume, rel=0.01)


def test_parts_start_each_from_their_own(tmp_path, cold):
    (found,) = at(FrameCache(tmp_path), 5.5, labels=LABELS)
    truth = solved([6.5 / 12, 5.5 / 12], labels=LABELS)
    assert cold == []
    assert found.record["parts"] == pytest.approx(truth.record["parts"])
    assert found.record["parts"].keys() == {"box", "ball"}
    assert distance(found, truth) < 2.5 / 28
    # Shapes without parts give a different result.
    assert distance(found, solved([6.5 / 12, 5.5 / 12])) > 2 * 2.5 / 28


def rewritten(cache, index, change):
    """Put other potentials, with a hash that is right, into a frame of the cache."""
    run = tuple(PATH[index - index % 4 : index - index % 4 + 4])
    path = cache.of(MorphInputs.of(SHAPES, NAMES), QUICK).paths(run)[index % 4]
    frame = read_frame(path, path.stem)
    potentials = tuple(change(part) for part in frame.potentials)
    write_frame(path, path.stem, dataclasses.replace(frame, potentials=potentials))
    return path


@pytest.mark.parametrize(
    "change",
    [
        lambda part: dataclasses.replace(part, sigma=1e9),
        lambda part: dataclasses.replace(part, inside=part.inside[:, :, ::-1].copy().reshape(1, 1, -1)),
        lambda part: dataclasses.replace(part, columns=np.full_like(part.columns, 3e38)),
    ],
    ids=["no blur", "another grid", "nonsense"],
)
def test_potentials_that_do_not_fit_are_not_started_from(tmp_path, cold, change):
    kept = FrameCache(tmp_path)
    (expected,) = at(kept, 5.5)
    rewritten(kept, 5, change)
    rewritten(kept, 6, change)
    (found,) = at(kept, 5.5)
    assert len(cold) == 1
    assert found.record["converged"]
    assert found.record["between"] == (5, 6)
    assert distance(found, expected) < 2.5 / 28


def test_neighbors_of_different_blur_are_no_start(tmp_path, cold):
    """Not even where a few rounds would lead from them to the blend of the first one's blur."""
    kept = FrameCache(tmp_path)
    at(kept, 5.5)
    assert cold == []
    rewritten(kept, 5, lambda part: dataclasses.replace(part, sigma=1.1 * part.sigma))
    at(kept, 5.5)
    assert len(cold) == 1


@pytest.mark.parametrize("damage", ["cut", "stripped"])
def test_damaged_potentials_are_named_and_made_again(tmp_path, damage):
    kept = FrameCache(tmp_path)
    (expected,) = at(kept, 5.5)
    path = rewritten(kept, 5, lambda part: part)
    whole = path.read_bytes()
    if damage == "cut":
        path.write_bytes(whole[:-4])
    else:
        frame = read_frame(path, path.stem)
        write_frame(path, path.stem, dataclasses.replace(frame, potentials=()))
    kept = FrameCache(tmp_path)
    (found,) = at(kept, 5.5)
    assert len(kept.notices) == 1
    assert str(path) in str(kept.notices[0])
    assert path.read_bytes() == whole
    np.testing.assert_array_equal(found.mesh.vertices, expected.mesh.vertices)


@pytest.mark.parametrize(
    ("numbers", "message"),
    [
        ([], "at least one"),
        ([12.01], "frames 0-12"),
        ([3, -0.5], "frames 0-12"),
        ([float("nan")], "not on the path"),
        ([float("inf")], "not on the path"),
        ([3.5, 4, 3.5], "3.5 is there twice"),
    ],
)
def test_numbers_that_are_no_places_are_refused(numbers, message):
    with pytest.raises(InputError, match=message):
        places_at(PATH, numbers)


def test_a_blend_of_a_path_has_the_motion_of_the_path(tmp_path, monkeypatch):
    """Alone, the first two shapes might get another one."""
    asked = []

    def chosen(self, request, control):
        asked.append(list(request.pairs))
        yield from ()
        return MotionChoice("transport", "APART")

    monkeypatch.setattr(MotionMemory, "chosen", chosen)
    shapes, settings = (*SHAPES, SHAPES[0]), MorphSettings(resolution=32, motion="warp")
    computation = Computation(cache=FrameCache(tmp_path))
    drained(between_frames(MorphInputs.of(shapes, ("a", "b", "c")), path_blends(3, 4), [1.5], settings, computation))
    assert asked == [[(0, 1), (1, 2)]]
