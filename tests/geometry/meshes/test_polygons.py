# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np

from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.meshes.polygons import Polygons

CORNERS = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)], float)
# A cube whose first five faces are pairs with a common first diagonal; the last pair has another diagonal.
FACES = np.array(
    [
        [(0, 1, 2), (0, 2, 3)],
        [(4, 7, 6), (4, 6, 5)],
        [(0, 4, 5), (0, 5, 1)],
        [(1, 5, 6), (1, 6, 2)],
        [(2, 6, 7), (2, 7, 3)],
        [(3, 7, 4), (0, 3, 4)],
    ]
).reshape(-1, 3)


def listed(polygons):
    return [tuple(face) for face in np.split(polygons.corners, polygons.starts[1:])]


def test_triangles_are_unchanged():
    assert listed(Polygons.of_triangles(FACES)) == [tuple(face) for face in FACES]


def test_pairs_become_quads_and_others_only_if_well_shaped():
    mesh = TriangleMesh.from_arrays(CORNERS, FACES)
    expected = [(0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3)]
    found = listed(Polygons.of_quads(mesh))
    assert found[:5] == expected
    assert sorted(found[5]) == [0, 3, 4, 7]
    assert listed(Polygons.of_quads(TriangleMesh(mesh.vertices, FACES[:3]))) == [(0, 1, 2, 3), (4, 7, 6)]
    # If pairs do not begin at even rows, only the shape counts.
    odd = Polygons.of_quads(TriangleMesh(mesh.vertices, FACES[1:]))
    assert {tuple(sorted(face)) for face in listed(odd)[:5]} == {tuple(sorted(face)) for face in found[1:6]}
    assert listed(odd)[5] == (0, 2, 3)


def test_edges_are_sorted_and_known_to_their_corners():
    """A cube of quads and two triangles has twelve edges and a diagonal."""
    polygons = Polygons.of_quads(TriangleMesh(CORNERS, np.concatenate([FACES[:10], FACES[10:][::-1]])))
    cut = Polygons(np.append(polygons.corners[:20], FACES[10:].ravel()), np.array([0, 4, 8, 12, 16, 20, 23]), None)
    edges = cut.edges
    assert len(edges.vertices) == 13 and (edges.vertices[:, 0] < edges.vertices[:, 1]).all()
    assert (np.diff(edges.vertices[:, 0] * 8 + edges.vertices[:, 1]) > 0).all()
    for face, own in zip(listed(cut), np.split(edges.of_corners, cut.starts[1:]), strict=True):
        ends = [tuple(sorted(pair)) for pair in zip(face, (*face[1:], face[0]), strict=True)]
        assert [tuple(edges.vertices[edge]) for edge in own] == ends
    assert (np.bincount(edges.of_corners) == 2).all()


def test_neither_bent_nor_skewed_triangles_are_joined():
    bent = TriangleMesh.from_arrays([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0.2, 0.8, 0.9)], [(0, 1, 2), (2, 3, 0)])
    skewed = TriangleMesh.from_arrays([(0, 0, 0), (1, 0, 0), (5, 1, 0), (4, 1, 0)], [(0, 1, 2), (2, 3, 0)])
    for mesh in (bent, skewed):
        assert len(Polygons.of_quads(mesh).starts) == 2


def test_most_of_a_grid_becomes_quads_without_using_triangles_twice():
    """Squares with random diagonals, in random order."""
    rng = np.random.default_rng(3)
    i, j = (index.ravel() for index in np.meshgrid(np.arange(20), np.arange(20), indexing="ij"))
    a, b, c, d = i * 21 + j, (i + 1) * 21 + j, (i + 1) * 21 + j + 1, i * 21 + j + 1
    cut = rng.random(len(a))[:, None, None] < 0.5
    faces = np.where(
        cut, np.stack([[a, b, c], [a, c, d]]).transpose(2, 0, 1), np.stack([[b, c, d], [b, d, a]]).transpose(2, 0, 1)
    )
    points = np.stack([*np.divmod(np.arange(21 * 21), 21), np.zeros(21 * 21)], axis=1) + rng.normal(0, 0.02, (441, 3))
    mesh = TriangleMesh.from_arrays(points, rng.permutation(faces.reshape(-1, 3)))
    polygons = Polygons.of_quads(mesh)
    sizes = np.diff(np.append(polygons.starts, len(polygons.corners)))
    assert (sizes == 4).sum() > 0.95 * 400
    assert sizes.sum() == 3 * 800 - 2 * (sizes == 4).sum()
    faces_of = polygons.sources // 3
    assert len(np.unique(faces_of)) == 800
    # Nearly all quads are squares of the grid; few combine halves of two squares.
    spans = np.array([np.ptp(points[list(face)], axis=0).max() for face in listed(polygons) if len(face) == 4])
    assert (spans < 1.2).mean() > 0.95


def test_no_faces_are_no_polygons():
    assert not len(Polygons.of_quads(TriangleMesh(CORNERS, np.empty((0, 3), np.int64))).starts)


def test_corners_refer_to_corners_of_triangles():
    for polygons in (Polygons.of_triangles(FACES), Polygons.of_quads(TriangleMesh.from_arrays(CORNERS, FACES))):
        np.testing.assert_array_equal(polygons.corners, FACES.ravel()[polygons.sources])
        assert len(np.unique(polygons.sources)) == len(polygons.corners)
