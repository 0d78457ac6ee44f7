# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes that are versions of one mesh: vertices with the same number correspond, whatever a map would tell."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from convwass_addon.applications.motions.choosing import chosen_motion
from convwass_addon.applications.motions.common_vertices import met, versions_of_mesh
from convwass_addon.applications.motions.guided_motion import guided_motion
from convwass_addon.applications.motions.guided_settings import GuidedSettings
from convwass_addon.applications.motions.posed_motion import PosedMotion
from convwass_addon.applications.one_mesh.key_paths import KeyDemands, key_paths
from convwass_addon.applications.one_mesh.mirror_symmetry import MirrorSymmetry
from convwass_addon.applications.registrations.carriers import carrier_of
from convwass_addon.applications.registrations.corresponding_vertices import (
    corresponding_pair,
    vertices_correspond,
)
from convwass_addon.geometry.meshes.edges import edge_lengths
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.meshes.mirror_planes import MirrorPlane
from convwass_addon.progress import UNINTERRUPTED, Control, drained
from tests.applications.maps import arm, coarse_maps
from tests.applications.motions.given_motions import chosen_by
from tests.applications.motions.test_known_motions import bent, line_length
from tests.grids import sheet
from tests.shapes import ball, bent_tube, box, joined, renumbered, torus

RING = torus(segments=(40, 20))
TURN = Rotation.from_rotvec([0.3, -0.5, 1.9])
ROD = arm(along=80)[0]
BENT = TriangleMesh(bent(ROD.vertices, 2.0), ROD.faces)
EGG = TriangleMesh(ball(points=300).vertices * (1.0, 2.0, 3.0), ball(points=300).faces)
PAIR = joined(box(), box(center=(3.0, 0.0, 0.0)))


def moved(mesh):
    """The mesh scaled, rotated and elsewhere."""
    return TriangleMesh(1.5 * TURN.apply(mesh.vertices * (1.0, 1.2, 0.9)) + 4.0, mesh.faces)


def with_other_diagonals(mesh, share):
    """A torus with a share of its quads divided along the other diagonal."""
    half = len(mesh.faces) // 2
    a, b, c, d = mesh.faces[:half, 0], mesh.faces[:half, 1], mesh.faces[:half, 2], mesh.faces[half:, 2]
    other = np.concatenate([np.stack([a, b, d], axis=1), np.stack([b, c, d], axis=1)])
    quads = np.tile(np.arange(half) < share * half, 2)[:, None]
    return TriangleMesh(mesh.vertices, np.where(quads, other, mesh.faces))


def doubled(mesh):
    """The mesh with every triangle twice."""
    return TriangleMesh(mesh.vertices, np.concatenate([mesh.faces, mesh.faces]))


@pytest.mark.parametrize(
    ("one", "other", "expected"),
    [
        (RING, moved(RING), True),
        (RING, TriangleMesh(RING.vertices, np.roll(RING.faces[::-1], 1, axis=1)), True),
        (RING, with_other_diagonals(moved(RING), 0.2), True),
        (RING, with_other_diagonals(RING, 1.0), False),
        (RING, renumbered(RING), False),
        (RING, RING.flipped(), False),
        (RING, torus(segments=(20, 40)), False),
        (RING, TriangleMesh(RING.vertices, RING.faces[:-1]), False),
        (doubled(RING), doubled(renumbered(RING)), False),
        (doubled(RING), doubled(with_other_diagonals(RING, 0.1)), True),
        (PAIR, joined(box((1.0, 1.0, 2.0)), box(center=(3.0, 1.0, 0.0))), True),
        (PAIR, joined(box(center=(3.0, 1.0, 0.0)), box()), False),
        (RING, TriangleMesh(0.0 * RING.vertices, RING.faces), False),
        (joined(ball(points=300), box((0.2, 0.2, 0.2), (1.2, 0.0, 0.0)), box((0.2, 0.2, 0.2), (-1.2, 0.0, 0.0))),) * 2
        + (True,),
    ],
    ids=[
        "moved",
        "order of triangles",
        "some diagonals",
        "all diagonals",
        "order of vertices",
        "mirrored",
        "another torus",
        "fewer triangles",
        "doubled triangles",
        "doubled triangles, some diagonals",
        "boxes",
        "boxes in another order",
        "no area",
        "eyes",
    ],
)
def test_vertices_of_versions_of_one_mesh_correspond(one, other, expected):
    assert vertices_correspond(one, other) is expected
    assert vertices_correspond(other, one) is expected


