# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Compatibility of points on surfaces with known correspondence."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from benchmarks.meshes import blob
from convwass_addon.applications.soft_maps.compatibility import comparison
from convwass_addon.applications.soft_maps.map_sides import MapSide
from convwass_addon.applications.soft_maps.shape_descriptors import differences, shape_descriptors
from convwass_addon.applications.soft_maps.soft_map_settings import SoftMapSettings
from convwass_addon.geometry.deformation.unit_shape import UnitShape
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from tests.grids import figure, sheet
from tests.shapes import ball, bent, box, joined, square, torus

NONE = np.empty((0, 2), np.int64)
ONE, FOUR = np.array([[0, 1]]), np.array([[0, 1], [0, 2], [1, 3], [2, 3]])


def side(mesh, **groups):
    return MapSide(mesh, "it", groups)


def reordered(mesh, seed=0):
    order = np.random.default_rng(seed).permutation(len(mesh.vertices))
    return TriangleMesh(mesh.vertices[order], np.argsort(order)[mesh.faces]), order


@pytest.fixture(scope="module")
def arms():
    mesh, mirror = figure()
    hand, foot = (int(np.argmax(mesh.vertices @ way)) for way in [(1, 0, 0.3), (0.5, 0, -1)])
    return mesh, mirror, hand, foot


def positions(found, target):
    images = found.overlay.images
    return np.einsum("nc,ncd->nd", images.shares, target.corners[images.triangles])


def test_a_rotated_and_reordered_copy_is_matched_without_any_pair():
    mesh = TriangleMesh.from_arrays(*blob(400))
    turned = TriangleMesh(Rotation.from_euler("xyz", (1.0, 2.0, 3.0)).apply(mesh.vertices) * 9.0, mesh.faces)
    other, order = reordered(turned)
    found = comparison(side(mesh), side(other), NONE)
    assert found.costs.shape == (400, 400)
    assert found.costs.dtype == np.float32
    np.testing.assert_array_equal(order[found.costs.argmin(axis=1)], np.arange(400))
    np.testing.assert_allclose(positions(found, other), turned.vertices, atol=1e-3)
    assert not found.overlay.is_mirrored


def test_left_and_right_are_ambiguous_without_pairs(arms):
    mesh, mirror, hand, foot = arms
    shape = UnitShape.of(mesh)
    nothing = np.zeros((0, len(mirror)))
    unmarked = differences(*[shape_descriptors(shape, np.empty(0, np.int64), nothing)] * 2)
    np.testing.assert_allclose(unmarked[:, mirror], unmarked, atol=1e-3)
    marked = shape_descriptors(shape, np.array([hand, foot]), nothing)
    told = differences(marked, marked)
    off = np.abs(mesh.vertices[:, 0]) > 0.3
    rows = np.flatnonzero(off)
    assert (told[rows, mirror[rows]] > told[rows, rows] + 0.05).all()


@pytest.mark.parametrize(("bend", "pairs"), [(0.0, 2), (0.8, 3)])
@pytest.mark.parametrize("is_mirrored", [False, True])
def test_two_or_three_pairs_tell_left_from_right(arms, is_mirrored, pairs, bend):
    mesh, mirror, hand, foot = arms
    other = replace(mesh, vertices=bent(mesh.vertices, bend)) if bend else mesh
    marked = np.array([hand, int(mirror[foot]), int(mirror[hand])])[:pairs]
    partner = mirror if is_mirrored else np.arange(len(mirror))
    found = comparison(side(mesh), side(other), np.stack([marked, partner[marked]], axis=1))
    assert found.overlay.is_mirrored == is_mirrored
    off = np.abs(mesh.vertices[:, 0]) > 0.1
    wanted, wrong = other.vertices[partner], other.vertices[mirror[partner]]
    chosen = other.vertices[found.costs.argmin(axis=1)]
    right = np.linalg.norm(chosen - wanted, axis=1) < np.linalg.norm(chosen - wrong, axis=1)
    assert right[off].mean() > 0.99
    assert np.linalg.norm(chosen - wanted, axis=1).mean() < 0.03 * mesh.root_area


def test_moving_scaling_and_reordering_change_nothing(arms):
    mesh, _, hand, foot = arms
    other, order = reordered(mesh, 5)
    other = TriangleMesh(0.01 * Rotation.from_euler("z", 0.7).apply(other.vertices) - 3.0, other.faces)
    target = replace(mesh, vertices=bent(mesh.vertices, 0.8))
    rank = np.argsort(order)
    tips = np.array([hand, foot, int(np.argmax(mesh.vertices[:, 2]))])
    first = comparison(side(mesh), side(target), np.stack([tips, tips], 1)).costs
    second = comparison(side(other), side(target), np.stack([rank[tips], tips], 1)).costs
    assert np.abs(second - first[order]).mean() < 0.01


def test_painted_groups_distinguish_similar_points():
    mesh = ball(points=200)
    weights = (mesh.vertices[:, 2] > 0.3).astype(float)
    painted = side(mesh, cap=weights, own=np.ones(200))
    plain = comparison(side(mesh), side(mesh), NONE).costs
    found = comparison(painted, side(mesh, cap=weights), NONE).costs
    apart = weights[:, None] != weights
    assert (found - plain)[apart].mean() > (found - plain)[~apart].mean() + 0.2
    without = comparison(painted, side(mesh, cap=weights), NONE, SoftMapSettings(group_weight=0.0)).costs
    np.testing.assert_allclose(without, plain, atol=0.05)


@pytest.mark.parametrize(
    ("source", "target", "pairs"),
    [
        (torus(segments=(16, 10)), ball(points=120), NONE),
        (sheet(9, 7), ball(points=120), ONE),
        (ball(points=60), ball(points=300), FOUR),
        (joined(ball(points=60), ball(points=60, center=(3, 0, 0))), ball(points=120), ONE),
        (square(), square(), NONE),
        (square(), square(), FOUR),
        (square(), box(), ONE),
    ],
)
def test_degenerate_input_gives_finite_numbers(source, target, pairs):
    found = comparison(side(source), side(target), pairs)
    assert found.costs.shape == (len(source.vertices), len(target.vertices))
    assert np.isfinite(found.costs).all()
    assert found.costs.min() >= 0


def test_loose_vertices_are_ignored():
    mesh = TriangleMesh.from_arrays(*blob(200))
    loose = TriangleMesh(np.concatenate([[[9.0, 9, 9]], mesh.vertices]), mesh.faces + 1)
    found = comparison(side(loose), side(loose), NONE).costs
    assert np.isfinite(found).all()
    np.testing.assert_array_equal(found.argmin(axis=1)[1:], np.arange(1, 201))
