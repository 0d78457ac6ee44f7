# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

from dataclasses import replace

import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import given, settings

from convwass_addon.applications import memory
from convwass_addon.applications.morphs import blend_solver
from convwass_addon.applications.morphs.layouts import single_blend
from convwass_addon.applications.morphs.merging import merged_parts
from convwass_addon.applications.morphs.morph import morph
from convwass_addon.applications.morphs.morph_inputs import MorphInputs
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.applications.morphs.part_labels import FaceLabels, matched, part_notices, unparted
from convwass_addon.applications.morphs.parts import joined, nearest_labels, part_volumes
from convwass_addon.applications.morphs.volumes import Lattice, fitting_workers
from convwass_addon.errors import InputError, ResourceError
from convwass_addon.geometry.meshes.edges import topology
from convwass_addon.geometry.solids.occupancy import occupancy
from tests.shapes import ball, box, joined as one_mesh, torus

QUICK = MorphSettings(motion="transport", resolution=48)
BALL_FACES = len(ball().faces)


def labeled(names, *face_counts):
    """Every name on its number of faces, in order; a name of None labels nothing."""
    own = tuple(name for name in names if name is not None)
    places = [own.index(name) if name is not None else -1 for name in names]
    return FaceLabels(own, np.repeat(places, face_counts))


def pair(left, right):
    """Two balls apart on the x axis, of these radii."""
    return one_mesh(ball(left, (-1, 0, 0)), ball(right, (1, 0, 0)))


def of_pair(left, right):
    return labeled((left, right), BALL_FACES, BALL_FACES)


def blended(shapes, labels, weights, options=QUICK, **others):
    blend = single_blend(weights, len(shapes))
    inputs = MorphInputs.of(shapes, ["A", "B"], labels)
    return next(s.payload for s in morph(inputs, blend, options, **others) if s.payload)


def halves(mesh):
    """Labels of a mesh by the side of the yz plane that its triangles lie on."""
    return FaceLabels(("left", "right"), (mesh.corners[:, :, 0].mean(axis=1) > 0).astype(np.int64))


def beyond(mesh, place):
    """The vertices on the left of a place on the x axis."""
    return mesh.vertices[mesh.vertices[:, 0] < place]


def test_balls_with_crossed_names_cross_over():
    shapes, labels = [pair(0.25, 0.5), pair(0.5, 0.25)], [of_pair("x", "y"), of_pair("y", "x")]
    mesh = blended(shapes, labels, [0.75, 0.25]).mesh
    # The small ball goes from -1 to 1, the large one from 1 to -1.
    small = beyond(mesh, -0.1)
    np.testing.assert_allclose((small.max(axis=0) + small.min(axis=0)) / 2, (-0.5, 0, 0), atol=0.03)
    np.testing.assert_allclose(np.ptp(small, axis=0) / 2, 0.25, atol=0.06)
    large = mesh.vertices[mesh.vertices[:, 0] > -0.1]
    np.testing.assert_allclose((large.max(axis=0) + large.min(axis=0)) / 2, (0.5, 0, 0), atol=0.03)
    np.testing.assert_allclose(np.ptp(large, axis=0) / 2, 0.5, atol=0.06)


def test_without_parts_the_same_balls_do_not_move():
    mesh = blended([pair(0.25, 0.5), pair(0.5, 0.25)], None, [0.75, 0.25]).mesh
    assert mesh.bounds[0, 0] < -1.1
    assert mesh.bounds[1, 0] > 1.3


def test_parts_in_one_place_count_once():
    """Half-way two balls that change places are one: a surface around the volume of both would be no ball of theirs."""
    shapes, labels = [pair(0.5, 0.5)] * 2, [of_pair("x", "y"), of_pair("y", "x")]
    frame = blended(shapes, labels, [0.5, 0.5])
    both = shapes[0].volume
    # At the soft edge of both no cell is more than full; these cells count twice.
    assert 0.5 * both < frame.record["volume_wanted"] < 0.7 * both
    np.testing.assert_allclose(np.linalg.norm(frame.mesh.vertices, axis=1), 0.5, atol=0.06)


def test_parts_have_the_mean_of_their_volumes():
    shapes, labels = [pair(0.6, 0.4), pair(0.45, 0.55)], [of_pair("x", "y")] * 2
    frame = blended(shapes, labels, [0.75, 0.25])
    wanted = np.array([0.75 * 0.6**3 + 0.25 * 0.45**3, 0.75 * 0.4**3 + 0.25 * 0.55**3])
    shares = [frame.record["parts"][name] for name in ("x", "y")]
    np.testing.assert_allclose(shares, wanted / wanted.sum(), atol=2e-3)
    is_left = frame.mesh.corners[:, :, 0].mean(axis=1) < 0
    signed = frame.mesh.face_volumes
    # Closed pieces have the same volume about any point.
    np.testing.assert_allclose([signed[is_left].sum(), signed[~is_left].sum()], wanted * 4 / 3 * np.pi, rtol=0.04)
    assert frame.mesh.volume == pytest.approx(wanted.sum() * 4 / 3 * np.pi, rel=0.01)