def test_a_head_may_turn_around():
    """Its eyes change places with respect to everything else."""
    head = joined(ball(points=300), ball(0.2, (1.1, 0.4, 0.0), 40), ball(0.2, (1.1, -0.4, 0.0), 40))
    assert vertices_correspond(head, TriangleMesh(head.vertices * (-1.0, -1.0, 1.0), head.faces))


def robot(arm):
    """Boxes that are not symmetric from front to back; both arms are alike."""
    sides = [box((0.3, 0.3, 1.2), (side, arm, 0.4)) for side in (-0.8, 0.8)]
    head = [box((0.5, 0.5, 0.5), (0.0, -0.2, 1.1)), box((0.2, 0.3, 0.2), (0.0, -0.5, 1.1))]
    return joined(box((1.0, 0.5, 1.5)), *head, *sides)


@pytest.mark.parametrize("degrees", [0.0, 90.0, 120.0, 180.0])
def test_shapes_of_many_parts_may_turn(degrees):
    turn = Rotation.from_euler("z", degrees, degrees=True)
    other = robot(-0.3)
    assert vertices_correspond(robot(0.0), TriangleMesh(turn.apply(other.vertices) + 2.0, other.faces))


def table(order):
    """A table with thin legs, joined in some order."""
    places = np.array([(-0.8, -0.4, -0.5), (-0.8, 0.4, -0.5), (0.8, -0.4, -0.5), (0.8, 0.4, -0.5)])
    return joined(box((2.0, 1.0, 0.1)), *(box((0.04, 0.04, 0.9), places[leg]) for leg in order))


@pytest.mark.parametrize("order", [(1, 0, 2, 3), (2, 1, 0, 3), (3, 2, 1, 0)])
def test_thin_legs_keep_their_order(order):
    assert vertices_correspond(table(range(4)), table(range(4)))
    assert not vertices_correspond(table(range(4)), table(order))


def hand(degrees, order=range(12)):
    """A palm and four fingers of three equal boxes, bent at every joint; the boxes are joined in some order."""
    bones = []
    for side in (-0.9, -0.3, 0.3, 0.9):
        joint, turn = np.array([0.0, side, 1.0]), Rotation.identity()
        for _ in range(3):
            turn = turn * Rotation.from_euler("y", degrees, degrees=True)
            bone = box((0.4, 0.4, 0.9), (0.0, 0.0, 0.35))
            bones.append(TriangleMesh(turn.apply(bone.vertices) + joint, bone.faces))
            joint = joint + turn.apply([0.0, 0.0, 0.7])
    return joined(box((0.6, 2.4, 2.0)), *(bones[bone] for bone in order))


def test_parts_of_limbs_that_come_near_each_other_keep_their_order():
    """A fingertip of a fist is near where the middle of another finger was."""
    straight, bent_ = hand(0.0), hand(60.0)
    mixed = np.random.default_rng(0).permutation(12)
    for one, other in ((straight, bent_), (bent_, straight)):
        assert vertices_correspond(one, other)
    assert not vertices_correspond(straight, hand(60.0, mixed))
    assert not vertices_correspond(hand(60.0, mixed), straight)


@pytest.mark.parametrize("seed", range(20))
def test_either_order_of_the_shapes_gives_the_same_answer(seed):
    """Boxes of different sizes have as many triangles."""
    places = np.random.default_rng(seed).normal(size=(2, 3, 3))
    one, other = (
        joined(*(box((size,) * 3, tuple(place)) for size, place in zip((1.0, 0.6, 0.3), own, strict=True)))
        for own in places
    )
    assert vertices_correspond(one, other) is vertices_correspond(other, one)


def test_a_cable_from_the_other_end_does_not_turn():
    """Both ends look the same, so that nobody would see a turn but on the way."""
    cable = bent_tube(1.0, radius=0.1)
    rings, sides = 60, 12
    order = np.concatenate(
        [np.arange(rings * sides).reshape(rings, sides)[::-1, ::-1].ravel(), [rings * sides + 1, rings * sides]]
    )
    reversed_ = cable.vertices[order]
    assert (np.sort(reversed_, axis=0) == np.sort(cable.vertices, axis=0)).all()
    other = TriangleMesh(reversed_ + np.array([0.0, 0.5, 0.0]), cable.faces)
    assert other.volume == pytest.approx(cable.volume)
    assert not vertices_correspond(cable, other)
    assert vertices_correspond(cable, cable.moved((0.0, 0.5, 0.0)))


