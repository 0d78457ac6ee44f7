# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames in a folder: they are read as written, up to a known rounding, or not at all, and never computed twice."""

from __future__ import annotations

import dataclasses
import os
import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings, strategies as st
from hypothesis.extra.numpy import arrays

from convwass_addon.applications.morphs import bake_plan, frame_cache, frame_file
from convwass_addon.applications.morphs.animation import Animation, ShapeAnimation
from convwass_addon.applications.morphs.compact_arrays import packed_integers
from convwass_addon.applications.morphs.computation import Computation
from convwass_addon.applications.morphs.demands import Demand
from convwass_addon.applications.morphs.frame_cache import FrameCache, SpareFrameCache
from convwass_addon.applications.morphs.frame_file import DamagedFrameError, StoredFrame, read_frame, write_frame
from convwass_addon.applications.morphs.layouts import path_blends
from convwass_addon.applications.morphs.morph import morph
from convwass_addon.applications.morphs.morph_inputs import MorphInputs
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.applications.morphs.part_labels import FaceLabels
from convwass_addon.applications.morphs.part_potentials import PartPotentials
from convwass_addon.applications.morphs.runs import RUN_LENGTH, runs_of
from convwass_addon.applications.morphs.surface_steps import MeasuredSurface, farthest
from convwass_addon.applications.morphs.transport_problem import TransportProblem
from convwass_addon.array_files import array_bytes
from convwass_addon.errors import Cancelled, ConvwassError, InputError
from convwass_addon.geometry.level_sets.connectivity import Connectivity
from convwass_addon.progress import UNINTERRUPTED
from tests.controls import ConditionalControl
from tests.shapes import ball, box
from tests.stored_frames import assert_as_stored

QUICK = MorphSettings(motion="transport", resolution=16)
KEY = "0" * 64
BLENDS = path_blends(2, 10)
SHAPES = (ball(), box())


@pytest.fixture
def solved(monkeypatch):
    """The runs that were really computed, as a list of their first frames."""
    found = []

    def in_threads(problem, runs, *arguments, real=bake_plan.runs_in_threads):
        found.extend(run[0].frame for run in runs.values())
        return real(problem, runs, *arguments)

    monkeypatch.setattr(bake_plan, "runs_in_threads", in_threads)
    return found


def bake(cache=None, wanted=None, control=UNINTERRUPTED, workers=2):
    computation = Computation(workers, cache=cache, wanted=wanted)
    steps = morph(MorphInputs.of(SHAPES, ["a", "b"]), BLENDS, QUICK, control, computation=computation)
    return [step.payload for step in steps if step.payload]


@pytest.fixture(scope="module")
def expected():
    """All frames, without a cache."""
    return bake()


def assert_same(found, expected):
    assert [frame.blend for frame in found] == [frame.blend for frame in expected]
    for one, other in zip(found, expected, strict=True):
        assert one.record == other.record
        assert_as_stored(one, other)
        if one.mesh is not None:
            assert one.origins.shape == (2, len(one.mesh.vertices), 3)


def written(path, frame=None, key=KEY):
    write_frame(path, key, frame or StoredFrame(box(), {"converged": True}))
    return bytearray(path.read_bytes())


def test_frames_that_were_kept_are_the_frames_and_are_not_computed_again(tmp_path, solved, expected):
    assert_same(bake(FrameCache(tmp_path)), expected)
    assert solved == [0, 4, 8]
    assert_same(bake(FrameCache(tmp_path)), expected)
    assert solved == [0, 4, 8]
    assert len(list(tmp_path.iterdir())) == len(BLENDS)


def test_a_complete_cache_needs_no_voxels(tmp_path, monkeypatch):
    expected = bake(FrameCache(tmp_path))
    monkeypatch.setattr(bake_plan, "sketchable_problem", None)
    assert_same(bake(FrameCache(tmp_path)), expected)


