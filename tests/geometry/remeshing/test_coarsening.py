# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from convwass_addon.geometry.meshes.edges import topology, vertex_components
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.remeshing.coarsening import coarsened
from tests.shapes import ball, joined, piece_count, torus, with_faces
from tests.transport.sheets import sheet_mesh
from tests.transport.tubes import bent_tube


def open_ball():
    mesh = ball(points=3000)
    return with_faces(mesh, mesh.corners[:, :, 2].min(axis=1) > -0.6)


def fins():
    """Three sheets that meet along one edge line."""
    flat = sheet_mesh(20, 30)
    turned = [flat.vertices @ np.array([[c, 0, s], [0, 1, 0], [0, 0, 0]]) for c, s in ((1, 0), (-1, 1), (-1, -1))]
    mesh = joined(*(TriangleMesh.from_arrays(vertices, flat.faces) for vertices in turned))
    unique, index = np.unique(np.round(mesh.vertices, 6), axis=0, return_inverse=True)
    return TriangleMesh.from_arrays(unique, index.reshape(-1)[mesh.faces])


def loose_ends():
    """A ball with unused vertices, triangles that repeat a vertex, and a duplicate triangle."""
    mesh = ball(points=2000)
    faces = np.concatenate([mesh.faces + 1, mesh.faces[:1] + 1, [(5, 5, 6), (0, 0, 7)]])
    return TriangleMesh.from_arrays(np.concatenate([[(9, 9, 9)], mesh.vertices, [(7, 7, 7)]]), faces)


MESHES = {
    "ball": ball(points=3000),
    "torus": torus(segments=(80, 40)),
    "thin torus": torus(minor=0.03, segments=(400, 12)),
    "tube": bent_tube(300, 16),
    "open": open_ball(),
    "sheet": sheet_mesh(60, 40),
    "ribbon": sheet_mesh(600, 4),
    "strip": sheet_mesh(1000, 1),
    "fins": fins(),
    "loose ends": loose_ends(),
    "pieces": joined(ball(points=2000), torus(center=(4, 0, 0), segments=(60, 30)), ball(0.01, (0, 9, 0), 40)),
    "turned over": ball(points=3000).flipped(),
}
COUNT = 300


@pytest.fixture(params=MESHES)
def mesh(request):
    return MESHES[request.param]


@pytest.fixture
def found(mesh):
    return coarsened(mesh, mesh.vertex_areas, COUNT)


def used_by(mesh):
    a, b, c = mesh.faces.T
    proper = mesh.faces[(a != b) & (b != c) & (c != a)]
    return np.isin(np.arange(len(mesh.vertices)), proper)


def test_the_topology_is_kept(mesh, found):
    """Components, handles and holes; closed meshes stay closed and consistently oriented."""
    fine, coarse = topology(with_faces(mesh, unrepeated(mesh))), topology(found.mesh)
    assert (piece_count(found.mesh), coarse.euler) == (piece_count(mesh), fine.euler)
    assert (coarse.open_edges > 0) == (fine.open_edges > 0)
    assert (coarse.uneven_edges > 0) == (fine.uneven_edges > 0)
    assert len(np.unique(found.mesh.faces)) == len(found.mesh.vertices) < 0.5 * len(mesh.vertices)


def unrepeated(mesh):
    a, b, c = mesh.faces.T
    first = np.zeros(len(mesh.faces), bool)
    first[np.unique(np.sort(mesh.faces, axis=1), axis=0, return_index=True)[1]] = True
    return first & (a != b) & (b != c) & (c != a)


def test_its_vertices_are_a_subset_of_the_original_ones(mesh, found):
    np.testing.assert_array_equal(found.mesh.vertices, mesh.vertices[found.seeds])
    np.testing.assert_array_equal(found.clusters[found.seeds], np.arange(len(found.seeds)))
    labels = vertex_components(mesh)
    used = found.clusters >= 0
    np.testing.assert_array_equal(used, used_by(mesh))
    np.testing.assert_array_equal(labels[used], labels[found.seeds[found.clusters[used]]])


def test_clusters_are_connected(mesh, found):
    """Along edges of the mesh, not through the air."""
    faces = mesh.faces[unrepeated(mesh)]
    ends = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    inner = ends[found.clusters[ends[:, 0]] == found.clusters[ends[:, 1]]]
    size = len(mesh.vertices)
    parts = connected_components(coo_array((np.ones(len(inner)), inner.T), shape=(size, size)), directed=False)[0]
    assert parts - (found.clusters < 0).sum() == len(found.seeds)


def test_prolongation_interpolates(mesh, found):
    matrix, used = found.prolongation, found.clusters >= 0
    np.testing.assert_allclose(matrix.sum(axis=1)[used], 1.0, rtol=1e-12)
    assert (matrix.sum(axis=1)[~used] == 0).all()
    assert matrix.data.min() >= 0
    assert np.diff(matrix.indptr).max() <= 3
    values = np.random.default_rng(0).normal(size=len(found.seeds))
    np.testing.assert_allclose((matrix @ values)[found.seeds], values, atol=1e-12)