@pytest.mark.parametrize("count", [40, 600])
def test_components_of_one_kind_keep_their_order(count):
    """Hair that moves a little corresponds, and hair in another order does not."""
    rng = np.random.default_rng(3)
    strands = [rng.normal(size=3) + 0.1 * rng.normal(size=(3, 3)) for _ in range(count)]
    faces = np.arange(3 * count).reshape(-1, 3)
    hair = TriangleMesh(np.concatenate(strands), faces)
    assert vertices_correspond(hair, hair.moved((1.0, 2.0, 3.0)))
    assert not vertices_correspond(hair, TriangleMesh(np.concatenate(strands[::-1]), faces))


def test_vertices_that_no_triangle_uses_have_a_place():
    long = box((1.0, 1.0, 4.0))
    loose = TriangleMesh(np.concatenate([long.vertices, [[9.0, 9.0, 9.0]]]), long.faces)
    carrier = carrier_of(loose, "a box", 6000, Control())
    assert carrier.parents is not None
    found = carrier.embedding(loose).interpolated(loose.corners)
    np.testing.assert_allclose(np.delete(found, 8, axis=0), np.delete(carrier.rest.vertices, 8, axis=0), atol=1e-12)
    assert (np.abs(found[8] - long.vertices).max(axis=1) < 1e-12).any()


def test_points_that_divide_triangles_without_area_stay_on_them():
    """Both long edges of a needle in the side of a box are divided, and so is what is between them."""
    long = box((1.0, 1.0, 4.0))
    lengths = edge_lengths(long.vertices, long.faces[:, [0, 1]])
    face = int(lengths.argmax())
    one, other, across = long.faces[face]
    # A second vertex where another one is, and the needle between both.
    split = TriangleMesh(
        np.concatenate([long.vertices, long.vertices[other : other + 1]]),
        np.concatenate([np.delete(long.faces, face, axis=0), [[one, 8, across], [one, other, 8]]]),
    )
    carrier = carrier_of(split, "a box", 6000, Control())
    found = carrier.embedding(split)
    has_area = split.face_areas > 0.0
    assert not has_area[-1]
    np.testing.assert_allclose(found.interpolated(split.corners), carrier.rest.vertices, atol=1e-12)
    # The needle may open in another pose, so points that also lie on other triangles belong to these.
    beside = np.unique(carrier.rest.faces[has_area[carrier.parents]])
    assert has_area[found.triangles[beside[beside >= 9]]].all()
    assert not has_area[found.triangles[9:]].all()


@pytest.mark.parametrize(("mesh", "count"), [(box((1.0, 1.0, 4.0)), 6000), (RING, 6000), (ball(points=3000), 500)])
def test_every_point_moves_to_the_same_place(mesh, count):
    """Between an affine image and the mesh, on divided, equal and coarser meshes."""
    shapes = mesh, moved(mesh)
    one, other = (carrier_of(shape, "a shape", count, Control()) for shape in shapes)
    pair = corresponding_pair(shapes, (one, other))
    np.testing.assert_allclose(pair.laid.first.points, moved(one.mesh).vertices, atol=1e-9)
    np.testing.assert_allclose(
        moved(TriangleMesh(pair.laid.second.points, other.mesh.faces)).vertices, other.mesh.vertices
    )
    assert (pair.score, pair.by_vertices) == (1.0, True)


@pytest.fixture(scope="module")
def bending():
    return drained(guided_motion((ROD, BENT), ("straight", "bent"), [(0, 1)]))


def test_a_rod_bends_and_keeps_its_length(bending):
    assert bending.pairs[0, 1].by_vertices
    for time in (0.25, 0.5, 0.8):
        points = bending.moved([1.0 - time, time])[0].vertices[: len(ROD.vertices)]
        assert line_length(ROD.vertices, points) == pytest.approx(line_length(ROD.vertices, ROD.vertices), rel=0.01)


@pytest.mark.parametrize("time", [0.1, 0.6])
def test_both_shapes_meet(bending, time):
    one, other = (shape.vertices for shape in bending.moved([1.0 - time, time]))
    count = len(ROD.vertices)
    np.testing.assert_allclose(one[:count], other[:count], atol=1e-12)


