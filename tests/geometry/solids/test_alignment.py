# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes that are translated, rotated and scaled copies of each other are aligned."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.spatial.transform import Rotation

from convwass_addon.errors import InputError
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.solids.alignment import RigidMove, SolidMoments, aligned

from ...shapes import ball, box, joined, square, torus, tube_with_caps, with_faces

angles = st.floats(-np.pi, np.pi)
rotations = st.tuples(angles, angles, angles).map(lambda xyz: Rotation.from_euler("xyz", xyz).as_matrix())
offsets = st.tuples(*[st.floats(-20, 20)] * 3).map(np.array)
scales = st.floats(0.1, 10.0)


def lopsided():
    """A long slab with a leg at one end and an ear: three different axes, each with a heavier end."""
    return joined(
        box((4.0, 2.0, 1.0)),
        box((0.6, 0.6, 2.0), (1.6, 0.6, -1.4)),
        box((0.5, 0.9, 0.7), (-1.8, -0.5, 0.8)),
    )


def bent_sheet():
    """An L of three flat rectangles with a flap."""
    points = [(0, 0, 0), (4, 0, 0), (4, 1, 0), (0, 1, 0), (0, 3, 0), (1, 3, 0), (1, 1, 0), (4, 0, 0.7)]
    return TriangleMesh.from_arrays(points, [(0, 1, 2), (0, 2, 3), (3, 6, 5), (3, 5, 4), (1, 7, 2)])


def changed(mesh, rotation=None, offset=(0, 0, 0), scale=1.0):
    rotation = np.eye(3) if rotation is None else rotation
    return TriangleMesh(scale * mesh.vertices @ rotation.T + offset, mesh.faces)


@given(rotations, offsets, scales)
@settings(max_examples=15)
def test_a_rotated_translated_and_scaled_copy_is_aligned(rotation, offset, scale):
    shape = changed(lopsided(), offset=(3, -2, 1))
    copy = changed(lopsided(), rotation, offset, scale)
    first, second = aligned([shape, copy], "PRINCIPAL_AXES", "EQUAL_VOLUME")
    np.testing.assert_allclose(first.moved(shape).vertices, shape.vertices, atol=1e-12)
    np.testing.assert_allclose(second.moved(copy).vertices, shape.vertices, atol=1e-7)
    np.testing.assert_allclose(second.rotation, rotation.T, atol=1e-7)
    assert second.scale == pytest.approx(1 / scale)


@given(rotations)
@settings(max_examples=15)
def test_copies_that_nearly_match_the_other_way_round_are_turned_back(rotation):
    """A small ear tells which side of a slab with a heavy end is up: upside down, it matches almost as well."""
    shape = joined(box((4.0, 2.0, 1.0)), box((1.0, 1.6, 0.9), (2.5, 0.0, 0.0)), box((0.5, 0.4, 0.6), (1.2, 0.5, 0.8)))
    _, move = aligned([shape, changed(shape, rotation)], "PRINCIPAL_AXES", "PLACED")
    np.testing.assert_allclose(move.rotation, rotation.T, atol=1e-7)


@given(rotations, offsets)
@settings(max_examples=20)
def test_alignment_never_mirrors(rotation, offset):
    mirrored = lopsided().vertices * (-1, 1, 1) @ rotation.T + offset
    other = TriangleMesh(mirrored, np.ascontiguousarray(lopsided().faces[:, ::-1]))
    _, move = aligned([lopsided(), other], "PRINCIPAL_AXES", "PLACED")
    assert np.linalg.det(move.rotation) == pytest.approx(1.0)
    np.testing.assert_allclose(move.rotation @ move.rotation.T, np.eye(3), atol=1e-12)


@given(rotations)
@settings(max_examples=20)
def test_surfaces_without_volume_are_aligned_as_sheets(rotation):
    sheet = bent_sheet()
    _, move = aligned([sheet, changed(sheet, rotation, (1, 2, 3))], "PRINCIPAL_AXES", "PLACED")
    np.testing.assert_allclose(move.moved(changed(sheet, rotation, (1, 2, 3))).vertices, sheet.vertices, atol=1e-6)


