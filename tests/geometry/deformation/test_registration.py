# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Registration of surfaces with known correspondence."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from convwass_addon.errors import Cancelled
from convwass_addon.geometry.deformation.registration import BY_PAIRS, TO_THE_END, Registration, Stage
from convwass_addon.geometry.deformation.unit_shape import UnitShape
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.meshes.normals import vertex_normals
from tests.controls import CountingControl
from tests.grids import figure, sheet
from tests.shapes import ball, bent, box


def advanced(found, stages=BY_PAIRS + TO_THE_END):
    found.advance(stages)
    return found


def image_positions(found, target):
    images = found.images()
    return np.einsum("nc,ncd->nd", images.shares, target.mesh.corners[images.triangles])


@pytest.fixture(scope="module")
def arms():
    mesh, _ = figure()
    # Extremal vertices: head, arms, feet.
    ends = [int(np.argmax(mesh.vertices @ way)) for way in [(0, 0, 1), (1, 0, 0.3), (-1, 0, 0.3), (0.5, 0, -1)]]
    return mesh, np.array([*ends, int(np.argmax(mesh.vertices @ (-0.5, 0, -1)))])


def test_a_rotated_copy_is_registered_exactly(arms):
    mesh, ends = arms
    turn = Rotation.from_euler("xyz", (0.8, 2.0, -0.5))
    source = UnitShape.of(mesh)
    target = UnitShape.of(TriangleMesh(3.0 * turn.apply(mesh.vertices) + 1.0, mesh.faces))
    start = turn.apply(source.vertices)
    found = advanced(Registration(source, target, np.stack([ends, ends], 1), start))
    np.testing.assert_allclose(found.points, target.vertices, atol=1e-6)
    np.testing.assert_allclose(image_positions(found, target), target.vertices, atol=1e-6)
    assert found.energy() == pytest.approx(0.0, abs=1e-6)


def test_a_bent_figure_is_registered(arms):
    mesh, ends = arms
    source, target = UnitShape.of(mesh), UnitShape.of(TriangleMesh(bent(mesh.vertices, 2.2), mesh.faces))
    found = Registration(source, target, np.stack([ends, ends], 1), source.vertices)
    before = np.linalg.norm(source.vertices - target.vertices, axis=1).mean()
    advanced(found)
    missed = np.linalg.norm(image_positions(found, target) - target.vertices, axis=1)
    assert before > 0.05
    assert missed.mean() < 0.012
    assert missed.max() < 0.08


def test_pairs_are_kept(arms):
    mesh, ends = arms
    source, target = UnitShape.of(mesh), UnitShape.of(TriangleMesh(bent(mesh.vertices, 0.8), mesh.faces))
    found = advanced(Registration(source, target, np.stack([ends, ends], 1), source.vertices))
    np.testing.assert_allclose(found.points[ends], target.vertices[ends], atol=0.01)


def test_the_order_of_vertices_does_not_matter(arms):
    mesh, ends = arms
    order = np.random.default_rng(1).permutation(len(mesh.vertices))
    rank = np.argsort(order)
    mixed = TriangleMesh(mesh.vertices[order], rank[mesh.faces])
    target = UnitShape.of(TriangleMesh(bent(mesh.vertices, 0.8), mesh.faces))
    first, second = UnitShape.of(mesh), UnitShape.of(mixed)
    one = advanced(Registration(first, target, np.stack([ends, ends], 1), first.vertices))
    other = advanced(Registration(second, target, np.stack([rank[ends], ends], 1), second.vertices))
    np.testing.assert_allclose(other.points, one.points[order], atol=1e-3)


def test_loose_vertices_are_ignored(arms):
    mesh, ends = arms
    loose = TriangleMesh(np.concatenate([mesh.vertices, [[4.0, 4, 4]]]), mesh.faces)
    source, target = UnitShape.of(loose), UnitShape.of(mesh)
    found = Registration(source, target, np.stack([ends, ends], 1), source.vertices)
    advanced(found)
    np.testing.assert_allclose(found.points[:-1], target.vertices, atol=1e-6)
    np.testing.assert_array_equal(found.points[-1], source.vertices[-1])


def test_without_pairs_a_nearby_start_is_enough(arms):
    mesh, _ = arms
    source, target = UnitShape.of(mesh), UnitShape.of(TriangleMesh(bent(mesh.vertices, 0.3), mesh.faces))
    found = advanced(Registration(source, target, np.empty((0, 2), np.int64), source.vertices), TO_THE_END)
    missed = np.linalg.norm(image_positions(found, target) - target.vertices, axis=1)
    assert missed.mean() < 0.012


@pytest.mark.parametrize("shape", [sheet(8, 6), box(), ball(points=4)])
def test_flat_and_tiny_surfaces_give_finite_numbers(shape):
    target = UnitShape.of(ball(points=50))
    found = advanced(Registration(UnitShape.of(shape), target, np.array([[0, 0]]), UnitShape.of(shape).vertices))
    assert np.isfinite(found.points).all()
    assert np.isfinite(found.energy())