def test_dividing_points_move_with_their_triangles():
    """Shapes moved by affine maps meet in the affine map that is their mean."""
    long = box((1.0, 1.0, 4.0))
    carriers = [carrier_of(shape, "a box", 6000, Control()) for shape in (long, moved(long))]
    begins, ends = (carrier.rest for carrier in carriers)
    assert min(len(begins.vertices), len(ends.vertices)) > 1000
    weights, way = np.array([0.3, 0.7]), 0.5
    versions = [replace(own, length=0.0) for own in versions_of_mesh(carriers, (long, moved(long)))]
    own = 2.0 * begins.vertices + 1.0
    found = met(versions, {0: own, 1: ends.vertices}, weights, way)
    mean = 0.3 * own + 0.7 * moved(begins).vertices
    np.testing.assert_allclose(found[0], 0.5 * (own + mean), atol=1e-9)


def test_stiff_shapes_keep_their_proportions():
    """With full coherence, each only rotates its parts, and they do not meet."""
    longer = TriangleMesh(BENT.vertices * (1.0, 1.0, 1.5), BENT.faces)
    motion = drained(guided_motion((ROD, longer), ("rod", "longer"), [(0, 1)]))
    apart, count = {}, len(ROD.vertices)
    for coherence in (0.3, 0.5, 0.75, 1.0):
        one, other = (shape.vertices for shape in motion.with_coherence(coherence).moved([0.5, 0.5]))
        apart[coherence] = np.abs(one[:count] - other[:count]).max()
    assert apart[0.5] < 1e-12 < apart[0.75] < apart[1.0]
    assert apart[0.3] > 1e-3


choice = partial(chosen_by, chosen_motion)


@pytest.mark.parametrize(
    ("pair", "kind", "reason"),
    [
        ((ROD, BENT), "automatic", "VERTICES"),
        ((ROD, BENT), "guided", "ASKED"),
        ((EGG, TriangleMesh(EGG.vertices * (1.2, 0.9, 0.3), EGG.faces)), "automatic", "VERTICES"),
    ],
    ids=["rods", "asked for", "without limbs"],
)
def test_they_are_guided_without_a_map(pair, kind, reason, monkeypatch):
    monkeypatch.setattr("convwass_addon.applications.motions.guided_motion.mapped_pair", None)
    found = choice(kind, shapes=pair)
    assert (found.kind, found.reason, found.score) == ("guided", reason, 1.0)


def test_with_guides_they_are_mapped():
    with coarse_maps():
        found = choice(shapes=(ROD, BENT), guides=[{0: 0, 1: 0}])
    assert found.reason != "VERTICES"
    assert not found.motion.pairs[0, 1].by_vertices


def test_bodies_in_another_order_move_to_the_nearest_ones():
    bodies = [ROD, ROD.moved((0.0, 8.0, 0.0))], [BENT.moved((0.0, 8.0, 0.0)), BENT]
    found = choice(shapes=tuple(joined(*own) for own in bodies))
    assert found.record() == {"kind": "guided", "reason": "FITS", "score": 1.0, "bodies": 2}


def keys(one, other, symmetry=None):
    """The path of shape keys from one shape to another."""
    work = key_paths((one, other), ("one", "other"), KeyDemands(0.01, symmetry), GuidedSettings(), (), UNINTERRUPTED)
    return drained(work)[0]


def test_shape_keys_end_at_the_vertices_of_the_other_shape():
    path = keys(ROD, BENT)
    np.testing.assert_allclose(path.positions[-1], BENT.vertices, atol=1e-9)
    assert (path.turned, len(path.poor), path.distance) == (0, 0, pytest.approx(0.0, abs=1e-9))


def test_so_do_symmetric_ones():
    """A rod that is symmetric about z = 0, as its bend is."""
    symmetry = MirrorSymmetry.of(ROD.vertices, MirrorPlane(np.zeros(3), np.array([0.0, 0.0, 1.0])), "rod")
    np.testing.assert_allclose(keys(ROD, BENT, symmetry).positions[-1], BENT.vertices, atol=1e-9)


def with_loose_vertex(mesh, place):
    return TriangleMesh(np.append(mesh.vertices, [place], axis=0), mesh.faces)


@pytest.mark.parametrize("end", [(5.0, 5.0, 5.0), (5.0, 5.0, 7.0)])
def test_loose_vertices_move_straight(end):
    start = np.array([5.0, 5.0, 5.0])
    path = keys(with_loose_vertex(ROD, start), with_loose_vertex(BENT, end))
    expected = [(1.0 - time) * start + time * np.array(end) for time in path.times]
    # Changes that keep the volume move everything a little.
    np.testing.assert_allclose(path.positions[:, -1], expected, atol=0.03)


