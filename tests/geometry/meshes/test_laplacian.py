# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import sys
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.sparse import csc_matrix, diags_array, eye_array
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import eigsh
from scipy.spatial import Delaunay

from convwass_addon.errors import InputError
from convwass_addon.geometry.algebra.factorization import factorize
from convwass_addon.geometry.meshes.edges import vertex_components
from convwass_addon.geometry.meshes.laplacian import cotangent_laplacian, laplacian, tufted_laplacian
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from tests.shapes import ball, box, joined, square, torus

FINS = TriangleMesh.from_arrays(
    [(1, 0, 0), (0, 1, 0), (0.4, 0.5, 1), (0.5, 0.5, -0.7), (-0.2, -0.3, 0), (1.2, 1, 0.3)],
    [(0, 1, 2), (1, 0, 3), (0, 1, 4), (0, 1, 5)],
)
"""Four triangles on one edge."""

LINE = TriangleMesh.from_arrays(np.outer([0.1, 0.2, 0.7, 1.3], (0.1, 0.3, 0.7)), [(0, 1, 2), (1, 2, 3)])
"""Triangles without area except for rounding errors."""


@pytest.fixture(params=["tufted", "cotangent"])
def build(request):
    if request.param == "tufted":
        pytest.importorskip("robust_laplacian")
        return tufted_laplacian
    return cotangent_laplacian


def flat(size=12, seed=0):
    """A tilted flat sheet of Delaunay triangles, acute along its boundary; and the mask of inner vertices."""
    grid = np.stack(np.meshgrid(np.arange(size), np.arange(size), indexing="ij"), -1).reshape(-1, 2).astype(float)
    inside = ((grid > 0) & (grid < size - 1)).all(axis=1)
    grid[inside] += np.random.default_rng(seed).uniform(-0.2, 0.2, (inside.sum(), 2))
    axes = np.linalg.qr(np.array([(1.0, 2.0), (0.5, -1.0), (3.0, 0.2)]))[0]
    return TriangleMesh.from_arrays(grid @ axes.T + (3, 1, 2), Delaunay(grid).simplices), inside


def stretched(mesh, factor):
    return TriangleMesh(mesh.vertices * (1, 1, factor), mesh.faces)


def assert_sound(found, mesh):
    """Check the properties that every Laplacian has for any mesh."""
    matrix = found.matrix.tocoo()
    assert np.isfinite(matrix.data).all()
    assert np.isfinite(found.areas).all()
    assert (found.matrix != found.matrix.T).nnz == 0
    rows, columns = matrix.coords
    assert (matrix.data[rows != columns] < 0).all()
    assert (matrix.data[rows == columns] > 0).all()
    scale = max(1.0, matrix.data.max())
    np.testing.assert_allclose(matrix.sum(axis=1), 0, atol=1e-13 * scale)
    a, b, c = mesh.faces.T
    used = np.unique(mesh.faces[(a != b) & (b != c) & (c != a)])
    np.testing.assert_array_equal(np.flatnonzero(found.areas), used)
    assert found.areas.min() >= 0
    np.testing.assert_array_equal(np.unique(rows), used)


@pytest.mark.parametrize("lengths", [(1.0, 1.0, 1.0), (3.0, 4.0, 4.5), (2.0, 2.9, 3.0)])
def test_an_acute_triangle_by_hand(build, lengths):
    a, b, c = lengths  # opposite the corners 0, 1 and 2
    angles = [np.arccos((v * v + w * w - u * u) / (2 * v * w)) for u, v, w in ((a, b, c), (b, c, a), (c, a, b))]
    corners = [(0, 0, 0), (c, 0, 0), (b * np.cos(angles[0]), b * np.sin(angles[0]), 0)]
    found = build(TriangleMesh.from_arrays(corners, [(0, 1, 2)]))
    area = 0.5 * b * c * np.sin(angles[0])
    np.testing.assert_allclose(found.areas, area / 3, rtol=1e-12)
    weights = [0.5 / np.tan(angle) for angle in angles]
    expected = [
        (weights[1] + weights[2], -weights[2], -weights[1]),
        (-weights[2], weights[0] + weights[2], -weights[0]),
        (-weights[1], -weights[0], weights[0] + weights[1]),
    ]
    np.testing.assert_allclose(found.matrix.toarray(), expected, rtol=1e-12)
    assert found.clamped == 0