@pytest.mark.parametrize("sharpness", [None, 1.0])
def test_equal_shapes_with_equal_parts_are_given_back(sharpness):
    shape = torus()
    frame = blended(
        [shape, shape],
        [halves(shape)] * 2,
        [0.5, 0.5],
        MorphSettings(motion="transport", resolution=48, sharpness=sharpness),
    )
    ring = np.linalg.norm(frame.mesh.vertices[:, :2], axis=1) - 1
    cell = 2.7 / 40
    assert np.abs(np.hypot(ring, frame.mesh.vertices[:, 2]) - 0.35).max() < 0.5 * cell
    assert frame.mesh.volume == pytest.approx(shape.volume, rel=0.01)
    assert topology(frame.mesh).closed


def test_one_part_for_all_is_the_plain_morph_to_the_last_bit():
    shapes = [torus(), box((1, 2, 1))]
    plain = blended(shapes, None, [0.6, 0.4])
    named = blended(shapes, [labeled(("all",), len(shape.faces)) for shape in shapes], [0.6, 0.4])
    np.testing.assert_array_equal(named.mesh.vertices, plain.mesh.vertices)
    np.testing.assert_array_equal(named.mesh.faces, plain.mesh.faces)
    assert named.record == plain.record
    assert "parts" not in plain.record


def test_a_single_density_is_unchanged():
    density = np.random.default_rng(0).random((4, 5, 6))
    merged = merged_parts([density], np.array([7.0]))
    assert merged.density is density
    assert (merged.volume, merged.overlap) == (7.0, 0.0)


def split_box(seam):
    """A long box with a seam across, in cells of a grid of 40 x 12 x 12."""
    cells = (40, 12, 12)
    meshes = [
        box((seam - 4, 6, 6), (4 + (seam - 4) / 2, 6, 6)),
        box((36 - seam, 6, 6), (seam + (36 - seam) / 2, 6, 6)),
    ]
    filled = occupancy(box((32, 6, 6), (20, 6, 6)).corners, cells)
    # Without the two walls inside, at the seam.
    outer = [m.corners[~(m.corners[:, :, 0] == seam).all(axis=1)] for m in meshes]
    return filled, np.concatenate(outer), np.repeat([0, 1], [len(c) for c in outer])


@given(st.integers(10, 30))
@settings(max_examples=10, deadline=None)
def test_labels_of_a_box_in_two_are_exact(seam):
    filled, corners, faces = split_box(seam)
    labels = nearest_labels(filled > 0, corners, faces)
    x = np.arange(40)[:, None, None] + 0.5
    np.testing.assert_array_equal(labels[filled > 0], np.broadcast_to(x > seam, filled.shape)[filled > 0])
    assert (labels[filled == 0] == -1).all()


@given(st.integers(10, 30))
@settings(max_examples=10, deadline=None)
def test_parts_add_up_to_the_shape_and_fade_at_the_seam_only(seam):
    filled, corners, faces = split_box(seam)
    left, right, none = part_volumes(filled, corners, faces, 3)
    np.testing.assert_allclose(left + right, filled, atol=1e-6)
    assert not none.any()
    assert left.sum() == pytest.approx(filled[:seam].sum(), rel=5e-3)
    np.testing.assert_array_equal(left[: seam - 5], filled[: seam - 5])
    assert not left[seam + 5 :].any()
    middle = left[seam - 4 : seam + 4, 6, 6]
    assert (np.diff(middle) < 0).all()


def test_only_names_of_all_shapes_are_matched():
    labels = [labeled(("a", "b", None), 2, 3, 1), labeled(("c", "b"), 4, 2)]
    found = matched(labels, ["A", "B"])
    assert found.names == ("b",)
    np.testing.assert_array_equal(found.faces[0], [1, 1, 0, 0, 0, 1])
    np.testing.assert_array_equal(found.faces[1], [1, 1, 1, 1, 0, 0])
    assert [str(notice).split()[0] for notice in found.notices] == ["a", "c"]


def test_a_name_without_a_face_matches_nothing():
    unused = FaceLabels(("a", "b"), np.zeros(3, np.int64))
    assert matched([unused, FaceLabels(("b", "a"), np.ones(3, np.int64))], ["A", "B"]).names == ("a",)


def test_no_name_in_common_is_refused_with_all_names():
    with pytest.raises(InputError, match=r"A has a; B has none\).*Rename"):
        matched([labeled(("a",), 3), labeled((None,), 3)], ["A", "B"])


def shares(*cells):
    """The parts of one shape, each with the given number of full cells."""
    result = []
    for count in cells:
        part = np.zeros((10, 10, 10), np.float32)
        part.reshape(-1)[:count] = 1
        result.append(part)
    return result


def two_labels(*names):
    return matched([labeled((*names, None), *[1] * (len(names) + 1))] * 2, ["A", "B"])


