# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How far the inside of a shape moves, for motions with known distances."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.deformation.travel import travel
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.plane.plane_angles import rotated

SHEET = TriangleMesh.from_arrays([(0, 0, 0), (2, 0, 0), (2, 1, 0), (0.5, 1.5, 0)], [(0, 1, 2), (0, 2, 3)])
FLAT = SHEET.vertices[:, :2]


@pytest.mark.parametrize("angle", [0.0, 0.7, -2.0, np.pi])
def test_a_turn_moves_points_by_its_chord_wherever_the_shape_is_and_however_large(angle):
    moved = 3.0 * rotated(FLAT, angle) + (5.0, -1.0)
    assert travel(SHEET, moved) == pytest.approx(abs(2.0 * np.sin(0.5 * angle)), abs=1e-9)
    assert travel(SHEET, moved, angle) == pytest.approx(0.0, abs=1e-9)


def test_points_count_by_the_area_around_them():
    """The middle of a square has a third of it, and moves far; the corners have the rest."""
    points = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0), (0, 0, 0)])
    square = TriangleMesh.from_arrays(points, [(0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)])
    moved = points[:, :2] + np.eye(5)[4][:, None] * (np.sqrt(18.0), 0.0)
    assert travel(square, moved) == pytest.approx(1.0)
