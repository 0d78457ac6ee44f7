# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Motions between shapes without known correspondence, from the map to the moved shapes."""

from __future__ import annotations

from dataclasses import replace
from itertools import groupby, pairwise

import numpy as np
import pytest

from convwass_addon.applications.motions.guided_motion import guided_motion
from convwass_addon.applications.motions.guided_settings import GuidedSettings
from convwass_addon.applications.one_mesh.key_paths import KeyDemands, paths_along
from convwass_addon.applications.one_mesh.mirror_symmetry import MirrorSymmetry
from convwass_addon.applications.registrations.map_quality import map_quality
from convwass_addon.errors import Cancelled, InputError
from convwass_addon.geometry.meshes.closest_points import ClosestPointFinder
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.meshes.mirror_planes import MirrorPlane
from convwass_addon.progress import UNINTERRUPTED, Control, drained
from tests.applications.maps import arm
from tests.grids import figure
from tests.shapes import ball, box, joined, shuffled, square

QUICK = GuidedSettings(map_vertices=200, carrier_vertices=500)
ROUGH = GuidedSettings(map_vertices=150, carrier_vertices=300)
TINY = GuidedSettings(map_vertices=100, carrier_vertices=150)


def motion_of(*shapes, settings=QUICK, pairs=((0, 1),), guides=(), control=UNINTERRUPTED):
    names = [f"shape {k}" for k in range(len(shapes))]
    return drained(guided_motion(shapes, names, pairs, settings, guides, control))


def noted(work, reports):
    """Complete some work, and collect its reports."""
    while True:
        try:
            reports.append(next(work))
        except StopIteration as end:
            return end.value


def apart(one, other):
    """Largest distance from the vertices of one mesh to the other, in sizes of it."""
    return ClosestPointFinder(other.corners).find(one.vertices).distances.max() / other.root_area


SWUNG, PLACES = shuffled(arm(np.radians(120.0), around=20, along=52)[0])


@pytest.fixture(scope="module")
def arms():
    """A straight arm, and a bent one of so many vertices that a coarser mesh deforms it."""
    return arm(0.0)[0], SWUNG


@pytest.fixture(scope="module")
def ends(arms):
    """Both ends of the arms, which look the same from either of them: rounding alone would choose the direction."""
    places = arm(np.radians(120.0))[0].vertices[640:]
    there = [int(np.linalg.norm(arms[1].vertices - place, axis=1).argmin()) for place in places]
    return [{0: 640, 1: there[0]}, {0: 641, 1: there[1]}]


@pytest.fixture(scope="module")
def swing(arms, ends):
    return motion_of(*arms, guides=ends)


def test_an_arm_that_swings_keeps_its_length(arms, swing):
    for share in (0.25, 0.5, 0.75):
        one, other = swing.moved([1.0 - share, share])
        line = one.vertices[:640].reshape(40, 16, 3).mean(axis=1)
        assert np.linalg.norm(np.diff(line, axis=0), axis=1).sum() == pytest.approx(4.0, rel=0.03)
        assert apart(one.mesh, other.mesh) < 0.02
        assert one.mesh.volume == pytest.approx(arms[0].volume, rel=0.03)


