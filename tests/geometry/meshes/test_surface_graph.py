# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shortest paths along edges and across pairs of triangles."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.meshes.surface_graph import surface_distances, surface_graph
from tests.grids import sheet
from tests.shapes import ball, joined


def two_triangles(tip):
    """Two triangles that share the edge from (0, 0) to (1, 0), folded along it by a right angle."""
    return TriangleMesh.from_arrays([(0, 0, 0), (1, 0, 0), (0.5, 1, 0), (tip, 0, -2)], [(0, 1, 2), (1, 0, 3)])


def test_a_line_across_a_fold_is_as_long_as_when_it_is_flat():
    assert surface_graph(two_triangles(0.3))[2, 3] == pytest.approx(np.hypot(0.2, 3.0))


def test_no_line_leaves_its_triangles():
    assert surface_graph(two_triangles(4.0))[2, 3] == 0


def test_the_graph_is_symmetric_and_contains_all_edges():
    graph = surface_graph(ball(points=80))
    assert (graph != graph.T).nnz == 0
    # A closed genus-0 mesh of n vertices has 3 n - 6 edges, and at most as many lines across them.
    assert 2 * (3 * 80 - 6) < graph.nnz <= 4 * (3 * 80 - 6)


def test_paths_on_a_sheet_are_slightly_longer_than_straight_lines():
    mesh = sheet(21, 21)
    found = surface_distances(surface_graph(mesh), [0, 47])
    straight = np.linalg.norm(mesh.vertices[[0, 47]][:, None] - mesh.vertices, axis=2)
    assert (found >= straight - 1e-12).all()
    assert (found <= 1.09 * straight + 1e-12).all()


def test_paths_on_a_sphere_follow_great_circles():
    mesh = ball(points=900)
    found = surface_distances(surface_graph(mesh), [3])[0]
    exact = np.arccos(np.clip(mesh.vertices @ mesh.vertices[3], -1.0, 1.0))
    far = exact > 0.3
    ratio = found[far] / exact[far]
    assert ratio.min() > 0.98
    assert ratio.max() < 1.08
    assert ratio.mean() < 1.04


def test_other_components_and_vertices_beyond_the_limit_are_infinitely_far():
    graph = surface_graph(joined(ball(points=60), ball(points=60, center=(3, 0, 0))))
    found = surface_distances(graph, [0])[0]
    assert np.isfinite(found[:60]).all()
    assert np.isinf(found[60:]).all()
    near = surface_distances(graph, [0], limit=1.0)[0]
    np.testing.assert_array_equal(near[found <= 1.0], found[found <= 1.0])
    assert np.isinf(near[found > 1.0]).all()


def test_no_sources_give_no_distances():
    assert surface_distances(surface_graph(ball(points=30)), []).shape == (0, 30)


def test_coincident_vertices_and_duplicate_triangles_are_tolerated():
    mesh = TriangleMesh.from_arrays(
        [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 1, 0)], [(0, 1, 2), (0, 1, 2), (0, 2, 3), (1, 1, 2)]
    )
    found = surface_distances(surface_graph(mesh), [0])[0]
    np.testing.assert_allclose(found, [0, 1, 1, 1])
