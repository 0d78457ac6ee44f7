# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Solids of revolution are recognized about any axis, and other solids are not."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from benchmarks.props import revolved
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.plane.ring_nesting import outline_of
from convwass_addon.geometry.recognition.revolution import common_revolutions
from tests.flat_shapes import ellipse
from tests.shapes import ball, bent_tube, box, extruded, joined, rotated, spring, torus, tube_with_caps

PROFILE = [(0.0, 0.0), (1.0, 0.0), (0.0, 2.0)]
# Six arms, whose corners are at twelve even angles.
STAR = np.array([1.0, 0.6] * 6)[:, None] * ellipse(corners=12)
CONE, OCTAGON = revolved(PROFILE), revolved(PROFILE, 8)
CUP = revolved([(0.0, 0.0), (0.8, 0.0), (1.0, 1.5), (0.9, 1.5), (0.7, 0.1), (0.0, 0.1)])
TILT = np.array([0.5, 1.0, -0.25])


def test_sections_are_exact_and_symmetric():
    frame, (cone, cup) = common_revolutions([CONE, CUP.moved((3.0, 1.0, 0.5))])
    assert frame[1] == pytest.approx([0.0, 0.0, 1.0])
    assert frame @ frame.T == pytest.approx(np.eye(3))
    assert cone.section.area == pytest.approx(2.0)
    assert np.abs(cone.section.bounds[:, 0]) == pytest.approx([1.0, 1.0])
    assert cone.section.center[0] == pytest.approx(0.0, abs=1e-9)
    assert cup.section.area == pytest.approx(2.0 * (0.9 * 1.5 - 0.8 * 1.4), rel=1e-6)
    assert cup.center[:2] == pytest.approx([3.0, 1.0])


@pytest.mark.parametrize("sides", [6, 7, 8, 12])
def test_solids_of_few_sides(sides):
    profile = [(0.0, 0.0), (0.8, 0.0), (1.0, 1.5), (0.9, 1.5), (0.7, 0.1), (0.0, 0.1)]
    cup = rotated(revolved(profile, sides), (0.0, 0.0, 0.4))
    # Edges across the axis may be anywhere, and the axis may lie.
    for own in (cup, rotated(cup, TILT)):
        _, (found,) = common_revolutions([own])
        assert found.section.area == pytest.approx(2.0 * (0.9 * 1.5 - 0.8 * 1.4), rel=1e-6)


def test_the_axis_may_have_any_direction():
    frame, found = common_revolutions([rotated(CONE, TILT), rotated(CUP, TILT)])
    assert abs(frame[1] @ Rotation.from_rotvec(TILT).apply([0.0, 0.0, 1.0])) == pytest.approx(1.0)
    # The plane of the section may meet sides, not edges.
    assert found[0].section.area == pytest.approx(2.0, rel=0.005)


def test_a_ball_has_the_axis_of_the_other_shape():
    frame, _ = common_revolutions([ball(), rotated(CUP, (0.5 * np.pi, 0.0, 0.0))])
    assert np.abs(frame[1]) == pytest.approx([0.0, 1.0, 0.0], abs=1e-6)


def test_rings_have_two_regions():
    _, (ring,) = common_revolutions([torus()])
    assert ring.section.area == pytest.approx(2.0 * np.pi * 0.35**2, rel=0.02)


def test_rounding_does_not_divide_sections():
    """Vertices at the poles of Blender's meshes, which are rounded to single precision, lie beside the axis."""
    rng = np.random.default_rng(1)
    pear = revolved([(0.0, -1.0), (1e-6, -1.0), (0.9, -0.3), (0.4, 0.9), (1e-6, 1.2), (0.0, 1.2)])
    uneven = TriangleMesh(pear.vertices + 3e-7 * rng.standard_normal(pear.vertices.shape), pear.faces)
    _, (found,) = common_revolutions([uneven])
    assert len(outline_of(found.section).regions) == 1


@pytest.mark.parametrize(
    "other",
    [
        box(),
        extruded(STAR),
        revolved(PROFILE, 5),
        TriangleMesh(OCTAGON.vertices * (1.0, 0.7, 1.0), OCTAGON.faces),
        bent_tube(1.5),
        spring(9.0),
        extruded(ellipse(radii=(1.0, 0.8))),
        joined(CUP, box((0.4, 0.1, 0.4), (1.1, 0.0, 0.8))),
        joined(tube_with_caps(), tube_with_caps().moved((3.0, 0.0, 0.0))),
        rotated(CUP, (np.radians(15.0), 0.0, 0.0)),
        TriangleMesh(CONE.vertices * (1.0, 1.0, 0.0), CONE.faces),
    ],
    ids=[
        "box",
        "star",
        "five sides",
        "flattened",
        "bent tube",
        "spring",
        "ellipse",
        "handle",
        "axes",
        "tilted",
        "flat",
    ],
)
def test_other_solids_are_not(other):
    assert common_revolutions([CUP, other]) is None


@pytest.mark.parametrize("lobes", [0, 10])
def test_some_triangles_of_dense_meshes_tell(lobes):
    """Ten lobes hardly change the volume and the section of a cone, only its normals."""
    cone = revolved(
        [(0.0, 0.0), (0.5, 0.0), (1.0, 0.0), *((1.0 - h, 2.0 * h) for h in np.linspace(0.0, 1.0, 150))], 100
    )
    assert len(cone.faces) > 28_000
    angles = np.arctan2(cone.vertices[:, 1], cone.vertices[:, 0])
    wide = 1.0 + 0.1 * np.sin(lobes * angles)
    lobed = TriangleMesh(cone.vertices * np.stack([wide, wide, np.ones_like(wide)], axis=1), cone.faces)
    found = common_revolutions([lobed])
    assert (found is None) == bool(lobes)
    if found is not None:
        assert found[1][0].section.area == pytest.approx(2.0, rel=0.01)


def test_feet_beside_the_section_are_not_lost():
    """Two small feet of a drum are not where its section is taken, and hardly change its normals and its volume."""
    drum = revolved([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    directions = Rotation.from_euler("z", [[60.0], [240.0]], degrees=True).apply([0.85, 0.0, -0.05])
    feet = [box((0.08, 0.08, 0.1), place) for place in directions]
    assert common_revolutions([joined(drum, *feet)]) is None
    assert common_revolutions([joined(drum, torus(1.5, 0.2))]) is not None
