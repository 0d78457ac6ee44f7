# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Volumes of closed, open and overlapping shapes compared with closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.solids.solid_volume import solid_volume

from ...shapes import ball, box, joined, torus, tube_with_caps, with_faces


def turned(mesh):
    rotation = Rotation.from_euler("xyz", (0.3, 0.5, 0.9)).as_matrix()
    return TriangleMesh(mesh.vertices @ rotation.T, mesh.faces)


def without_cap(mesh, height):
    """The mesh without the faces that lie above a height."""
    return with_faces(mesh, (mesh.corners[..., 2] <= height).any(axis=1))


@pytest.mark.parametrize(
    "shape",
    [ball(), torus(), box((4, 0.03, 0.03), angles=(0.3, 0.2, 0.4)), turned(tube_with_caps())],
    ids=["ball", "ring", "rod", "tube"],
)
def test_a_closed_shape_has_exactly_its_signed_volume(shape):
    assert solid_volume(shape) == pytest.approx(shape.volume, rel=1e-12)


def test_a_tube_that_is_open_at_one_end_has_the_volume_of_the_closed_one():
    """Its signed volume would be a sixth too small."""
    tube = tube_with_caps()
    opened = turned(without_cap(tube, 1.99))
    assert opened.volume < 0.85 * tube.volume
    assert solid_volume(opened) == pytest.approx(tube.volume, rel=0.015)


def test_a_ball_with_a_hole_has_the_volume_under_the_plane_of_the_hole():
    """A cap of height h has the volume pi h² (1 - h / 3)."""
    opened = without_cap(ball(points=6000), 0.8)
    height = 1.0 - opened.bounds[1, 2]
    below = 4 * np.pi / 3 - np.pi * height**2 * (1 - height / 3)
    assert opened.volume < 0.97 * below
    assert solid_volume(opened) == pytest.approx(below, rel=0.02)


def test_overlapping_parts_count_once():
    assert solid_volume(joined(box((2, 2, 2)), box((2, 2, 2), (1, 0, 0)))) == pytest.approx(12.0, rel=0.01)


def test_volumes_scale_with_the_cube_of_the_size():
    opened = without_cap(tube_with_caps(), 1.99)
    large = TriangleMesh(100.0 * opened.vertices + 7.0, opened.faces)
    assert solid_volume(large) == pytest.approx(1e6 * solid_volume(opened), rel=1e-4)