def test_an_interrupted_bake_continues(tmp_path, solved, expected):
    inputs = MorphInputs.of(SHAPES, ["a", "b"])
    steps = morph(inputs, BLENDS, QUICK, computation=Computation(1, cache=FrameCache(tmp_path)))
    assert next(step for step in steps if step.payload)
    steps.close()
    kept = len(list(tmp_path.iterdir()))
    assert RUN_LENGTH <= kept < len(BLENDS)
    solved.clear()
    assert_same(bake(FrameCache(tmp_path)), expected)
    assert 0 not in solved[:2]


def test_runs_that_are_finished_before_their_turn_are_kept_too(tmp_path, monkeypatch):
    """The last run ends first and the first never ends; the frames of the last are in the folder nevertheless."""
    last = len(BLENDS) % RUN_LENGTH

    control = ConditionalControl(lambda: len(list(tmp_path.iterdir())) >= last)
    monkeypatch.setattr(TransportProblem, "effort", lambda problem, blend: blend.frame**4)
    with pytest.raises(Cancelled):
        list(bake(FrameCache(tmp_path), control=control, workers=1))
    assert len(list(tmp_path.iterdir())) == last


@pytest.mark.parametrize(
    ("wanted", "made"), [(range(5, 6), range(4, 8)), (range(3, 9), range(11)), (range(11), range(11))]
)
def test_a_range_is_computed_in_complete_runs(tmp_path, wanted, made, expected):
    frames = bake(FrameCache(tmp_path), wanted)
    assert_same(frames, [expected[index] for index in made])
    assert len(list(tmp_path.iterdir())) == len(made)


def test_ranges_together_are_the_complete_morph(tmp_path, solved, expected):
    for wanted in (range(8, 11), range(4), range(4, 8)):
        bake(FrameCache(tmp_path), wanted)
    assert solved == [8, 0, 4]
    solved.clear()
    together = bake(FrameCache(tmp_path))
    assert solved == []
    assert_same(together, expected)


@pytest.mark.parametrize("wanted", [range(0), range(11, 12), range(-1, 3), range(5, 12)])
def test_ranges_outside_are_refused(wanted):
    with pytest.raises(InputError, match="between 0 and 10"):
        runs_of(BLENDS, wanted)


@given(count=st.integers(1, 60), data=st.data())
def test_every_blend_is_in_one_run_and_runs_do_not_depend_on_the_range(count, data):
    blends = list(range(count))
    runs = runs_of(blends)
    assert [blend for run in runs for blend in run] == blends
    first = data.draw(st.integers(0, count - 1))
    last = data.draw(st.integers(first, count - 1))
    chosen = runs_of(blends, range(first, last + 1))
    assert set(chosen) == {run for run in runs if set(run) & set(range(first, last + 1))}


def keys(shapes=SHAPES, names=("a", "b"), labels=None, options=QUICK, blends=BLENDS, pairs=(), animation=None):
    inputs = MorphInputs.of(shapes, names, labels, animation=animation)
    with tempfile.TemporaryDirectory() as folder:
        cache = FrameCache(Path(folder)).of(inputs, options, pairs)
        return [path.name for path in cache.paths(blends)]


def test_every_frame_has_its_own_name():
    assert len(set(keys())) == len(BLENDS)
    assert keys() == keys()


LABELS = [FaceLabels(("head",), np.zeros(len(shape.faces), np.int64)) for shape in (ball(), box())]


@pytest.mark.parametrize(
    "other",
    [
        {"shapes": (ball(), box().moved((0, 0, 1e-12)))},
        {"shapes": (ball(), box().flipped())},
        {"shapes": (box(), ball())},
        {"labels": LABELS},
    ],
    ids=["a vertex", "a face", "the order", "parts"],
)
def test_whatever_decides_a_frame_is_in_its_name(other):
    assert not set(keys(**other)) & set(keys())


@pytest.mark.parametrize("name", [field.name for field in dataclasses.fields(MorphSettings)])
def test_every_setting_is_in_the_name(name):
    changed = dataclasses.replace(QUICK)
    # Whatever the setting takes: only that it differs matters here.
    object.__setattr__(changed, name, "another")
    assert not set(keys(options=changed)) & set(keys())


