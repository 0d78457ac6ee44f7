# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Edges are flipped where this increases angles, and nothing else changes."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.meshes.edges import topology
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.remeshing.edge_flips import with_flipped_edges
from tests.shapes import ball, smallest_angles


def kite(height=0.0):
    """Two narrow triangles at the long diagonal of a rhombus; the other diagonal lies `height` above it."""
    points = [(-1, 0, 0), (1, 0, 0), (0, 0.3, height), (0, -0.3, height)]
    return TriangleMesh.from_arrays(points, [(0, 1, 2), (1, 0, 3)])


def test_the_long_diagonal_of_a_rhombus_is_flipped():
    found = with_flipped_edges(kite(), 0.01)
    assert {frozenset(face) for face in found.faces.tolist()} == {frozenset((0, 2, 3)), frozenset((1, 2, 3))}
    assert smallest_angles(found).min() > 1.9 * smallest_angles(kite()).min()
    np.testing.assert_allclose(found.area, kite().area)
    assert (np.cross(*np.moveaxis(found.corners[:, 1:] - found.corners[:, :1], 1, 0))[:, 2] > 0).all()


def test_creases_are_kept():
    mesh = kite(height=0.1)
    assert with_flipped_edges(mesh, 0.05).faces is mesh.faces
    assert with_flipped_edges(mesh, 0.11).faces is not mesh.faces


def test_a_closed_surface_stays_closed_and_nearly_where_it_is():
    mesh = ball(points=600)
    mesh = TriangleMesh(mesh.vertices * (1.0, 1.0, 4.0), mesh.faces)
    found = with_flipped_edges(mesh, 0.02)
    assert topology(found) == topology(mesh)
    assert topology(found).closed
    assert abs(found.volume / mesh.volume - 1.0) < 2e-3
    assert (smallest_angles(found) < 20).sum() < 0.8 * (smallest_angles(mesh) < 20).sum()


def test_both_sides_of_a_thin_fin_are_not_joined():
    """Flips on its front and its back would make the same new edge between two vertices of its rim."""
    points = [(-1, 0, 0.02), (1, 0, 0.02), (0, 0.3, 0), (0, -0.3, 0), (-1, 0, -0.02), (1, 0, -0.02)]
    faces = [(0, 1, 2), (1, 0, 3), (5, 4, 2), (4, 5, 3), (2, 4, 0), (3, 0, 4), (2, 1, 5), (3, 5, 1)]
    fin = TriangleMesh.from_arrays(points, faces)
    found = with_flipped_edges(fin, 0.03)
    assert found.faces is not fin.faces
    assert topology(found) == topology(fin)
    assert found.volume == pytest.approx(fin.volume, rel=0.3)


def test_no_duplicate_edge_is_made():
    """All pairs of a tetrahedron's vertices already have an edge."""
    points = [(0, 0, 0), (1, 0, 0), (0.5, 0.9, 0), (0.5, 0.3, 0.05)]
    flat = TriangleMesh.from_arrays(points, [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)])
    np.testing.assert_array_equal(with_flipped_edges(flat, 10.0).faces, flat.faces)
