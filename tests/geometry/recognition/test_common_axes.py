# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Plane faces of shapes; axes are tested where extrusions and solids of revolution are recognized."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.meshes.normals import triangle_normals
from convwass_addon.geometry.recognition.common_axes import face_directions, plane_share
from convwass_addon.geometry.remeshing.subdivision import with_short_edges
from tests.shapes import ball, box, joined, rotated, torus, tube_with_caps

TABLE = joined(box((2.0, 1.2, 0.1)), *(box((0.1, 0.1, 1.0), (x, y, -0.5)) for x in (-0.9, 0.9) for y in (-0.5, 0.5)))
TILT = np.array([0.5, 1.0, -0.25])


@pytest.mark.parametrize(
    ("shape", "share"),
    [
        (box(), 1.0),
        (rotated(TABLE, TILT), 1.0),
        (with_short_edges(TABLE, 0.1, 10_000).mesh, 1.0),
        (ball(), 0.0),
        (torus(), 0.0),
        # Only the caps are plane, r / (r + h) of the surface.
        (tube_with_caps(0.7, 4.0), 0.7 / 4.7),
    ],
    ids=["box", "table", "divided", "ball", "torus", "tube"],
)
def test_the_share_of_plane_faces(shape, share):
    assert plane_share(shape) == pytest.approx(share, abs=2e-3)


def test_opposite_faces_have_one_direction():
    shape = box((1.0, 2.0, 3.0))
    directions, areas = face_directions(triangle_normals(shape.corners), shape.face_areas, 6)
    assert np.abs(directions) == pytest.approx(np.eye(3)[[0, 1, 2]])
    assert areas == pytest.approx([12.0, 6.0, 4.0])
    assert len(face_directions(triangle_normals(shape.corners), shape.face_areas, 2)[0]) == 2
