# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Maps between symmetric shapes keep left and right."""

import numpy as np
import pytest

from benchmarks.blends import ASSETS, read_meshes
from convwass_addon.applications.motions.guided_motion import guided_motion
from convwass_addon.applications.motions.guided_settings import GuidedSettings
from convwass_addon.applications.registrations import map_survey
from convwass_addon.applications.registrations.carriers import carrier_of
from convwass_addon.applications.registrations.laid_meshes import Laid
from convwass_addon.applications.registrations.mirrored_sides import MirroredSides
from convwass_addon.applications.registrations.pair_proposals import DraftPair, symmetrized, total_cost
from convwass_addon.applications.registrations.pair_registration import _tightened
from convwass_addon.geometry.meshes.mesh import TriangleMesh, joined_meshes
from convwass_addon.geometry.meshes.mirror_planes import MirrorPlane
from convwass_addon.geometry.solids.orientation import orient_outward
from convwass_addon.progress import UNINTERRUPTED, drained
from tests.grids import figure
from tests.shapes import box

FIGURE, MIRROR = figure(10)
NO_PAIRS = np.empty((0, 2), np.int64)


@pytest.fixture(scope="module")
def sides():
    return MirroredSides.of(FIGURE, FIGURE)


def test_values_in_the_mirror_are_those_of_the_mirrored_vertices(sides):
    values = FIGURE.vertices[:, 1:] ** 2
    np.testing.assert_allclose(sides.mirrored(0, values), values[MIRROR], atol=0.02)
    np.testing.assert_allclose(sides.mirrored(0, values[:, 0]), values[MIRROR, 0], atol=0.02)


def test_groups_tell_the_sides_and_the_height(sides):
    groups = sides.groups(0)
    np.testing.assert_allclose(groups["left"], groups["right"][MIRROR], atol=0.02)
    assert not (groups["left"] * groups["right"]).any()
    assert groups["left"].max() == pytest.approx(1.0, abs=0.02)
    assert groups["up"][FIGURE.vertices[:, 2].argmin()] == 0.0
    assert groups["up"].argmax() == FIGURE.vertices[:, 2].argmax()


def test_vertices_without_triangles_do_not_change_the_groups(sides):
    loose = TriangleMesh(np.concatenate([FIGURE.vertices, [[9.0, 9.0, 9.0], [-9.0, 0.0, -9.0]]]), FIGURE.faces)
    for name, group in MirroredSides.of(loose, FIGURE).groups(0).items():
        np.testing.assert_allclose(group[:-2], sides.groups(0)[name], atol=1e-12)
        assert group.min() >= 0.0 and group.max() <= 1.0


def test_maps_that_commute_with_the_reflections_keep_the_sides(sides):
    same, crossed = FIGURE.vertices, FIGURE.vertices[MIRROR]
    assert sides.kept((same, crossed)) == pytest.approx(1.0)
    aside = same + np.array([0.5, 0.0, 0.0])
    assert sides.kept((same, aside)) == 0.0
    onto_one_leg = np.where((same[:, 2] < -0.4)[:, None], np.abs(same) * [1.0, 0.0, -1.0], same)
    assert 0.5 < sides.kept((onto_one_leg, same)) < 0.95


def test_what_a_registration_gets_right_on_one_side_is_taken_for_the_other():
    """One arm is registered to the other one."""
    carrier = carrier_of(FIGURE, "figure", 6000, UNINTERRUPTED)
    mesh, drafts = carrier.mesh, DraftPair((carrier, carrier), NO_PAIRS, UNINTERRUPTED)
    sides = MirroredSides.of(mesh, mesh)
    arm = (mesh.vertices[:, 0] > 0.8) & (mesh.vertices[:, 2] > 0.0)
    wrong = np.where(arm[:, None], mesh.vertices * [-1.0, 1.0, 1.0], mesh.vertices)
    found = [drafts.judged(k, points) for k, points in enumerate((wrong, mesh.vertices))]
    better = symmetrized(drafts, found, sides)
    assert total_cost(drafts, better, sides) < 0.5 * total_cost(drafts, found, sides)
    off = [np.linalg.norm(own.points - mesh.vertices, axis=1)[arm].mean() for own in (found[0], better[0])]
    assert off[0] > 2.0 and off[1] < 0.1


