# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import sys

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.spatial import Delaunay

from convwass_addon.errors import Cancelled
from convwass_addon.geometry.meshes.delaunay import closed_surface, flipped_to_delaunay
from convwass_addon.geometry.meshes.laplacian import tufted_laplacian
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.progress import Control
from tests.shapes import ball, box, torus


def side_lengths(mesh):
    """Lengths of the sides that start at every corner, (m, 3)."""
    corners = mesh.corners
    return np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)


def surface_of(mesh):
    return closed_surface(mesh.faces, side_lengths(mesh))


def sheet(seed, waves=3.0):
    """A crumpled open sheet whose triangulation ignores its shape."""
    plane = np.random.default_rng(seed).random((150, 2))
    points = np.column_stack([plane, 0.3 * np.sin(waves * plane[:, 0] * 6)])
    return TriangleMesh.from_arrays(points, Delaunay(plane).simplices)


def moebius(count=40, rows=5):
    """A Möbius strip."""
    angles, across = np.linspace(0, 2 * np.pi, count, endpoint=False), np.linspace(-0.4, 0.4, rows)
    a, b = (axis.ravel() for axis in np.meshgrid(angles, across, indexing="ij"))
    radius = 1 + b * np.cos(a / 2)
    points = np.column_stack([radius * np.cos(a), radius * np.sin(a), b * np.sin(a / 2)])
    i, j = (axis.ravel() for axis in np.meshgrid(np.arange(count), np.arange(rows - 1), indexing="ij"))
    last = i == count - 1
    here, above = i * rows + j, i * rows + j + 1
    beyond = np.where(last, rows - 1 - j, here + rows)
    beyond_above = np.where(last, rows - 2 - j, above + rows)
    faces = np.concatenate([np.stack([here, beyond, above], 1), np.stack([above, beyond, beyond_above], 1)])
    return TriangleMesh.from_arrays(points, faces)


def some_turned(mesh):
    faces = mesh.faces.copy()
    faces[::3] = faces[::3, ::-1]
    return TriangleMesh(mesh.vertices, faces)


STRETCHED = TriangleMesh(ball(points=200).vertices * (1, 1, 20), ball(points=200).faces)
HALF = TriangleMesh(STRETCHED.vertices, STRETCHED.faces[STRETCHED.corners[:, :, 2].mean(axis=1) > 0])
MESHES = {
    "ball": ball(points=200),
    "box": box(),
    "torus": torus(),
    "stretched": STRETCHED,
    "open": HALF,
    "turned": some_turned(STRETCHED),
    "open and turned": some_turned(HALF),
    "moebius": moebius(),
    "sheet": sheet(0),
}


@pytest.mark.parametrize("name", MESHES)
def test_the_laplacian_agrees_with_another_implementation(name, monkeypatch):
    """Both use the unique Delaunay triangulation of the tufted cover."""
    other = pytest.importorskip("robust_laplacian")
    used, faces = np.unique(MESHES[name].faces, return_inverse=True)
    mesh = TriangleMesh(MESHES[name].vertices[used], faces.reshape(-1, 3))
    stiffness, masses = other.mesh_laplacian(mesh.vertices, mesh.faces, mollify_factor=1e-5)
    # The other implementation must not be used by ours.
    monkeypatch.setitem(sys.modules, "robust_laplacian", None)
    own = tufted_laplacian(mesh)
    np.testing.assert_allclose(own.matrix.toarray(), stiffness.toarray(), atol=1e-5)
    np.testing.assert_allclose(own.areas, masses.diagonal(), rtol=1e-6)
    assert own.clamped == 0


@given(st.integers(0, 10_000), st.floats(0.1, 20.0))
def test_flips_keep_the_area_of_a_flat_sheet(seed, stretch):
    """No triangle is turned over: with the back side, the sheet has twice its area."""
    plane = np.random.default_rng(seed).random((40, 2))
    mesh = TriangleMesh.from_arrays(np.column_stack([plane * (1, stretch), np.zeros(40)]), Delaunay(plane).simplices)
    found = flipped_to_delaunay(surface_of(mesh))
    assert found.areas.sum() == pytest.approx(2.0 * mesh.area, rel=1e-9)
    assert (found.areas > 0).all()


def test_a_square_with_the_wrong_diagonal_is_flipped():
    """Four points of a kite, for which the short diagonal is Delaunay. Its closed double has two such edges."""
    points = [(-3, 0, 0), (0, -1, 0), (3, 0, 0), (0, 1, 0)]
    mesh = TriangleMesh.from_arrays(points, [(0, 1, 2), (0, 2, 3)])
    found = flipped_to_delaunay(surface_of(mesh))
    sides = {
        frozenset(pair) for pair in zip(found.tails, np.roll(found.tails.reshape(-1, 3), -1, 1).ravel(), strict=True)
    }
    assert frozenset({1, 3}) in sides and frozenset({0, 2}) not in sides


def test_closed_meshes_have_one_sheet_and_others_two():
    sheets = {name: surface_of(mesh).sheets for name, mesh in MESHES.items()}
    assert {name for name, count in sheets.items() if count == 1} == {"ball", "box", "torus", "stretched"}


@pytest.mark.parametrize("name", MESHES)
def test_twins_are_twins(name):
    """Twins are the two sides of an edge, with equal lengths and opposite directions."""
    surface = surface_of(MESHES[name])
    sides = np.arange(len(surface.tails))
    np.testing.assert_array_equal(surface.twins[surface.twins], sides)
    assert (surface.twins != sides).all()
    heads = np.roll(surface.tails.reshape(-1, 3), -1, axis=1).ravel()
    np.testing.assert_array_equal(surface.tails[surface.twins], heads)
    np.testing.assert_allclose(surface.lengths[surface.twins], surface.lengths)


def test_meshes_with_nonmanifold_edges_give_no_surface():
    points = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1)]
    mesh = TriangleMesh.from_arrays(points, [(0, 1, 2), (0, 1, 3), (0, 1, 4)])
    assert surface_of(mesh) is None


def test_flips_can_be_cancelled():
    stop = Control()
    stop.cancel()
    with pytest.raises(Cancelled):
        flipped_to_delaunay(surface_of(STRETCHED), stop)
    with pytest.raises(Cancelled):
        tufted_laplacian(STRETCHED, stop)


def test_corners_on_a_line_give_no_triangulation():
    """Rounding may make one side longer than the other two together."""
    long = np.nextafter(2.0, 3.0)
    lengths = np.array([[1.0, 1.0, long], [1.0, 1.5, 1.0], [1.0, 1.5, 1.0], [long, 1.5, 1.5]])
    faces = np.array([[0, 1, 2], [0, 3, 1], [1, 3, 2], [0, 2, 3]])
    assert flipped_to_delaunay(closed_surface(faces, lengths)) is None