def test_one_mesh_swings_its_arm_with_few_keys(arms, swing):
    """The whole rod is the limb here, so a percent of the size is as fine as half a percent is of a body.

    Its volume takes one or two of eight keys: what turns by 2 a along a straight piece shrinks by the square of cos a.
    """
    (path,) = drained(paths_along(swing, arms, ["one", "other"], KeyDemands(0.01), UNINTERRUPTED))
    assert len(path.times) <= 8
    played = [TriangleMesh(points, arms[0].faces) for points in (arms[0].vertices, *path.positions)]
    for times, meshes in zip(pairwise((0.0, *path.times)), pairwise(played), strict=True):
        middle = TriangleMesh(np.mean([own.vertices for own in meshes], axis=0), arms[0].faces)
        even = np.interp(np.mean(times), (0.0, 1.0), (played[0].volume, played[-1].volume))
        assert middle.volume == pytest.approx(even, rel=0.0101)
    assert path.times[-1] == 1.0
    assert path.deviation <= 0.01
    assert path.distance < 0.001
    assert path.distance_95 < 0.004
    assert path.turned == 0
    assert path.missed == 0.0
    end = TriangleMesh(path.positions[-1], arms[0].faces)
    # The second arm has more and other vertices. Rings end within a quarter of its thickness of where they belong.
    known = arm(np.radians(120.0))[0].vertices
    rings = [points[:640].reshape(40, 16, 3).mean(axis=1) for points in (end.vertices, known)]
    assert np.linalg.norm(rings[0] - rings[1], axis=1).max() < 0.15
    assert end.volume == pytest.approx(arms[1].volume, rel=0.03)


def test_a_symmetric_mesh_swings_symmetrically(arms, swing):
    symmetry = MirrorSymmetry.of(arms[0].vertices, MirrorPlane(np.zeros(3), np.array([0.0, 0.0, 1.0])), "one")
    demands = KeyDemands(0.02, symmetry)
    (path,) = drained(paths_along(swing, arms, ["one", "other"], demands, UNINTERRUPTED))
    for points in path.positions:
        mirrored = symmetry.plane(points).mirrored(points)
        np.testing.assert_allclose(mirrored, points[symmetry.partners], atol=1e-9)
    assert path.distance < 0.002


def stages_of_keys(arms, swing, control):
    """The work from a motion to symmetric keys."""
    symmetry = MirrorSymmetry.of(arms[0].vertices, MirrorPlane(np.zeros(3), np.array([0.0, 0.0, 1.0])), "one")
    return paths_along(swing, arms, ["one", "other"], KeyDemands(0.02, symmetry), control)


def test_all_stages_from_a_motion_to_keys_report_their_progress(arms, swing):
    reports = []
    noted(stages_of_keys(arms, swing, UNINTERRUPTED), reports)
    fractions = np.array([0.0, *(report.fraction for report in reports), 1.0])
    steps = np.diff(fractions)
    assert (steps >= 0.0).all() and steps.max() < 0.2
    # The beginning of a stage may coincide with the end of the previous one.
    assert all(len(list(same)) <= 4 for _, same in groupby(fractions))


def test_the_work_from_a_motion_to_keys_can_be_cancelled_in_every_stage(arms, swing):
    count = sum(1 for _ in stages_of_keys(arms, swing, UNINTERRUPTED))
    for place in [*range(0, count, 12), count - 1]:
        control = Control()
        work = stages_of_keys(arms, swing, control)
        for _ in range(place + 1):
            next(work)
        control.cancel()
        with pytest.raises(Cancelled):
            drained(work)


@pytest.mark.parametrize(("own", "other"), [(0, 1), (1, 0)])
def test_the_deformed_shapes_match(swing, own, other):
    source, target = swing.carriers[own], swing.carriers[other]
    there, back = swing.deformations[own, other], swing.deformations[other, own]
    quality = map_quality(source, target, there)
    assert quality.confidence > 0.9
    assert quality.torn < 0.01
    assert there.images.distances.mean() < 0.01 * target.mesh.root_area
    home = there.images.interpolated(back.points[target.mesh.faces])
    assert np.quantile(np.linalg.norm(home - source.mesh.vertices, axis=1), 0.95) < 0.1 * source.mesh.root_area


def test_swapped_inputs_give_the_same_shapes(arms, ends, swing):
    reports = []
    guides = [{1 - shape: vertex for shape, vertex in guide.items()} for guide in ends]
    back = noted(guided_motion(arms[::-1], ["other", "one"], [(0, 1)], QUICK, guides), reports)
    fractions = [report.fraction for report in reports]
    assert fractions == sorted(fractions)
    assert (fractions[0], fractions[-1]) == (0.0, 1.0)
    assert len(reports) > 5
    there, again = swing.moved([0.7, 0.3]), back.moved([0.3, 0.7])
    # Rounding differs. The rods are 4 long.
    np.testing.assert_allclose(again[1].vertices, there[0].vertices, atol=1e-4)
    np.testing.assert_allclose(again[0].vertices, there[1].vertices, atol=1e-4)