def test_the_diagonal_of_a_square_has_weight_zero(build):
    found = build(square(3.0))
    expected = [(1, -0.5, 0, -0.5), (-0.5, 1, -0.5, 0), (0, -0.5, 1, -0.5), (-0.5, 0, -0.5, 1)]
    np.testing.assert_allclose(found.matrix.toarray(), expected, atol=1e-12)
    assert found.areas.sum() == pytest.approx(9)
    assert found.clamped == 0


def test_areas_are_thirds_of_triangles():
    np.testing.assert_allclose(cotangent_laplacian(square()).areas, [1 / 3, 1 / 6, 1 / 3, 1 / 6])


def test_the_spectrum_of_a_sphere(build):
    found = build(ball(points=2000))
    values = eigsh(found.matrix, 9, M=diags_array(found.areas).tocsc(), sigma=-0.1, return_eigenvectors=False)
    np.testing.assert_allclose(np.sort(values), [0, 2, 2, 2, 6, 6, 6, 6, 6], rtol=0.01, atol=1e-9)


def test_linear_functions_are_harmonic(build):
    mesh, inside = flat()
    found = build(mesh)
    np.testing.assert_allclose((found.matrix @ mesh.vertices)[inside], 0, atol=1e-12)
    assert np.linalg.norm((found.matrix @ mesh.vertices)[~inside], axis=1).min() > 0.5  # their pull on the border


@pytest.mark.parametrize("seed", range(3))
def test_both_agree_on_a_delaunay_mesh(seed):
    pytest.importorskip("robust_laplacian")
    mesh, _ = flat(seed=seed)
    tufted, cotangent = tufted_laplacian(mesh), cotangent_laplacian(mesh)
    np.testing.assert_allclose(tufted.matrix.toarray(), cotangent.matrix.toarray(), atol=1e-12)
    np.testing.assert_allclose(tufted.areas, cotangent.areas, rtol=1e-12)
    assert (tufted.clamped, cotangent.clamped) == (0, 0)


def test_needles_keep_their_area():
    needle = TriangleMesh.from_arrays([(0, 0, 0), (1, 0, 0), (1, 2e-5, 0)], [(0, 1, 2)])
    assert cotangent_laplacian(needle).areas.sum() == pytest.approx(1e-5, rel=1e-14, abs=0)


@pytest.mark.parametrize(
    "mesh",
    [ball(points=300), torus(), box((1, 2, 3)), flat()[0], stretched(ball(), 10), stretched(ball(), 100), FINS],
    ids=["ball", "torus", "box", "flat", "stretched", "needles", "fins"],
)
def test_areas_sum_to_the_total_area(build, mesh):
    found = build(mesh)
    assert_sound(found, mesh)
    assert found.areas.sum() == pytest.approx(mesh.area, rel=1e-9)


def test_the_tufted_cover_connects_all_triangles_of_an_edge():
    pytest.importorskip("robust_laplacian")
    found = tufted_laplacian(FINS)
    assert found.clamped == 0
    # Around an edge, the cover glues each triangle to the next, so every tip has a neighbor across the edge or at its
    # ends, and heat from one tip reaches all others.
    assert connected_components(found.matrix)[0] == 1
    heat = diffused(found, 2)
    assert heat[[3, 4, 5]].min() > 0.01 * heat[2]


def diffused(found, source, time=0.2, steps=10):
    """Heat of a unit mass after several implicit Euler steps."""
    system = factorize((diags_array(found.areas) + time / steps * found.matrix).tocsc())
    heat = np.zeros((1, len(found.areas)))
    heat[0, source] = 1 / found.areas[source]
    for _ in range(steps):
        heat = system.solve(heat * found.areas)
    return heat[0]


def unclamped(mesh):
    """The unclamped cotangent stiffness, from dot products of the edges."""
    stiffness = np.zeros((len(mesh.vertices),) * 2)
    for corner in range(3):
        k, i, j = np.roll(mesh.faces, -corner, axis=1).T
        p, q = mesh.vertices[i] - mesh.vertices[k], mesh.vertices[j] - mesh.vertices[k]
        half = 0.5 * np.einsum("ij,ij->i", p, q) / np.linalg.norm(np.cross(p, q), axis=1)
        for row, column, sign in ((i, j, -1), (j, i, -1), (i, i, 1), (j, j, 1)):
            np.add.at(stiffness, (row, column), sign * half)
    return stiffness