def test_maps_become_their_own_mirror_image(sides):
    """Of small errors, the part remains that is the same on both sides."""
    even = 0.03 * np.abs(FIGURE.vertices) * [0.0, 1.0, 1.0]
    odd = 0.05 * np.sin(FIGURE.vertices[:, :1]) * [0.0, 1.0, 1.0]
    found = sides.evened_map(0, FIGURE.vertices + even + odd, np.zeros(len(FIGURE.vertices)))
    np.testing.assert_allclose(found, FIGURE.vertices + even, atol=0.01)


def test_of_two_sides_that_differ_the_one_of_lower_cost_counts(sides):
    arm = (FIGURE.vertices[:, 0] > 0.8) & (FIGURE.vertices[:, 2] > 0.0)
    wrong = np.where(arm[:, None], FIGURE.vertices * [-1.0, 1.0, 1.0], FIGURE.vertices)
    found = sides.evened_map(0, wrong, arm.astype(float))
    np.testing.assert_allclose(found, FIGURE.vertices, atol=0.03)


def test_what_is_not_symmetric_keeps_its_map():
    """A leg that is ahead of the other one is not drawn back."""
    leg = FIGURE.vertices[:, 2] < -0.9
    ahead = leg & (FIGURE.vertices[:, 0] > 0.2)
    pose = TriangleMesh(FIGURE.vertices + ahead[:, None] * [0.0, 0.7, 0.0], FIGURE.faces)
    stepping = MirroredSides((FIGURE, pose), MirroredSides.of(FIGURE, FIGURE).planes)
    shifted = pose.vertices + leg[:, None] * [0.1, 0.0, 0.0]
    found = stepping.evened_map(0, shifted, np.zeros(len(shifted)))
    feet = (FIGURE.vertices[:, 2] < -1.3) & (np.abs(FIGURE.vertices[:, 0]) > 0.3)
    np.testing.assert_allclose(found[feet], shifted[feet], atol=0.02)


def test_mirror_images_stay_on_the_same_side_of_thin_parts():
    """Fronts and backs of two leaves that are nearer to each other than their mirror images are to them."""
    leaves = [box((0.7, 0.02, 1.0), center) for center in ((0.7, 0.0, 0.0), (-0.7, 0.015, 0.0))]
    both = joined_meshes(leaves)
    plane = MirrorPlane(np.zeros(3), np.array([1.0, 0.0, 0.0]))
    sides = MirroredSides((both, both), (plane, plane))
    is_front = np.isin(both.vertices[:, 1].round(3), (-0.01, 0.005))
    np.testing.assert_allclose(sides.mirrored(0, is_front.astype(float)), is_front, atol=1e-6)


def test_tightened_registrations_of_symmetric_shapes_are_symmetric():
    """Robust weights decide otherwise on the left than on the right."""
    carriers = tuple(carrier_of(animal(name), name, 500, UNINTERRUPTED) for name in ("cow", "dog"))
    sides, drafts = MirroredSides.of(*(own.mesh for own in carriers)), DraftPair(carriers, NO_PAIRS, UNINTERRUPTED)
    starts = [Laid(own.mesh.vertices, np.ones(len(own.mesh.vertices))) for own in carriers]
    apart = [
        [own.mesh.vertex_areas @ sides.apart(k, found[k].points) / own.mesh.area for k, own in enumerate(carriers)]
        for found in (_tightened(drafts, starts, some) for some in (None, sides))
    ]
    assert min(apart[0]) > 0.02 and max(apart[1]) < 0.01


def animal(name):
    return orient_outward(read_meshes([ASSETS / f"{name}.ply"])[0])


def test_a_dog_becomes_a_bird_symmetrically(monkeypatch):
    """Without sides, the map keeps them on a fifth of the surface."""
    monkeypatch.setattr(map_survey, "_VERTICES", (120,))
    settings = GuidedSettings(map_vertices=200, carrier_vertices=400)
    motion = drained(guided_motion([animal("dog"), animal("bird")], ["dog", "bird"], [(0, 1)], settings))
    sides = MirroredSides.of(*(carrier.mesh for carrier in motion.carriers))
    kept = sides.kept((motion.deformations[0, 1].points, motion.deformations[1, 0].points))
    assert kept > 0.8
    assert motion.pairs[0, 1].score >= kept * 0.3