def test_a_motion_depends_on_the_pairs_that_it_has_to_suit():
    moving = dataclasses.replace(QUICK, motion="automatic")
    alone, both = [(0, 1)], [(0, 1), (1, 2)]
    assert not set(keys(options=moving, pairs=alone)) & set(keys(options=moving, pairs=both))
    assert keys(pairs=alone) == keys(pairs=both)


def test_animated_inputs_are_in_the_name():
    shapes = (ball(), box())
    poses = tuple(ShapeAnimation((0.0, 1.0), (own, own.moved((1, 0, 0)))) for own in shapes)
    names = [keys(animation=Animation(poses, stations)) for stations in ((0.0, 1.0), (0.0, 2.0))]
    assert not set(names[0]) & set(names[1])
    assert not set(names[0]) & set(keys())


def test_the_key_of_a_frame_depends_on_the_blends_before_it():
    assert keys(blends=BLENDS[:3]) == keys()[:3]
    assert keys(blends=BLENDS[1:4])[0] != keys()[1]


def test_names_of_shapes_count_only_where_parts_are_spoken_of():
    assert keys(names=("c", "d")) == keys()
    assert keys(names=("c", "d"), labels=LABELS) != keys(labels=LABELS)


points = st.floats(-1e300, 1e300)
figures = st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(max_size=5)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    vertices=st.lists(st.tuples(points, points, points), min_size=1, max_size=5),
    corners=st.lists(st.tuples(*[st.integers(0, 4)] * 3), max_size=5),
    record=st.dictionaries(st.text(max_size=3), figures | st.tuples(figures, figures)),
)
def test_frames_survive_writing_and_reading(tmp_path, vertices, corners, record):
    mesh = frame_file.TriangleMesh.from_arrays(vertices, np.reshape(corners, (-1, 3)) % len(vertices))
    write_frame(tmp_path / "f", KEY, StoredFrame(mesh, record))
    found = read_frame(tmp_path / "f", KEY)
    assert found.record == record
    size = np.ptp(mesh.vertices, axis=0).max()
    largest = np.abs(mesh.vertices).max()
    # Half a step, and the accuracy of the numbers themselves.
    assert np.abs(found.mesh.vertices - mesh.vertices).max() <= size * 2.0**-17 + largest * 2.0**-52
    np.testing.assert_array_equal(found.mesh.faces, mesh.faces)
    assert os.listdir(tmp_path) == ["f"]


def test_frames_that_were_read_demand_the_same(tmp_path):
    """Otherwise blends that are computed again would differ from those of the first bake, and never be found."""
    mesh = ball(0.37, (10.0, -3.0, 0.2))
    write_frame(tmp_path / "f", KEY, StoredFrame(mesh, {}))
    read = read_frame(tmp_path / "f", KEY).mesh
    assert (read.vertices != mesh.vertices).any()
    surfaces = [MeasuredSurface.of_blend(own) for own in (mesh, read)]
    beside = MeasuredSurface.of_shape(box())
    reaches = [farthest(own, beside) for own in surfaces]
    demands = [Demand(Connectivity(1, 0, 0), own.mesh, reach) for own, reach in zip(surfaces, reaches, strict=True)]
    assert demands[0].digest() == demands[1].digest()


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=80)
@given(data=st.data())
def test_any_changed_byte_and_any_missing_end_is_noticed(tmp_path, data):
    content = written(tmp_path / "f")
    place = data.draw(st.integers(0, len(content) - 1))
    if data.draw(st.booleans()):
        content[place] ^= data.draw(st.integers(1, 255))
    else:
        del content[place:]
    (tmp_path / "f").write_bytes(content)
    with pytest.raises(DamagedFrameError):
        read_frame(tmp_path / "f", KEY)


GOOD = {"key": KEY, "potentials": [], "record": {}}
SOLVED = GOOD | {"potentials": [{"sharpness": 0.75, "sigma": 1.25}]}
SURFACE = {"vertices": np.zeros((1, 2, 3)), "faces": packed_integers(np.array([[0, 1, 1]]))}
STEPS = SURFACE | {"vertices": packed_integers(np.arange(6).reshape(3, 2))}
ROUNDED = GOOD | {"rounding": {"vertices": [3, [[0.0, 1.0, 2.0]]]}}
PART = {"inside.0": np.arange(12).reshape(2, 2, 3) % 5 == 0, "columns.0": np.arange(6, dtype=np.float32).reshape(2, 3)}