def test_dense_meshes_are_deformed_by_coarser_ones(swing):
    assert len(swing.carriers[1].mesh.vertices) < 0.5 * len(SWUNG.vertices)
    one, other = swing.moved([0.5, 0.5])
    assert other.rest is SWUNG
    line = other.vertices[PLACES[: 20 * 52]].reshape(52, 20, 3).mean(axis=1)
    assert np.linalg.norm(np.diff(line, axis=0), axis=1).sum() == pytest.approx(4.0, rel=0.03)
    assert apart(other.mesh, one.mesh) < 0.02
    # As smooth as before: no triangle is flipped or much larger.
    before, after = (
        np.linalg.norm(mesh.corners - np.roll(mesh.corners, 1, axis=1), axis=2) for mesh in (SWUNG, other.mesh)
    )
    assert (after < 1.6 * before).all()


def odd_arm():
    """An open arm, inside out, with a third triangle on an edge, and with two crumbs."""
    mesh = arm(0.0)[0]
    faces = mesh.faces[mesh.corners.mean(axis=1)[:, 0] > 0.2]
    vertices = np.concatenate([mesh.vertices, [mesh.vertices[faces[0, 0]] + (0.0, 0.3, 0.0)]])
    fin = TriangleMesh(vertices, np.concatenate([faces, [[*faces[0, :2], len(mesh.vertices)]]]))
    crumbs = ball(0.03, (1.0, 0.4, 0.0), points=12), box((0.02, 0.02, 0.02), (1.0, -0.4, 0.0))
    return joined(fin, *crumbs).flipped()


def test_odd_meshes_move_too():
    motion = motion_of(odd_arm(), arm(0.5)[0], settings=TINY)
    one, other = motion.moved([0.5, 0.5])
    assert np.isfinite(one.vertices).all()
    near = ClosestPointFinder(one.mesh.corners).find(other.vertices).distances
    assert np.quantile(near, 0.9) < 0.02 * other.mesh.root_area


def test_shapes_that_cannot_be_used_are_named():
    with pytest.raises(InputError, match="shape 1 has no faces"):
        motion_of(box(), TriangleMesh(np.zeros((3, 3)), np.array([[0, 1, 2]])))
    with pytest.raises(InputError, match="shape 0 has no faces"):
        motion_of(TriangleMesh(np.zeros((0, 3)), np.zeros((0, 3), np.int64)), box())


def test_unlike_shapes_still_give_numbers():
    motion = motion_of(square(), ball(points=100), settings=TINY)
    moved = motion.moved([0.5, 0.5])
    for shape in moved:
        assert np.isfinite(shape.vertices).all()
    # Two triangles cannot bend: they are cut.
    assert set(moved[0].parents) == {0, 1}
    assert len(moved[0].rest.faces) == len(moved[0].parents)


@pytest.mark.parametrize("checks", [1, 8, 40])
def test_it_can_be_stopped(arms, checks):
    class Stopping(Control):
        """Cancels itself after some checks."""

        left = checks

        def check(self):
            self.left -= 1
            if self.left < 0:
                self.cancel()
            super().check()

    with pytest.raises(Cancelled):
        motion_of(*arms, control=Stopping())


@pytest.mark.parametrize(
    ("guide", "message"),
    [
        ({0: 5}, "at least two shapes"),
        ({0: 5, 7: 5}, "shape 7"),
        ({0: 5, 1: 100_000}, "no vertex 100000"),
        ({0: -1, 1: 5}, "no vertex -1"),
    ],
)
def test_guides_that_cannot_be_used_are_refused(arms, guide, message):
    with pytest.raises(InputError, match=message):
        motion_of(*arms, guides=[guide])


