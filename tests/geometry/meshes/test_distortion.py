# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Distortion by deformations with known stretches."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.meshes.distortion import vertex_distortions
from convwass_addon.geometry.meshes.mesh import TriangleMesh

SHEET = TriangleMesh.from_arrays([(0, 0, 0), (2, 0, 0), (2, 1, 0), (0.5, 1.5, 0), (9, 9, 9)], [(0, 1, 2), (0, 2, 3)])


@pytest.mark.parametrize(("stretches", "expected"), [((1, 1), 1.0), ((3, 3), 1.0), ((2, 1), 1.25), ((1, 4), 2.125)])
def test_stretching_along_the_axes(stretches, expected):
    moved = SHEET.vertices * (*stretches, 1.0)
    np.testing.assert_allclose(vertex_distortions(SHEET, moved)[:4], expected)


def test_rotations_do_not_distort():
    turned = SHEET.vertices[:, [1, 2, 0]] + 5.0
    np.testing.assert_allclose(vertex_distortions(SHEET, turned), 1.0)


def test_flattening_a_triangle_to_a_line_is_the_largest_distortion():
    moved = SHEET.vertices * (1.0, 0.0, 1.0)
    assert (vertex_distortions(SHEET, moved)[:4] == 10.0).all()


def test_large_triangles_beside_small_ones_change_nothing():
    """A ground plane made all triangles of a figure seem to be undistorted."""
    points = np.concatenate([1e-4 * SHEET.vertices, 1e3 * SHEET.vertices])
    both = TriangleMesh.from_arrays(points, np.concatenate([SHEET.faces, SHEET.faces + 5]))
    np.testing.assert_allclose(vertex_distortions(both, points * (2.0, 1.0, 1.0))[[0, 1, 2, 3, 5, 6, 7, 8]], 1.25)