def test_loose_vertices_of_mapped_shapes_stay():
    start = np.array([5.0, 5.0, 5.0])
    path = keys(with_loose_vertex(ROD, start), renumbered(with_loose_vertex(BENT, (5.0, 5.0, 7.0))))
    np.testing.assert_allclose(path.positions[:, -1], np.tile(start, (len(path.times), 1)), atol=0.03)


def test_other_poses_of_both_meet(bending):
    """While both change their poses, as animated inputs do."""
    shapes = ROD, BENT
    posed = PosedMotion.of(bending, shapes, ("straight", "bent"), [(0, 1)], 0.5, UNINTERRUPTED)
    turned = [TriangleMesh(TURN.apply(shape.vertices) + 1.0, shape.faces) for shape in shapes]
    one, other = (shape.vertices for shape in posed.at(turned, [0, 1], UNINTERRUPTED).moved([0.4, 0.6]))
    count = len(ROD.vertices)
    np.testing.assert_allclose(one[:count], other[:count], atol=1e-12)
    expected = bending.moved([0.4, 0.6])[0].vertices[:count]
    np.testing.assert_allclose(one[:count], TURN.apply(expected) + 1.0, atol=1e-3)


def test_poses_of_another_volume_are_reached(bending):
    posed = PosedMotion.of(bending, (ROD, BENT), ("straight", "bent"), [(0, 1)], 0.5, UNINTERRUPTED)
    thin = [TriangleMesh(shape.vertices * (1.0, 1.0, 0.8), shape.faces) for shape in (ROD, BENT)]
    near = posed.at(thin, [0, 1], UNINTERRUPTED).moved([1.0 - 1e-6, 1e-6])[0]
    np.testing.assert_allclose(near.vertices[: len(ROD.vertices)], thin[0].vertices, atol=1e-4)


def twisted(mesh, angle):
    """The mesh twisted about z by an angle per unit of height, which preserves volumes."""
    turns = Rotation.from_rotvec(angle * mesh.vertices[:, 2:] * (0.0, 0.0, 1.0))
    return TriangleMesh(turns.apply(mesh.vertices), mesh.faces)


def test_a_twist_keeps_its_volume():
    """The mean of the stretches alone would have 4 % more halfway."""
    flat = TriangleMesh(ball(points=2000).vertices * (1.0, 0.3, 1.0), ball(points=2000).faces)
    larger = TriangleMesh(1.2 * twisted(flat, 1.3).vertices, flat.faces)
    motion = drained(guided_motion((flat, larger), ("flat", "twisted"), [(0, 1)]))
    free = replace(motion, versions=tuple(replace(own, length=0.0) for own in motion.versions))
    for time in (0.01, 0.5, 0.9):
        expected = ((1.0 - time) * np.cbrt(flat.volume) + time * np.cbrt(larger.volume)) ** 3
        for shape in motion.moved([1.0 - time, time]):
            assert shape.mesh.volume == pytest.approx(expected, rel=2e-3)
    assert free.moved([0.5, 0.5])[0].mesh.volume > 1.03 * motion.moved([0.5, 0.5])[0].mesh.volume


def test_sheets_have_no_volume_to_keep():
    """The volume between a bent sheet and its center is none that it encloses."""
    flat = sheet(30, 30, (2.0, 2.0))
    x, y, _ = (flat.vertices - (1.0, 1.0, 0.0)).T
    domes = [TriangleMesh(np.stack([x, y, height * (x**2 + y**2)], axis=1), flat.faces) for height in (-0.3, -0.6)]
    motion = drained(guided_motion(domes, ("low", "high"), [(0, 1)]))
    assert [own.length for own in motion.versions] == [0.0, 0.0]


def test_only_shapes_that_are_blended_need_the_same_vertices():
    """Two pairs of versions of different meshes, and a path of three versions of one."""
    ring, other = torus(segments=(30, 12)), moved(torus(segments=(30, 12)))
    two = drained(guided_motion((ROD, BENT, ring, other), "abcd", [(0, 1), (2, 3)]))
    for weights in ([0.5, 0.5, 0.0, 0.0], [0.0, 0.0, 0.5, 0.5]):
        one, another = (shape.vertices for shape in two.moved(weights) if shape is not None)
        count = len(ROD.vertices if weights[0] else ring.vertices)
        np.testing.assert_allclose(one[:count], another[:count], atol=1e-12)
    assert len(drained(guided_motion((ROD, BENT, ring), "abc", [(0, 1)])).versions) == 3