def test_a_vertex_has_one_guide(arms):
    with pytest.raises(InputError, match="Vertex 5 of shape 0 is in 2"):
        motion_of(*arms, guides=[{0: 5, 1: 5}, {0: 5, 1: 9}])


HANDS_HEAD_FOOT_TAIL = ((0.9, 0.1, 0.35), (-0.9, 0.1, 0.35), (0.0, 0.15, 1.0), (0.45, -0.1, -0.9), (0.0, -0.9, -0.2))


@pytest.fixture(scope="module")
def turned_figure():
    """A figure, its copy rotated by half a circle, and a function from guides at the tips to the mapped tips."""
    mesh = figure()[0]
    turned = TriangleMesh(mesh.vertices * (-1.0, -1.0, 1.0), mesh.faces)
    other, place = shuffled(turned)
    tips = [int(np.argmax(mesh.vertices @ np.array(way) / np.linalg.norm(way))) for way in HANDS_HEAD_FOOT_TAIL]

    def mapped(*pairs):
        guides = [{0: tips[here], 1: int(place[tips[there]])} for here, there in pairs]
        motion = motion_of(mesh, other, settings=ROUGH, guides=guides)
        missed = motion.deformations[0, 1].points[tips] - turned.vertices[tips]
        return np.linalg.norm(missed, axis=1), motion.pairs[0, 1].guides_left_out

    return mapped


def test_a_figure_that_faces_the_other_way_needs_no_guides(turned_figure):
    assert turned_figure()[0].max() < 0.1


def test_two_guides_settle_which_hand_is_which_and_a_wrong_one_is_left_out(turned_figure):
    missed, left_out = turned_figure((0, 0), (1, 1), (3, 4))
    assert missed.max() < 0.1
    assert left_out == 1


def test_a_wrong_guide_alone_is_left_out():
    """The map is right without it: both figures stand the same way round."""
    mesh = figure()[0]
    other, place = shuffled(mesh)
    hand, head, foot = (
        int(np.argmax(mesh.vertices @ np.array(way))) for way in np.array(HANDS_HEAD_FOOT_TAIL)[[0, 2, 3]]
    )
    guides = [{0: hand, 1: int(place[hand])}, {0: head, 1: int(place[foot])}]
    # Between rough maps, rounding would decide.
    motion = motion_of(mesh, other, settings=replace(ROUGH, map_vertices=600), guides=guides)
    np.testing.assert_allclose(motion.deformations[0, 1].points, mesh.vertices, atol=0.1)
    assert motion.pairs[0, 1].guides_left_out == 1


def test_reading_shapes_that_are_made_coarser_is_reported():
    """It takes most of the time that the registration of shapes of a million vertices takes."""
    fractions = []
    for report in guided_motion([ball(points=4000), box()], ["ball", "box"], [(0, 1)], TINY):
        if str(report.message) != "Reading the shapes":
            break
        fractions.append(report.fraction)
    assert len(fractions) > 4 and fractions == sorted(fractions)
    assert fractions[0] == 0.0 < fractions[1] and fractions[-1] <= 0.05


@pytest.mark.parametrize("coherence", [0.5, 0.7, 1.0])
def test_a_larger_copy_is_reached_through_similar_shapes(coherence, growth):
    """However stiff they are."""
    for shape, size in zip(growth.with_coherence(coherence).moved([0.25, 0.75]), (2.5, 2.5 / 3.0), strict=True):
        own, rest = (points - points.mean(axis=0) for points in (shape.vertices, shape.rest.vertices))
        np.testing.assert_allclose(own, size * rest, atol=1e-3)


@pytest.fixture(scope="module")
def growth():
    """A figure becomes one three times as large, whose vertices are in another order."""
    mesh = figure()[0]
    return motion_of(mesh, shuffled(TriangleMesh(3.0 * mesh.vertices, mesh.faces))[0], settings=TINY)