def solved_with(**changed):
    return SOLVED | {"potentials": [SOLVED["potentials"][0] | changed]}


def with_column(value):
    columns = PART["columns.0"].copy()
    columns[1, 2] = value
    return PART | {"columns.0": columns}


def with_vertex(value):
    return SURFACE | {"vertices": np.array([[[0, 0, value], [0, 0, 0]]])}


def with_face(*corners):
    return SURFACE | {"faces": packed_integers(np.array([corners]))}


@pytest.mark.parametrize(
    ("header", "arrays", "reason"),
    [
        (GOOD, with_face(0, 1, 2), "do not exist"),
        (GOOD, with_face(0, 1, -1), "do not exist"),
        (GOOD, with_face(0, 1), "not made of triangles"),
        (GOOD, with_vertex(np.nan), "not numbers"),
        (GOOD, with_vertex(np.inf), "not numbers"),
        (GOOD, {"vertices": SURFACE["vertices"]}, "faces is missing"),
        (GOOD, {"faces": SURFACE["faces"]}, "more than it should"),
        (GOOD, SURFACE | {"vertices": np.zeros((1, 2, 3), np.float32)}, "another type"),
        (GOOD | {"key": "1" * 64}, SURFACE, "another frame"),
        (None, SURFACE, "key"),
        ({"key": KEY}, {}, "record"),
        ({"key": KEY, "record": {}}, {}, "potentials"),
        (ROUNDED | {"rounding": {"vertices": [3, [[0, 0]]]}}, STEPS, "no step"),
        (ROUNDED | {"rounding": {"vertices": [True, [[0, 0, 0]]]}}, STEPS, "no step"),
        (ROUNDED | {"rounding": {"vertices": [4000, [[0, 0, 0]]]}}, STEPS, "no step"),
        (ROUNDED | {"rounding": {"vertices": [3, [[0, 0, 0]] * 2]}}, STEPS, "three coordinates"),
        (ROUNDED | {"rounding": {"vertices": [3, [[0, 0, float("inf")]]]}}, STEPS, "not numbers"),
        (ROUNDED | {"rounding": [1]}, STEPS, "no table"),
        (ROUNDED, SURFACE, "another type"),
        (ROUNDED, STEPS | {"faces": np.full((4, 1, 3), 255, np.uint8)}, "too large"),
        (ROUNDED, STEPS | {"faces": np.zeros((3, 1, 3), np.uint8)}, "four bytes"),
        (GOOD, SURFACE | {"origins": np.zeros((2, 3, 3))}, "not those of its vertices"),
        (GOOD, {"origins": np.zeros((2, 2, 3))}, "not those of its vertices"),
        (GOOD, SURFACE | {"origins": np.full((1, 2, 3), np.nan)}, "not numbers"),
        (GOOD, SURFACE | {"origins": np.full((1, 2, 3), 1e300)}, "not numbers"),
        (GOOD, SURFACE | {"triangles": packed_integers(np.zeros((2, 3), int))}, "not those of its surface"),
        (GOOD, {"triangles": packed_integers(np.zeros((2, 1), int))}, "not those of its surface"),
        (SOLVED, {}, "inside.0 is missing"),
        (GOOD, PART, "more than it should"),
        (SOLVED, PART | {"columns.0": PART["columns.0"][:, :2]}, "size of their cells"),
        (SOLVED, PART | {"columns.0": PART["columns.0"][:1]}, "size of their cells"),
        (SOLVED, PART | {"inside.0": np.zeros((2, 2, 3), bool)}, "no cells"),
        (SOLVED, PART | {"inside.0": np.ones((2, 2), bool)}, "another type"),
        (SOLVED, PART | {"inside.0": np.ones((2, 2, 3), np.uint8)}, "another type"),
        (SOLVED, with_column(np.nan), "not numbers"),
        (SOLVED, with_column(np.inf), "not numbers"),
        (SOLVED, with_column(-10001), "not numbers"),
        (solved_with(sharpness=1.5), PART, "no solve"),
        (solved_with(sharpness=True), PART, "no solve"),
        (solved_with(sigma=0), PART, "no solve"),
        (solved_with(sigma=float("nan")), PART, "no solve"),
        (solved_with(sigma="1"), PART, "no solve"),
        (GOOD | {"potentials": {}}, {}, "no list"),
        (GOOD | {"potentials": [3]}, {}, "no list"),
        (GOOD | {"record": [1]}, {}, "no table"),
        (GOOD | {"record": {"notices": "x"}}, {}, "notices"),
        (GOOD | {"record": {"converged": "yes"}}, {}, "converged"),
        (GOOD | {"record": {"marginal_error": "small"}}, {}, "marginal_error"),
    ],
)
def test_files_that_lie_are_refused(tmp_path, header, arrays, reason):
    path = tmp_path / "f"
    path.write_bytes(array_bytes(arrays, header))
    with pytest.raises(DamagedFrameError, match=reason):
        read_frame(path, KEY)


