# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Sheets beside solids become plates."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.meshes.edges import topology
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.meshes.welding import welded
from convwass_addon.geometry.solids.plates import Plates
from tests.grids import sheet
from tests.shapes import ball, box, joined, with_faces

BALL = ball(1.0, points=400)
# A square with sides of one, upright beside the ball.
FIN = TriangleMesh(sheet(9, 9).vertices[:, [2, 0, 1]] + (0.0, 1.5, 0.0), sheet(9, 9).faces)


def apart(mesh):
    """The same triangles without common vertices."""
    return TriangleMesh(mesh.corners.reshape(-1, 3), np.arange(3 * len(mesh.faces)).reshape(-1, 3))


def dome(height):
    """A sheet on a circle with a radius of one that rises to a height, part of a sphere."""
    flat = sheet(25, 25)
    points = 2.0 * (flat.vertices[:, :2] - flat.vertices[:, :2].mean(axis=0))
    points *= (np.abs(points).max(axis=1) / np.maximum(np.linalg.norm(points, axis=1), 1e-9))[:, None]
    radius = (1.0 + height**2) / (2.0 * height)
    rise = np.sqrt(np.maximum(radius**2 - np.square(points).sum(axis=1), 0.0)) - (radius - height)
    return TriangleMesh(np.column_stack([points, rise + 2.0]), flat.faces)


def test_a_sheet_beside_a_solid_gets_the_volume_of_its_area_and_thickness():
    shape = joined(BALL, FIN)
    thick = Plates.of(shape).thick(shape.vertices, 0.1)
    assert topology(thick).closed
    assert thick.volume == pytest.approx(BALL.volume + 0.1 * FIN.area)
    np.testing.assert_array_equal(thick.vertices[: len(shape.vertices)], shape.vertices)
    assert np.ptp(thick.vertices[len(shape.vertices) :, 0]) == 0.0


def test_every_triangle_of_a_plate_belongs_to_one_of_the_sheet():
    shape = joined(BALL, FIN)
    plates = Plates.of(shape)
    thick = plates.thick(shape.vertices, 1e-6)
    np.testing.assert_array_equal(plates.sources[: len(shape.faces)], np.arange(len(shape.faces)))
    added = plates.sources[len(shape.faces) :]
    assert (added >= len(BALL.faces)).all()
    rims = 4 * 8
    assert len(added) == len(FIN.faces) + 2 * rims
    middles = thick.corners[len(shape.faces) :][: len(FIN.faces)].mean(axis=1)
    np.testing.assert_allclose(middles, shape.corners[added[: len(FIN.faces)]].mean(axis=1), atol=1e-5)


def test_plates_follow_other_poses():
    shape = joined(BALL, FIN)
    turned = shape.vertices[:, [1, 2, 0]]
    thick = Plates.of(shape).thick(turned, 0.1)
    assert thick.volume == pytest.approx(BALL.volume + 0.1 * FIN.area)


def test_triangles_that_share_no_vertices_stay_together():
    shape = joined(BALL, apart(dome(0.3)))
    thick = Plates.of(shape).thick(shape.vertices, 0.05)
    assert topology(welded(thick)).closed
    assert thick.volume == pytest.approx(BALL.volume + 0.05 * dome(0.3).area, rel=0.02)


def test_a_sheet_that_shares_vertices_with_a_solid_does_not_deform_it():
    cube = box()
    corners = [int(np.argmax(cube.vertices @ way)) for way in [(1, 1, 1), (1, 1, -1)]]
    vertices = np.concatenate([cube.vertices, 2.0 * cube.vertices[corners]])
    faces = [[corners[0], corners[1], 8], [corners[1], 9, 8]]
    shape = TriangleMesh(vertices, np.concatenate([cube.faces, faces]))
    thick = Plates.of(shape).thick(shape.vertices, 0.01)
    np.testing.assert_array_equal(thick.vertices[: len(vertices)], vertices)
    area = TriangleMesh(vertices, np.array(faces)).area
    assert thick.volume == pytest.approx(1.0 + 0.01 * area)


def test_sheets_beside_each_other_are_found_whatever_they_face():
    others = [TriangleMesh(FIN.vertices + np.array([0.0, 0.0, 1.02 * k]), FIN.faces[:, :: (-1) ** k]) for k in range(3)]
    shape = joined(BALL, *others)
    assert len(Plates.of(shape).sheets) == 3 * len(FIN.faces)


@pytest.mark.parametrize(
    "shape",
    [
        BALL,
        FIN,
        joined(BALL, with_faces(ball(1.0, (3.0, 0.0, 0.0)), np.arange(2000))),
        joined(BALL, dome(1.0)),
        # A cube whose sides have no common corners, as from CAD.
        joined(
            *(TriangleMesh(box().vertices * 1.001, box().faces[k : k + 2]) for k in range(0, 12, 2)),
            box(center=(3.0, 0.0, 0.0)),
        ),
    ],
    ids=["solid", "nothing but a sheet", "solid with a hole", "hemisphere", "separate sides"],
)
def test_other_shapes_have_no_plates(shape):
    assert Plates.of(shape) is None


def test_flat_domes_are_sheets():
    assert len(Plates.of(joined(BALL, dome(0.3))).sheets) == len(dome(0.3).faces)