def test_interpolated_positions_are_near_the_original_ones(mesh, found):
    """Within the size of a triangle, and on average within a fraction of it."""
    used = found.clusters >= 0
    off = np.linalg.norm(found.prolongation @ found.mesh.vertices - mesh.vertices, axis=1)[used]
    labels = vertex_components(found.mesh)[found.clusters[used]]
    for piece in range(labels.max() + 1):
        corners = found.mesh.corners[vertex_components(found.mesh)[found.mesh.faces[:, 0]] == piece]
        edge = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).mean()
        assert off[labels == piece].max() < edge
        assert off[labels == piece].mean() < 0.25 * edge


def test_values_come_from_triangles_around_the_vertexs_own_seed(mesh, found):
    """No part of a surface takes values from another part across the air."""
    around = [set() for _ in found.seeds]
    for face in found.mesh.faces.tolist():
        for corner in face:
            around[corner].update(face)
    rows = np.repeat(np.arange(len(mesh.vertices)), np.diff(found.prolongation.indptr))
    own = found.clusters[rows].tolist()
    assert all(
        column in around[cluster] for cluster, column in zip(own, found.prolongation.indices.tolist(), strict=True)
    )


def test_masses_are_kept(mesh, found):
    masses = np.random.default_rng(1).random((2, len(mesh.vertices))) * used_by(mesh)
    sums = found.sums(masses)
    assert sums.shape == (2, len(found.seeds))
    np.testing.assert_allclose(sums.sum(axis=1), masses.sum(axis=1), rtol=1e-12)
    np.testing.assert_allclose(sums[0, 7], masses[0, found.clusters == 7].sum(), rtol=1e-12)


@pytest.mark.parametrize("name", ["ball", "torus", "sheet"])
def test_clusters_have_similar_areas(name):
    mesh = MESHES[name]
    found = coarsened(mesh, mesh.vertex_areas, COUNT)
    assert len(found.seeds) == pytest.approx(COUNT, rel=0.02)
    areas = found.sums(mesh.vertex_areas[None])[0]
    assert areas.std() < 0.35 * areas.mean()
    assert areas.max() < 3 * areas.mean()


def test_small_components_and_thin_parts_keep_enough_vertices():
    """A hundred thousandth of the area keeps more than a dozen, and every cross-section of a leg at least three."""
    pieces = MESHES["pieces"]
    found = coarsened(pieces, pieces.vertex_areas, COUNT)
    assert (np.bincount(vertex_components(found.mesh)) > 12).all()
    thin = MESHES["thin torus"]
    found = coarsened(thin, thin.vertex_areas, 60)
    assert len(found.seeds) > 90
    assert topology(found.mesh).euler == 0


def test_the_result_is_deterministic():
    mesh = MESHES["torus"]
    one, other = (coarsened(mesh, mesh.vertex_areas, COUNT) for _ in range(2))
    np.testing.assert_array_equal(one.seeds, other.seeds)
    np.testing.assert_array_equal(one.mesh.faces, other.mesh.faces)
    np.testing.assert_array_equal(one.prolongation.toarray(), other.prolongation.toarray())


@pytest.mark.parametrize(
    "mesh",
    [
        TriangleMesh.from_arrays(np.eye(3), [(0, 1, 2)]),
        TriangleMesh.from_arrays(np.eye(3), np.zeros((0, 3), int)),
        TriangleMesh.from_arrays(np.eye(3), [(0, 0, 1)]),
        ball(points=30),
        joined(*(ball(center=(3.0 * k, 0, 0), points=20) for k in range(20))),
    ],
    ids=["triangle", "no faces", "degenerate", "tiny", "crumbs"],
)
def test_small_meshes_have_no_coarser_mesh(mesh):
    assert coarsened(mesh, mesh.vertex_areas, 10) is None


def test_vertices_can_be_kept():
    mesh = torus(segments=(60, 40))
    areas = np.full(len(mesh.vertices), 1.0)
    kept = np.array([7, 8, 1200, 2399])
    found = coarsened(mesh, areas, 200, kept)
    assert np.isin(kept, found.seeds).all()
    assert len(found.seeds) < 260
    np.testing.assert_array_equal(found.mesh.vertices, mesh.vertices[found.seeds])
    assert topology(found.mesh).euler == 0
    # Prolongation maps a kept vertex to itself.
    places = [int(np.flatnonzero(found.seeds == vertex)[0]) for vertex in kept]
    np.testing.assert_allclose(found.prolongation[kept][:, places].toarray(), np.eye(4), atol=1e-12)


def test_clusters_without_area_have_a_center():
    """Solid text may have collinear triangles that share no edge with others."""
    mesh = ball(points=2000)
    needle = TriangleMesh.from_arrays(3.0 + np.outer(np.arange(4.0), (1.0, 0.0, 0.0)), [(0, 1, 2), (1, 2, 3)])
    whole = joined(mesh, needle)
    found = coarsened(whole, whole.vertex_areas, 200)
    assert found is None or np.isin(found.seeds, np.arange(len(whole.vertices))).all()