def test_the_triangles_of_inputs_are_kept(tmp_path):
    triangles = np.array([[7], [-1]], np.int32)
    mesh = frame_file.TriangleMesh(np.zeros((2, 3)), np.array([[0, 1, 1], [1, 0, 0]])[:1])
    write_frame(tmp_path / "f", KEY, StoredFrame(mesh, {}, triangles=triangles))
    np.testing.assert_array_equal(read_frame(tmp_path / "f", KEY).triangles, triangles)


def test_the_good_example_is_good(tmp_path):
    (tmp_path / "f").write_bytes(array_bytes(SURFACE, GOOD))
    assert len(read_frame(tmp_path / "f", KEY).mesh.faces) == 1
    (tmp_path / "f").write_bytes(array_bytes(STEPS, ROUNDED))
    np.testing.assert_array_equal(read_frame(tmp_path / "f", KEY).mesh.vertices, [[0, 17, 34], [8, 25, 42]])
    (tmp_path / "f").write_bytes(array_bytes(PART, SOLVED))
    (part,) = read_frame(tmp_path / "f", KEY).potentials
    np.testing.assert_array_equal(np.flatnonzero(part.inside), [0, 5, 10])
    np.testing.assert_array_equal(part.columns, [[0, 1, 2], [3, 4, 5]])


@given(st.data())
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_potentials_that_are_written_are_read(tmp_path, data):
    shape = data.draw(st.tuples(*[st.integers(1, 4)] * 3))
    inside = data.draw(arrays(bool, shape).filter(np.any))
    values = st.floats(-1e4, 2.0**100, width=32)
    columns = data.draw(arrays(np.float32, (data.draw(st.integers(2, 4)), int(inside.sum())), elements=values))
    kept = tuple(PartPotentials(inside, columns, sharpness, 1.25) for sharpness in (0.0, 0.75))
    write_frame(tmp_path / "f", KEY, StoredFrame(box(), {}, kept))
    found = read_frame(tmp_path / "f", KEY).potentials
    assert [part.sharpness for part in found] == [0.0, 0.75]
    for part in found:
        np.testing.assert_array_equal(part.inside, inside)
        np.testing.assert_array_equal(part.columns, columns)


def test_files_that_are_too_large_are_not_read(tmp_path):
    with open(tmp_path / "f", "wb") as file:
        file.truncate(3 << 30)
    with pytest.raises(DamagedFrameError, match="too large"):
        read_frame(tmp_path / "f", KEY)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="Windows has no named pipes")
def test_pipes_links_and_folders_are_left_alone(tmp_path):
    outside = tmp_path / "outside"
    written(outside)
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "link").symlink_to(outside)
    (tmp_path / "folder").mkdir()
    for name in ("pipe", "link", "folder"):
        with pytest.raises(DamagedFrameError, match="regular file"):
            read_frame(tmp_path / name, KEY)
    # Writing to a link replaces the link, not its target.
    before = outside.read_bytes()
    written(tmp_path / "link", StoredFrame(None, {}))
    assert outside.read_bytes() == before
    assert not (tmp_path / "link").is_symlink()


