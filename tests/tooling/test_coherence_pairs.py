# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The shapes of the coherence benchmark are closed, and two poses of a body share its proportions but no triangles."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks import bipeds, creatures, hands, props, quadrupeds
from benchmarks.coherence_pairs import HELD_BACK, ONE_BUILD, OTHER_BUILD, PROPS, SKINNED, TUNED, further_pairs
from benchmarks.rival_measures import Connectivity
from benchmarks.skinning import skinned
from convwass_addon.applications.registrations.corresponding_vertices import vertices_correspond
from convwass_addon.geometry.meshes.edges import topology
from tests.shapes import box


def test_both_halves_have_pairs_of_both_kinds_without_overlap():
    for half in (TUNED, HELD_BACK):
        assert len(half) >= 12
        assert {pair.build for pair in half} == {ONE_BUILD, OTHER_BUILD}
    names = [pair.name for pair in (*TUNED, *HELD_BACK)]
    assert len(set(names)) == len(names)


def test_two_poses_of_a_body_are_closed_and_meshed_separately():
    ends = TUNED[0].ends()
    for mesh in (ends.first, ends.second):
        connectivity = Connectivity.of(mesh)
        assert topology(mesh).closed
        assert (len(connectivity.shares), connectivity.handles) == (1, 0)
        assert mesh.volume > 0
        assert 5000 <= len(mesh.faces) <= 15000
    assert ends.first.volume == pytest.approx(ends.second.volume, rel=0.02)
    common = {tuple(point) for point in ends.first.vertices.round(6)} & {
        tuple(point) for point in ends.second.vertices.round(6)
    }
    assert not common


def test_limbs_keep_their_lengths_in_every_pose():
    def lengths(joints):
        return np.linalg.norm(np.diff(joints, axis=0), axis=1)

    one = bipeds.biped(bipeds.MAN, bipeds.Posture(), 0)
    arms = (bipeds.straight(bipeds.degrees(out=140)), bipeds.straight(bipeds.degrees(forward=70)))
    other = bipeds.biped(bipeds.MAN, bipeds.Posture(arms=arms), 0)
    animals = [quadrupeds.quadruped(quadrupeds.DOG, pose, 0) for pose in (quadrupeds.STANDING, quadrupeds.REARING)]
    fingers = [hands.hand(hands.HAND, gesture, 0).fingers for gesture in (hands.SPREAD, hands.BENT)]
    tentacles = [creatures.octopus_arm(0.4, *pose) for pose in ((creatures.RAISED, 40.0), (creatures.CRAWLING, -30.0))]
    pairs = [
        (one.arms[0], other.arms[0]),
        (one.arms[1], other.arms[1]),
        (animals[0].fore[0], animals[1].fore[0]),
        (animals[0].neck, animals[1].neck),
        *zip(*fingers, strict=True),
        tuple(tentacles),
    ]
    for first, second in pairs:
        np.testing.assert_allclose(lengths(first), lengths(second), rtol=1e-9)


def test_the_arm_swings_by_120_degrees_and_keeps_its_length_on_the_way():
    limb = TUNED[0].ends().limb
    first, middle, last = (limb.at(t)[-1] - limb.at(t)[0] for t in (0.0, 0.5, 1.0))
    for vector in (middle, last):
        assert np.linalg.norm(vector) == pytest.approx(np.linalg.norm(first))
    cosine = first @ last / (first @ first)
    assert np.degrees(np.arccos(cosine)) == pytest.approx(120.0)


def test_pairs_of_a_folder_are_added_if_both_files_exist(tmp_path):
    assert further_pairs(tmp_path, tuned=True) == ()
    for name in ("spot_triangulated.obj", "bob_tri.obj"):
        (tmp_path / name).touch()
    assert [pair.name for pair in further_pairs(tmp_path, tuned=True)] == ["spot to bob"]
    assert further_pairs(tmp_path, tuned=False) == ()


def test_props_have_known_volumes():
    assert props.ring().volume == pytest.approx(0.64 * np.pi * 0.5, rel=0.002)
    corners = np.array([(0.0, 1.0, 2.0), (2.0, 2.0, 5.0)])
    assert props.box(*corners).bounds == pytest.approx(corners)
    for ends in [((0.0, 0.0, 0.0), tip) for tip in np.diag([2.0, 2.0, -2.0])]:
        cylinder = props.cylinder(0.5, ends)
        assert cylinder.volume == pytest.approx(0.5 * np.pi, rel=0.01)
        extents = np.where(np.abs(ends[1]) > 0, 2.0, 1.0)
        assert np.ptp(cylinder.bounds, axis=0) == pytest.approx(extents)
    cone = props.revolved([(0.0, 0.0), (1.0, 0.0), (0.0, 2.0)])
    assert cone.volume == pytest.approx(2.0 / 3.0 * np.pi, rel=0.002)


@pytest.mark.parametrize("pair", PROPS, ids=lambda pair: pair.name)
def test_props_are_closed(pair):
    ends = pair.ends()
    for mesh in (ends.first, ends.second):
        assert topology(mesh).closed
        assert mesh.volume > 0


@pytest.mark.parametrize("pair", SKINNED, ids=lambda pair: pair.name)
def test_vertices_of_one_mesh_correspond(pair):
    ends = pair.ends()
    assert np.array_equal(ends.first.faces, ends.second.faces)
    assert vertices_correspond(ends.first, ends.second)


def test_bones_carry_the_skin():
    """The ends of a rod turn with their bones."""
    rod = box((4.0, 0.4, 0.4))
    straight, bent = (np.array([(-2.0, 0.0, 0.0), (0.0, 0.0, 0.0), end]) for end in ((2.0, 0.0, 0.0), (0.0, 0.0, 2.0)))
    moved = skinned(rod, [straight], [bent], 0.1)
    left, right = rod.vertices[:, 0] < 0, rod.vertices[:, 0] > 0
    np.testing.assert_allclose(moved.vertices[left], rod.vertices[left], atol=1e-9)
    x, y, z = rod.vertices[right].T
    np.testing.assert_allclose(moved.vertices[right], np.stack([-z, y, x], axis=1), atol=1e-9)
