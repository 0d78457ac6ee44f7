# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Maps between symmetric shapes keep left and right."""

import numpy as np
import pytest

from benchmarks.blends import ASSETS, read_meshes
from convwass_addon.applications.motions import map_survey
from convwass_addon.applications.motions.carriers import carrier_of
from convwass_addon.applications.motions.guided_motion import guided_motion
from convwass_addon.applications.motions.guided_settings import GuidedSettings
from convwass_addon.applications.motions.mirrored_sides import MirroredSides
from convwass_addon.applications.motions.pair_proposals import DraftPair, symmetrized, total_cost
from convwass_addon.geometry.mesh import TriangleMesh
from convwass_addon.geometry.orientation import orient_outward
from convwass_addon.progress import UNINTERRUPTED, drained
from tests.grids import figure

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