def test_damaged_frames_are_named_and_made_again(tmp_path, solved):
    expected = bake(FrameCache(tmp_path))
    solved.clear()
    damaged = FrameCache(tmp_path).of(MorphInputs.of(SHAPES, ["a", "b"]), QUICK).paths(BLENDS[4:8])[2]
    damaged.write_bytes(damaged.read_bytes()[:-1])
    cache = FrameCache(tmp_path)
    assert_same(bake(cache), expected)
    assert solved == [4]
    assert len(cache.notices) == 1
    assert str(damaged) in str(cache.notices[0])
    cache = FrameCache(tmp_path)
    bake(cache)
    assert cache.notices == []


def test_a_frame_that_vanishes_while_it_is_being_read_ends_the_bake(tmp_path):
    bake(FrameCache(tmp_path))
    inputs = MorphInputs.of(SHAPES, ["a", "b"])
    steps = morph(inputs, BLENDS, QUICK, computation=Computation(cache=FrameCache(tmp_path)))
    next(steps)
    for path in tmp_path.iterdir():
        path.unlink()
    with pytest.raises(ConvwassError, match="lost a frame"):
        list(steps)


def test_two_machines_may_write_the_same_frame(tmp_path, monkeypatch):
    """Windows does not replace what another machine is reading."""
    first = bake(wanted=range(1))[0]
    cache = FrameCache(tmp_path).of(MorphInputs.of(SHAPES, ["a", "b"]), QUICK)
    cache.save(BLENDS[:1], [first])
    monkeypatch.setattr(os, "replace", lambda *_: (_ for _ in ()).throw(PermissionError(13, "in use")))
    cache.save(BLENDS[:1], [first])
    with pytest.raises(ConvwassError, match="in use"):
        cache.save(BLENDS[1:2], [first])
    assert len(list(tmp_path.iterdir())) == 1


def test_folders_that_cannot_be_are_refused(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot be made"):
        FrameCache(tmp_path / "file")
    with pytest.raises(InputError, match="cannot be made"):
        FrameCache(tmp_path / "file" / "folder")
    assert FrameCache(tmp_path / "new" / "folder").folder.is_dir()


def test_spare_frames_take_a_bake_up_again_and_are_smaller(tmp_path, solved):
    """Blender is closed during a bake: finished frames are kept although no cache was requested."""
    spare, asked = tmp_path / "spare", tmp_path / "asked"
    inputs = MorphInputs.of(SHAPES, ["a", "b"])
    steps = morph(inputs, BLENDS, QUICK, computation=Computation(1, cache=SpareFrameCache(spare, 1 << 30)))
    assert next(step for step in steps if step.payload)
    steps.close()
    solved.clear()
    cache = SpareFrameCache(spare, 1 << 30)
    assert_same(bake(cache), bake(FrameCache(asked)))
    assert RUN_LENGTH <= cache.reused < len(BLENDS)
    assert 0 not in solved[:2]
    sizes = [sum(path.stat().st_size for path in folder.iterdir()) for folder in (spare, asked)]
    assert sizes[0] < 0.75 * sizes[1]


def test_the_oldest_spare_frames_go_first(tmp_path):
    for age in range(5):
        written(tmp_path / f"{age}.frame")
        os.utime(tmp_path / f"{age}.frame", (1e9 - age, 1e9 - age))
    (tmp_path / "mine.txt").write_text("x" * 100_000)
    size = (tmp_path / "0.frame").stat().st_size
    SpareFrameCache(tmp_path, 3 * size)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["0.frame", "1.frame", "2.frame", "mine.txt"]


def test_a_bake_continues_if_spare_frames_cannot_be_written(tmp_path, monkeypatch, expected):
    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(frame_cache, "write_frame", full)
    cache = SpareFrameCache(tmp_path, 1 << 30)
    assert_same(bake(cache), expected)
    assert [str(notice) for notice in cache.notices] == [
        f"Frames are not kept in {tmp_path} for the case of an interruption (No space left on device)."
    ]
    with pytest.raises(ConvwassError, match="choose another folder"):
        bake(FrameCache(tmp_path))