@pytest.mark.parametrize(
    ("first", "second", "names", "volumes", "words"),
    [
        ((50, 60, 40), (30, 80, 90), ("a", "b", "the rest"), [[50, 30], [60, 80], [40, 90]], []),
        ((50, 60, 0), (30, 80, 0), ("a", "b"), [[50, 30], [60, 80]], []),
        ((50, 5, 40), (30, 80, 90), ("a", "the rest"), [[50, 30], [45, 170]], ["b is too small"]),
        ((50, 60, 0), (30, 80, 90), ("a", "b"), [[50, 30], [60, 170]], ["Too little is in no part"]),
        ((5, 60, 0), (30, 80, 0), ("b",), [[65, 110]], ["a is too small", "Too little"]),
        ((5, 6, 100), (30, 80, 0), ("the rest",), [[111, 110]], ["a is too small", "b is too small"]),
    ],
)
def test_small_parts_join_the_rest(first, second, names, volumes, words):
    found = joined(two_labels("a", "b"), [shares(*first), shares(*second)])
    assert found.names == names
    np.testing.assert_allclose(found.volumes, volumes)
    np.testing.assert_allclose([[part.sum() for part in row] for row in found.densities], volumes)
    assert len(found.notices) == len(words)
    assert all(str(notice).startswith(word) for notice, word in zip(found.notices, words, strict=True))


def test_whole_shapes_are_one_part():
    filled = shares(100)[0]
    (same,) = part_volumes(filled, np.zeros((0, 3, 3)), unparted(2).faces[0], 1)
    assert same is filled


def test_notices_come_with_the_frames():
    shapes = [pair(0.5, 0.5)] * 2
    frame = blended(shapes, [of_pair("x", "y"), of_pair("x", "z")], [0.5, 0.5])
    assert [str(notice) for notice in part_notices(frame.record)] == [
        "y is not on every shape and travels with the rest.",
        "z is not on every shape and travels with the rest.",
    ]
    assert frame.record["parts"] == pytest.approx({"x": 0.5, "the rest": 0.5}, abs=1e-3)


def test_a_bound_of_the_entropy_is_shared_out():
    """Without parts and with two that lie apart, the same bound leads to the same entropy of the whole."""
    shapes, labels = [pair(0.5, 0.5)] * 2, [of_pair("x", "y")] * 2
    densities = []
    original = blend_solver.merged_parts

    def spy(parts, volumes):
        densities.append(sum(part * volume for part, volume in zip(parts, volumes, strict=True)) / volumes.sum())
        return original(parts, volumes)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(blend_solver, "merged_parts", spy)
        for chosen in (None, labels):
            blended(shapes, chosen, [0.5, 0.5], MorphSettings(motion="transport", resolution=48, entropy_limit=-2.5))
    entropies = [-(d[d > 0] * np.log(d[d > 0])).mean() * (d > 0).mean() for d in densities]
    assert entropies[0] == pytest.approx(-2.5, abs=0.02)
    assert entropies[1] == pytest.approx(-2.5, abs=0.02)


@pytest.mark.parametrize("labels", [None, [of_pair("x", "y")] * 2])
def test_a_bound_below_the_entropy_of_a_cell_is_refused(labels):
    shapes = [pair(0.5, 0.5)] * 2
    least = -np.log(np.prod(Lattice.around(shapes, QUICK.resolution, QUICK.sigma).shape))
    with pytest.raises(InputError, match=f"a single cell has {least:.2f}"):
        blended(shapes, labels, [0.5, 0.5], replace(QUICK, entropy_limit=float(least) - 0.01))


def test_threads_and_parts_count_as_memory(monkeypatch):
    shapes = [ball(), box()]
    lattice = Lattice.around(shapes, 64, 1.0)
    one, two, parted = (lattice.memory(shapes, *of) for of in ((1, 1), (2, 1), (1, 3)))
    cells = np.prod(lattice.shape)
    assert 90 < (two - one) / cells < 420
    assert one < parted < two
    monkeypatch.setattr(memory, "available_memory", lambda: (one + two) // 2)
    monkeypatch.setattr("convwass_addon.applications.morphs.volumes.available_memory", lambda: (one + two) // 2)
    assert fitting_workers(lattice, shapes, 1, 8) == 1
    Lattice.around(shapes, 64, 1.0, workers=1)
    with pytest.raises(ResourceError, match="Fewer workers than 2"):
        Lattice.around(shapes, 64, 1.0, workers=2)


def test_as_many_threads_as_fit(monkeypatch):
    shapes = [ball(), box()]
    lattice = Lattice.around(shapes, 64, 1.0)
    monkeypatch.setattr(
        "convwass_addon.applications.morphs.volumes.available_memory", lambda: lattice.memory(shapes, 3, 1) + 1
    )
    assert fitting_workers(lattice, shapes, 1, 8) == 3
    assert fitting_workers(lattice, shapes, 1, 2) == 2