def test_unit_shapes_have_unit_area_and_can_be_mirrored():
    mesh = TriangleMesh(5.0 * box((1.0, 2.0, 3.0)).vertices + 7.0, box().faces)
    shape = UnitShape.of(mesh)
    assert shape.mesh.area == pytest.approx(1.0)
    assert shape.areas.sum() == pytest.approx(1.0)
    np.testing.assert_allclose(shape.areas @ shape.vertices, 0.0, atol=1e-12)
    image = shape.mirrored()
    np.testing.assert_array_equal(image.vertices[:, 0], -shape.vertices[:, 0])
    assert image.mesh.volume == pytest.approx(shape.mesh.volume)
    assert shape.mesh.volume > 0


def test_normals_of_a_ball_point_away_from_its_center():
    mesh = ball(points=300)
    found = vertex_normals(mesh.vertices, mesh.faces)
    assert np.einsum("nd,nd->n", found, mesh.vertices).min() > 0.99


def test_a_start_without_confidence_has_no_effect(arms):
    mesh, _ = arms
    source, target = UnitShape.of(mesh), UnitShape.of(TriangleMesh(bent(mesh.vertices, 0.8), mesh.faces))
    start = target.vertices.copy()
    wrong = source.vertices[:, 0] > np.quantile(source.vertices[:, 0], 0.8)
    start[wrong] += (0.0, 0.0, 1.0)
    pairs = np.empty((0, 2), np.int64)
    stages = (Stage(0.0, 100.0, 0.06, 3), Stage(20.0, 30.0, 0.05, 8))
    doubted = advanced(Registration(source, target, pairs, start, 1.0 - wrong), stages)
    believed = advanced(Registration(source, target, pairs, start), stages)
    missed = [np.linalg.norm(found.points - target.vertices, axis=1)[wrong].mean() for found in (doubted, believed)]
    assert missed[0] < 0.1 * missed[1]


@pytest.mark.parametrize("give", [None, 0.2])
def test_registrations_do_not_depend_on_earlier_ones(arms, give):
    mesh, ends = arms
    target, pairs = UnitShape.of(TriangleMesh(bent(mesh.vertices, 1.0), mesh.faces)), np.stack([ends, ends], 1)

    def found(source, closeness):
        stage = Stage(closeness, 0.0, 0.08, 3, give)
        return advanced(Registration(source, target, pairs, source.vertices), (stage,)).points

    source = UnitShape.of(mesh)
    found(source, 30.0)
    np.testing.assert_array_equal(found(source, 10.0), found(UnitShape.of(mesh), 10.0))


def test_it_can_be_stopped_within_a_stage(arms):
    source = UnitShape.of(arms[0])
    found = Registration(source, source, np.empty((0, 2), np.int64), source.vertices)
    with pytest.raises(Cancelled):
        found.advance(TO_THE_END[:1], CountingControl(last=3))


NO_PAIRS, UP = np.empty((0, 2), np.int64), np.array([0.0, 0.0, 1.0])


@pytest.mark.parametrize("give", [None, 0.2])
def test_every_vertex_is_pulled_to_a_coarse_surface(give):
    """Bumps are flattened, also far from the few vertices of the flat surface."""
    flat = sheet(21, 21)
    heights = 0.02 * np.sin(20.0 * flat.vertices[:, 0]) * np.sin(20.0 * flat.vertices[:, 1])
    source = UnitShape.of(TriangleMesh(flat.vertices + heights[:, None] * UP, flat.faces))
    found = Registration(source, UnitShape.of(sheet(3, 3)), NO_PAIRS, source.vertices)
    advanced(found, (Stage(1e4, 0.0, 0.03, 5, give),))
    assert np.abs(source.vertices[:, 2]).max() > 0.015
    assert np.abs(found.points[:, 2]).max() < 0.002


@pytest.mark.parametrize(("reach", "height"), [(0.2, 0.3), (0.4, 0.0)])
@pytest.mark.parametrize("give", [None, 0.2])
def test_points_beyond_the_reach_have_no_effect(reach, height, give):
    shape = UnitShape.of(sheet(9, 9))
    found = Registration(shape, shape, NO_PAIRS, shape.vertices + 0.3 * UP)
    found.reach = reach
    advanced(found, (Stage(1e3, 0.0, 0.05, 5, give),))
    np.testing.assert_allclose(found.points, shape.vertices + height * UP, atol=0.005)


def test_the_energy_rises_with_the_square_of_the_distance():
    shape = UnitShape.of(sheet(9, 9))
    near, far = (Registration(shape, shape, NO_PAIRS, shape.vertices + z * UP).energy() for z in (0.01, 0.03))
    assert far == pytest.approx(9.0 * near, rel=1e-6)
    assert near > 0.0
