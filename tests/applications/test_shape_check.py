# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes with known faults are found out, and good ones are left in peace."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.morphs.shape_check import check_shape
from convwass_addon.geometry.meshes.mesh import TriangleMesh

from ..shapes import ball, box, joined, square, torus, with_faces


@pytest.mark.parametrize("shape", [box(), ball(), torus(), joined(box(), ball(center=(3, 0, 0)))])
def test_good_shapes_are_sound(shape):
    findings = check_shape(shape)
    assert (findings.worst, findings.open_edges, findings.flipped_faces) == ("SOUND", 0, 0)


def test_a_cavity_is_no_fault():
    assert check_shape(joined(ball(2.0), ball(1.0).flipped())).worst == "SOUND"


def test_a_sheet_has_no_volume():
    assert check_shape(square()).worst == "NO_VOLUME"
    assert not check_shape(TriangleMesh.from_arrays(np.ones((3, 3)), [(0, 1, 2)])).has_volume


def test_holes_are_counted_by_their_edges():
    findings = check_shape(with_faces(ball(), slice(1, None)))
    assert (findings.worst, findings.open_edges) == ("HOLES", 3)


def test_a_sheet_beside_a_solid_is_no_hole():
    assert check_shape(joined(ball(), square(1.0, (3.0, 0.0, 0.0)))).worst == "SOUND"
    findings = check_shape(joined(with_faces(ball(), slice(1, None)), square(1.0, (3.0, 0.0, 0.0))))
    assert (findings.worst, findings.open_edges) == ("HOLES", 3)


def test_separate_triangles_have_no_holes():
    shape = box()
    soup = TriangleMesh.from_arrays(shape.corners.reshape(-1, 3), np.arange(36).reshape(-1, 3))
    assert check_shape(soup).worst == "SOUND"


def test_flipped_faces_are_counted():
    shape = ball()
    faces = shape.faces.copy()
    faces[:7] = faces[:7, ::-1]
    findings = check_shape(TriangleMesh(shape.vertices, faces))
    assert (findings.worst, findings.flipped_faces) == ("FLIPPED", 7)
    assert check_shape(box().flipped()).flipped_faces == 12
