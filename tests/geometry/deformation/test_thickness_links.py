# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Links across thin parts."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.deformation.thickness_links import thickness_links
from convwass_addon.geometry.meshes.edges import mesh_edges
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.remeshing.subdivision import bendable
from tests.shapes import ball, box, extruded, joined


def plate(thickness=0.05):
    return bendable(box((2.0, 2.0, thickness)), 1500).mesh


def edge_lengths(mesh, ends):
    return np.linalg.norm(mesh.vertices[ends[:, 0]] - mesh.vertices[ends[:, 1]], axis=1)


def test_both_sides_of_a_plate_are_linked():
    mesh = plate()
    links = thickness_links(mesh)
    inner = np.flatnonzero(np.abs(mesh.vertices[:, :2]).max(axis=1) < 0.9)
    assert np.isin(inner, links.ends).all()
    heights = mesh.vertices[links.ends, 2]
    assert (heights.prod(axis=1) < 0.0).all()
    assert links.across.all()


def test_shorter_links_weigh_more():
    thin, thicker = (thickness_links(plate(thickness)).weights for thickness in (0.02, 0.08))
    assert np.median(thin) > 2.0 * np.median(thicker) > 0.0


def test_links_weigh_like_edges_between_equilateral_triangles_stretched_to_their_length():
    mesh = plate(0.1)
    links = thickness_links(mesh)
    ratios = edge_lengths(mesh, links.ends) / edge_lengths(mesh, mesh_edges(mesh.faces)).mean()
    assert ratios.min() > 0.2
    np.testing.assert_allclose(links.weights, 1.0 / np.tan(np.pi / 3.0) / ratios**2, rtol=0.01)


def test_thick_parts_have_no_links():
    assert not len(thickness_links(ball(points=500)).ends)


def test_plates_thicker_than_two_edges_have_no_links():
    mesh = plate(0.3)
    assert 2.0 < 0.3 / edge_lengths(mesh, mesh_edges(mesh.faces)).mean() < 3.0
    assert not len(thickness_links(mesh).ends)


def test_links_do_not_span_the_gap_of_a_fork():
    fork = [(-0.2, 0.0), (0.2, 0.0), (0.2, 2.0), (0.03, 2.0), (0.03, 0.5), (-0.03, 0.5), (-0.03, 2.0), (-0.2, 2.0)]
    mesh = bendable(extruded(np.array(fork), low=-0.5, high=0.5), 1500).mesh
    links = thickness_links(mesh)
    assert len(links.ends) > 400
    assert (mesh.vertices[links.ends, 0].prod(axis=1) > 0.0).all()


def test_several_discs_and_loose_vertices_have_the_links_of_each_disc():
    round_one = ball(points=1500)
    one = TriangleMesh(round_one.vertices * [1.0, 1.0, 0.05], round_one.faces)
    more = TriangleMesh(np.vstack([[[9.0, 9.0, 9.0]], one.vertices, one.vertices + 5.0]), one.faces + 1)
    both = TriangleMesh(more.vertices, np.vstack([more.faces, more.faces + len(one.vertices)]))
    ends = thickness_links(one).ends + 1
    assert len(ends) > 500
    np.testing.assert_array_equal(thickness_links(both).ends, np.vstack([ends, ends + len(one.vertices)]))


def test_parts_that_face_each_other_across_a_gap_have_no_links():
    gap = 0.05
    blocks = [bendable(box((1.0, 1.0, 1.0), (0.0, 0.0, side * (0.5 + gap / 2))), 600).mesh for side in (-1, 1)]
    assert not len(thickness_links(joined(*blocks)).ends)


def test_open_sheets_and_loose_vertices_have_no_links():
    whole = plate()
    one_side = whole.faces[(whole.vertices[whole.faces, 2] > 0.0).all(axis=1)]
    assert not len(thickness_links(TriangleMesh(whole.vertices, one_side)).ends)
    assert not len(thickness_links(TriangleMesh(whole.vertices, whole.faces[:0])).ends)


@pytest.mark.parametrize("size", [1e-3, 1e3])
def test_they_do_not_depend_on_the_size(size):
    mesh = plate()
    larger = TriangleMesh(size * mesh.vertices, mesh.faces)
    np.testing.assert_array_equal(thickness_links(larger).ends, thickness_links(mesh).ends)
    np.testing.assert_allclose(thickness_links(larger).weights, thickness_links(mesh).weights)
