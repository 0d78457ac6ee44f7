# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Extrusions are recognized along any axis, and other solids are not."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.meshes.normals import triangle_normals
from convwass_addon.geometry.recognition.extrusion import common_extrusions
from tests.flat_shapes import ellipse, rectangle
from tests.shapes import ball, bent_tube, box, extruded, joined, rotated, spring, torus, tube_with_caps

FRAME = extruded(rectangle((-1.0, -0.7), (1.0, 0.7)), rectangle((-0.5, -0.3), (0.5, 0.3)))
DISC = extruded(ellipse(), low=0.1, high=0.4)
TILT = np.array([0.5, 1.0, -0.25])


def test_sections_and_ends_are_exact():
    frame, (plate, disc) = common_extrusions([FRAME, DISC])
    assert np.abs(frame[2]) == pytest.approx([0.0, 0.0, 1.0])
    assert [plate.section.area, disc.section.area] == pytest.approx([2.8 - 0.6, np.pi], rel=1e-6)
    assert sorted(np.abs([disc.low, disc.high])) == pytest.approx([0.1, 0.4])
    assert (plate.low, plate.high) == pytest.approx((-0.2, 0.2))


def test_the_axis_may_have_any_direction():
    frame, found = common_extrusions([rotated(mesh, TILT) for mesh in (FRAME, DISC)])
    axis = Rotation.from_rotvec(TILT).apply([0.0, 0.0, 1.0])
    assert abs(frame[2] @ axis) == pytest.approx(1.0)
    assert np.linalg.det(frame) == pytest.approx(1.0)
    assert frame @ frame.T == pytest.approx(np.eye(3))
    assert [own.section.area for own in found] == pytest.approx([2.2, np.pi], rel=1e-6)


def test_sections_stand_upright():
    """The second direction of the plane points as far upward as it can."""
    (first, second, axis), _ = common_extrusions([rotated(DISC, (0.5 * np.pi, 0.0, 0.0))])
    assert second == pytest.approx([0.0, 0.0, 1.0])
    assert np.cross(first, second) == pytest.approx(axis)


def test_of_several_axes_the_thinnest_is_taken():
    for thin in range(3):
        size = np.full(3, 2.0)
        size[thin] = 0.5
        frame, _ = common_extrusions([box(size)])
        assert abs(frame[2, thin]) == pytest.approx(1.0)


def test_a_box_has_the_axis_of_the_other_shape():
    frame, (cube, _) = common_extrusions([box(), tube_with_caps()])
    assert frame[2] == pytest.approx([0.0, 0.0, 1.0])
    assert cube.section.area == pytest.approx(1.0)


def test_rounded_ends_are_extrusions_if_they_are_small():
    def chamfered(depth):
        corners = np.array([[(-1, -1), (1, -1), (1, 1), (-1, 1)]], np.float64)
        rings = [corners[0] * (1.0 - depth), corners[0], corners[0], corners[0] * (1.0 - depth)]
        heights = np.array([0.0, depth, 1.0 - depth, 1.0])
        points = np.concatenate(
            [np.column_stack([ring, np.full(4, z)]) for ring, z in zip(rings, heights, strict=True)]
        )
        faces = [(0, 2, 1), (0, 3, 2), (12, 13, 14), (12, 14, 15)]
        for level in range(3):
            for side in range(4):
                a, b = 4 * level + side, 4 * level + (side + 1) % 4
                faces += [(a, b, b + 4), (a, b + 4, a + 4)]
        return TriangleMesh.from_arrays(points, faces)

    assert common_extrusions([chamfered(0.1)]) is not None
    assert common_extrusions([chamfered(0.45)]) is None


@pytest.mark.parametrize(
    "other",
    [
        ball(),
        torus(),
        bent_tube(1.5),
        spring(3.0),
        joined(box((1.0, 1.0, 0.4)), box((1.0, 1.0, 1.0), (3.0, 0.0, 0.0))),
        joined(box((1.0, 1.0, 0.4)), box((1.0, 1.0, 0.4), (3.0, 3.0, 3.0))),
        rotated(DISC, (np.radians(10.0), 0.0, 0.0)),
        TriangleMesh(DISC.vertices * (1.0, 1.0, 0.0), DISC.faces),
    ],
    ids=["ball", "torus", "bent tube", "spring", "depths", "places", "axes", "flat"],
)
def test_other_solids_are_not(other):
    assert common_extrusions([DISC, other]) is None


def test_a_slanted_end_is_not_one_of_an_extrusion():
    vertices = FRAME.vertices.copy()
    vertices[vertices[:, 2] > 0, 2] += 0.3 * vertices[vertices[:, 2] > 0, 0] + 0.3
    assert common_extrusions([TriangleMesh(vertices, FRAME.faces)]) is None


def test_parts_beside_the_middle_are_not_lost():
    """A van with wheels on both sides, which its section halfway does not cross."""
    van = extruded(rectangle((-2.0, 0.0), (2.0, 1.0)), low=-0.7, high=0.7)
    wheels = [
        extruded(rectangle((x - 0.2, -0.3), (x + 0.2, 0.1)), low=z, high=z + 0.15)
        for x in (-1.2, 1.2)
        for z in (-0.7, 0.55)
    ]
    assert common_extrusions([van]) is not None
    assert common_extrusions([joined(van, *wheels)]) is None
    through = extruded(rectangle((-1.4, -0.3), (-1.0, 0.1)), low=-0.7, high=0.7)
    assert common_extrusions([joined(van, through)]) is not None
    loose = TriangleMesh(np.concatenate([[(9.0, 9.0, 9.0)], van.vertices]), van.faces + 1)
    assert common_extrusions([loose]) is not None


def test_pieces_that_meet_in_seams_are_one():
    """The front and the sides of solid text share no vertices."""
    ends = np.abs(triangle_normals(FRAME.corners)[:, 2]) > 0.5
    apart = joined(*(TriangleMesh(FRAME.vertices, FRAME.faces[own]) for own in (ends, ~ends)))
    assert common_extrusions([apart]) is not None