def test_heat_is_nonnegative_on_a_stretched_sphere(build):
    mesh = stretched(ball(points=500), 10)
    found = build(mesh)
    heat = diffused(found, 250)
    assert heat.min() > 0
    assert heat @ found.areas == pytest.approx(1)
    plain = SimpleNamespace(areas=found.areas, matrix=unclamped(mesh))
    system = np.linalg.inv(np.diag(plain.areas) + 0.02 * plain.matrix)
    assert system.min() < -1e-4 * system.max()  # so the mesh is a hard case


def test_only_the_fallback_clamps():
    mesh = stretched(ball(points=500), 10)
    stiffness = unclamped(mesh)
    obtuse = np.count_nonzero(np.triu(stiffness, 1) > 1e-5)
    found = cotangent_laplacian(mesh)
    assert found.clamped == obtuse > 100
    clamped = np.minimum(stiffness, 0) * (1 - np.eye(len(stiffness)))
    np.testing.assert_allclose(found.matrix.toarray(), clamped - np.diag(clamped.sum(axis=1)), atol=1e-9)
    pytest.importorskip("robust_laplacian")
    assert tufted_laplacian(mesh).clamped == 0


@pytest.mark.parametrize("scale", [1e-70, 1e-12, 1e-3, 1e5, 1e12, 1e70])
def test_stiffness_has_no_scale_and_areas_have_its_square(build, scale):
    mesh = stretched(ball(points=200), 3)
    small, large = build(mesh), build(TriangleMesh(mesh.vertices * scale, mesh.faces))
    np.testing.assert_allclose(large.matrix.toarray(), small.matrix.toarray(), rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(large.areas, small.areas * scale**2, rtol=1e-9)


def test_far_from_the_origin(build):
    near = build(ball(points=200))
    far = build(ball(points=200).moved((1e6, -1e6, 1e6)))
    np.testing.assert_allclose(far.matrix.toarray(), near.matrix.toarray(), atol=1e-6)


def test_unused_vertices_and_degenerate_triangles_change_nothing(build):
    mesh = ball(points=100)
    vertices = np.concatenate([[(9, 9, 9)], mesh.vertices, [(7, 7, 7), (8, 8, 8)]])
    faces = np.concatenate([[(0, 0, 3), (4, 0, 4)], mesh.faces + 1, [(101, 101, 101)]])
    plain, padded = build(mesh), build(TriangleMesh.from_arrays(vertices, faces))
    np.testing.assert_allclose(padded.areas, [0, *plain.areas, 0, 0], rtol=1e-12)
    np.testing.assert_allclose(padded.matrix.toarray(), np.pad(plain.matrix.toarray(), (1, 2)), atol=1e-12)


def test_duplicate_triangles_count_twice(build):
    mesh = TriangleMesh.from_arrays(np.eye(3), [(0, 1, 2)])
    once, twice = build(mesh), build(TriangleMesh.from_arrays(np.eye(3), [(0, 1, 2), (2, 1, 0)]))
    np.testing.assert_allclose(twice.areas, 2 * once.areas, rtol=1e-12)
    np.testing.assert_allclose(twice.matrix.toarray(), 2 * once.matrix.toarray(), rtol=1e-12)


def test_collapsed_triangles_have_little_effect(build):
    mesh = torus()
    vertices = mesh.vertices.copy()
    vertices[5] = vertices[6]  # an edge of no length, two triangles without area
    collapsed = TriangleMesh(vertices, mesh.faces)
    found = build(collapsed)
    assert_sound(found, collapsed)
    assert found.areas.sum() == pytest.approx(collapsed.area, rel=1e-4)
    # The two coincident vertices act as one, because heat passes freely between them.
    assert found.matrix[5, 6] < -100


def test_heat_stays_within_its_component(build):
    one = np.array([(0.0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1)])
    tip_to_tip = TriangleMesh.from_arrays(one, [(0, 1, 2), (2, 3, 4)])
    mesh = joined(square(), tip_to_tip, ball(points=50, center=(5, 0, 0)), FINS)
    bridge = np.array([(0, 0, 4)])  # repeats a vertex, so it connects nothing
    mesh = TriangleMesh.from_arrays(np.concatenate([mesh.vertices, [(0, 0, 9)]]), np.concatenate([mesh.faces, bridge]))
    labels = vertex_components(mesh)
    np.testing.assert_array_equal(labels, [*[0] * 4, *[1] * 5, *[2] * 50, *[3] * 6, -1])
    assert labels.dtype == np.int64
    flow = connected_components(build(mesh).matrix)[1]
    for label in range(4):
        assert len(np.unique(flow[labels == label])) == 1
    assert len(np.unique(flow)) == 5  # the unused vertex is alone


def test_vertices_without_triangles_belong_to_no_component():
    empty = TriangleMesh.from_arrays(np.zeros((2, 3)), np.empty((0, 3)))
    np.testing.assert_array_equal(vertex_components(empty), [-1, -1])


@st.composite
def messy_meshes(draw):
    """Coincident points, slivers, collapsed, duplicate and nonmanifold triangles, and very different lengths."""
    count = draw(st.integers(3, 12))
    places = st.tuples(*[st.integers(-2, 2)] * 3)
    vertices = np.array(draw(st.lists(places, min_size=count, max_size=count)), dtype=float)
    exponents = st.sampled_from([0, 0, 0, -3, -9, -15, -16])
    vertices *= 10.0 ** np.array(draw(st.lists(exponents, min_size=3, max_size=3)))
    vertices *= 10.0 ** np.array(draw(st.lists(exponents, min_size=count, max_size=count)))[:, None]
    vertices += draw(st.sampled_from([0.0, 1e-3, 1e3]))
    corner = st.integers(0, count - 1)
    faces = draw(st.lists(st.tuples(corner, corner, corner), min_size=1, max_size=25))
    return TriangleMesh.from_arrays(vertices * 10.0 ** draw(st.integers(-12, 12)), faces)


@pytest.mark.parametrize("build", [laplacian, cotangent_laplacian])
@given(mesh=messy_meshes())
def test_any_mesh_gives_a_valid_laplacian_or_an_error(build, mesh):
    try:
        found = build(mesh)
    except InputError as error:
        assert "no area" in str(error) or "three different" in str(error)
        assert mesh.area <= 1e-12 * np.ptp(mesh.vertices, axis=0).max() * np.abs(mesh.vertices).max()
    else:
        assert_sound(found, mesh)


@pytest.mark.parametrize(
    ("mesh", "message"),
    [
        (TriangleMesh.from_arrays(np.eye(3), np.empty((0, 3))), "three different"),
        (TriangleMesh.from_arrays(np.eye(3), [(0, 1, 1)]), "three different"),
        (TriangleMesh.from_arrays(np.full((4, 3), 0.3), [(0, 1, 2), (1, 2, 3)]), "no area"),
        (LINE, "no area"),
        (LINE.moved((1e6, 1e7 / 3, -1e7 / 7)), "no area"),
        (TriangleMesh.from_arrays(np.eye(3) * 1e200, [(0, 1, 2)]), "too large"),
        (TriangleMesh.from_arrays(np.eye(3) * 1e-200, [(0, 1, 2)]), "too small"),
    ],
    ids=["none", "improper", "points", "line", "rounded line", "large", "small"],
)
@pytest.mark.parametrize("build", [laplacian, cotangent_laplacian])
def test_meshes_that_cannot_carry_heat_are_refused(build, mesh, message):
    with pytest.raises(InputError, match=message):
        build(mesh)


def test_tufted_is_used_if_available(monkeypatch):
    monkeypatch.setitem(sys.modules, "robust_laplacian", None)
    assert laplacian(FINS).method == "cotangent"
    with pytest.raises(ImportError):
        tufted_laplacian(FINS)
    assert laplacian(ball(points=50)).method == "tufted"
    monkeypatch.undo()
    pytest.importorskip("robust_laplacian")
    assert laplacian(FINS).method == "tufted"


def failing(*_, **__):
    raise RuntimeError("assertion failed")


def without_numbers(vertices, faces, mollify_factor):
    return csc_matrix(eye_array(len(vertices)) * np.nan), csc_matrix(eye_array(len(vertices)))


def without_area(vertices, faces, mollify_factor):
    return csc_matrix(eye_array(len(vertices))), csc_matrix((len(vertices),) * 2)


@pytest.mark.parametrize("broken", [failing, without_numbers, without_area])
def test_the_cotangent_laplacian_is_the_fallback(monkeypatch, broken):
    monkeypatch.setitem(sys.modules, "robust_laplacian", SimpleNamespace(mesh_laplacian=broken))
    with pytest.raises(ArithmeticError, match="robust_laplacian"):
        tufted_laplacian(FINS)
    found = laplacian(FINS)
    assert found.method == "cotangent"
    assert_sound(found, FINS)
