# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangulations of filled parts of the plane."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.plane.planar_fill import filled_boundary
from convwass_addon.geometry.remeshing.planar_mesh import planar_mesh
from tests.flat_shapes import ellipse, rectangle


def test_triangles_fill_the_boundary_and_face_up():
    ring = filled_boundary([rectangle((0, 0), (3, 2)), rectangle((1, 0.5), (2, 1.5))[::-1]], "non-zero")
    mesh = planar_mesh(ring, 0.2)
    assert mesh.area == pytest.approx(5.0)
    sides = mesh.corners[:, 1:] - mesh.corners[:, :1]
    assert (np.cross(sides[:, 0], sides[:, 1])[:, 2] > 0).all()
    lengths = np.linalg.norm(mesh.corners - np.roll(mesh.corners, 1, axis=1), axis=2)
    assert lengths.max() < 0.4
    # A disk with a hole has Euler number zero: as many edges as vertices and triangles together.
    sides = np.concatenate([mesh.faces[:, pair] for pair in ([0, 1], [1, 2], [2, 0])])
    edges = np.unique(np.sort(sides), axis=0)
    assert len(mesh.vertices) - len(edges) + len(mesh.faces) == 0


def test_subdivided_boundaries_are_unchanged_and_know_their_inside():
    boundary = filled_boundary([ellipse(radii=(2, 1), corners=64)], "non-zero")
    fine = boundary.divided(0.03)
    assert np.linalg.norm(fine.ends - fine.starts, axis=1).max() <= 0.03 + 1e-12
    assert fine.area == pytest.approx(boundary.area, rel=1e-12)
    points = np.array([[0.0, 0.0], [1.9, 0.0], [2.1, 0.0], [1.5, 0.9], [0.0, -0.99]])
    assert boundary.contains(points).tolist() == [True, True, False, False, True]