def test_moments_are_exact():
    """A box of sides a, b, c has the variances a²/12, b²/12, c²/12; a tetrahedron's third moment is known."""
    solid = SolidMoments.of(box((4.0, 2.0, 1.0), (5, 6, 7)))
    np.testing.assert_allclose(solid.second, np.diag([16, 4, 1]) / 12, atol=1e-12)
    np.testing.assert_allclose(solid.center, (5, 6, 7))
    np.testing.assert_allclose(solid.third, 0.0, atol=1e-12)
    corner = TriangleMesh.from_arrays(
        [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
    )
    # Each coordinate of a uniform point in it has the distribution Beta(1, 3): raw moments 1/4, 1/10, 1/20.
    assert SolidMoments.of(corner).second[0, 0] == pytest.approx(1 / 10 - 1 / 16)
    assert SolidMoments.of(corner).third[0, 0, 0] == pytest.approx(1 / 20 - 3 / 4 / 10 + 2 / 64)


@pytest.mark.parametrize(
    "shape", [ball(), box((2, 2, 2)), torus(), box((3, 3, 1))], ids=["ball", "cube", "ring", "slab"]
)
def test_symmetric_shapes_are_not_rotated_unnecessarily(shape):
    _, move = aligned([shape, shape.moved((4, 5, 6))], "PRINCIPAL_AXES", "PLACED")
    np.testing.assert_allclose(move.rotation, np.eye(3), atol=1e-6)


def test_a_rod_is_aligned_with_a_rod_by_the_smallest_rotation():
    rod, across = box((4, 1, 1)), box((1, 1, 4), angles=(0.3, 0.0, 0.0))
    _, move = aligned([rod, across], "PRINCIPAL_AXES", "PLACED")
    np.testing.assert_allclose(
        np.abs(move.rotation @ Rotation.from_euler("x", 0.3).apply((0, 0, 1))), (1, 0, 0), atol=1e-9
    )
    assert np.degrees(Rotation.from_matrix(move.rotation).magnitude()) == pytest.approx(90.0, abs=1e-6)


def test_as_placed_changes_nothing():
    shapes = [lopsided(), ball(2.0, (5, 0, 0)), square()]
    for move in aligned(shapes, "PLACED", "PLACED"):
        np.testing.assert_array_equal(move.matrix, np.eye(4))


def test_centered_moves_the_centers_to_that_of_the_first():
    shapes = [ball(1.0, (1, 2, 3)), box((1, 2, 3), (7, 8, 9))]
    moves = aligned(shapes, "CENTERED", "PLACED")
    np.testing.assert_allclose(moves[1].moved(shapes[1]).bounds.mean(axis=0), (1, 2, 3), atol=1e-3)
    np.testing.assert_array_equal(moves[1].rotation, np.eye(3))


def test_equal_volume_scales_about_the_shapes_center():
    shapes = [box((2, 2, 2)), box((1, 1, 1), (5, 0, 0))]
    move = aligned(shapes, "PLACED", "EQUAL_VOLUME")[1]
    after = move.moved(shapes[1])
    assert after.volume == pytest.approx(8.0)
    np.testing.assert_allclose(after.bounds.mean(axis=0), (5, 0, 0))


def test_inside_out_shapes_have_positive_volume():
    shapes = [box((2, 2, 2)), box().flipped()]
    assert aligned(shapes, "PLACED", "EQUAL_VOLUME")[1].scale == pytest.approx(2.0)


def test_an_open_shape_has_the_volume_with_its_hole_closed():
    """A copy of a tube without the cap at one end, like a scanned arm, has the same size as the tube."""
    tube, move = tube_with_caps(), Rotation.from_euler("xyz", (0.3, 0.5, 0.9)).as_matrix()
    is_cap = (tube.corners[..., 2] > 1.99).all(axis=1)
    scanned = changed(with_faces(tube, ~is_cap), move, (4, 0, 0), 3.0)
    assert aligned([tube, scanned], "PLACED", "EQUAL_VOLUME")[1].scale == pytest.approx(1 / 3, rel=0.005)


def test_shapes_without_volume_are_refused_by_name():
    with pytest.raises(InputError, match="Sheet"):
        aligned([box(), square()], "CENTERED", "EQUAL_VOLUME", ["Box", "Sheet"])


@pytest.mark.parametrize("alignment", ["CENTERED", "PRINCIPAL_AXES"])
def test_shapes_without_area_are_refused_by_name(alignment):
    line = TriangleMesh.from_arrays([(0, 0, 0), (1, 0, 0), (2, 0, 0)], [(0, 1, 2)])
    with pytest.raises(InputError, match="'Line' has no area"):
        aligned([box(), line], alignment, "PLACED", ["Box", "Line"])


@given(rotations, offsets, scales)
def test_the_matrix_agrees_with_the_transformation(rotation, offset, scale):
    move = RigidMove(rotation, scale, offset, -offset)
    mesh = lopsided()
    by_matrix = np.c_[mesh.vertices, np.ones(len(mesh.vertices))] @ move.matrix.T
    np.testing.assert_allclose(by_matrix[:, :3], move.moved(mesh).vertices, atol=1e-9)
