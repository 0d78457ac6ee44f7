# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the numbers of pairs are drawn."""

from __future__ import annotations

from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from mathutils import Matrix

from convwass_addon.bridge.soft_maps.pair_labels import LabeledVertex, labels_of


@pytest.fixture
def cube():
    bpy.ops.mesh.primitive_cube_add(location=(1, 0, 0))
    return bpy.context.object


def points(*vertices):
    depsgraph = bpy.context.evaluated_depsgraph_get()
    return [np.array(label.point) for label in labels_of(vertices, depsgraph)]


def test_labels_are_where_modifiers_put_the_vertices(cube):
    plain = np.array(cube.matrix_world @ cube.data.vertices[0].co)
    np.testing.assert_allclose(points(LabeledVertex(cube, 0, 1))[0], plain)
    cube.modifiers.new("Displace", "DISPLACE").strength = 0.5
    (moved,) = points(LabeledVertex(cube, 0, 1))
    assert np.linalg.norm(moved - plain) == pytest.approx(0.25, abs=1e-3)


def test_modifiers_that_change_vertices_are_ignored(cube):
    cube.modifiers.new("Subdivision", "SUBSURF")
    plain = np.array(cube.matrix_world @ cube.data.vertices[0].co)
    np.testing.assert_allclose(points(LabeledVertex(cube, 0, 1))[0], plain)


def test_in_edit_mode_they_follow_the_edits(cube):
    import bmesh

    bpy.ops.object.mode_set(mode="EDIT")
    edited = bmesh.from_edit_mesh(cube.data)
    edited.verts.ensure_lookup_table()
    edited.verts[0].co = (9, 9, 9)
    np.testing.assert_allclose(points(LabeledVertex(cube, 0, 1))[0], (10, 9, 9))
    bmesh.ops.delete(edited, geom=edited.verts[4:], context="VERTS")
    assert points(LabeledVertex(cube, 6, 1)) == []


def test_missing_vertices_have_no_label(cube):
    assert points(LabeledVertex(cube, 8, 1), LabeledVertex(cube, -1, 2)) == []
    cube.hide_set(True)
    assert points(LabeledVertex(cube, 0, 1)) == []


def test_labels_on_the_far_side_are_marked(cube):
    """Seen from above, in perspective and without."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    from_above = Matrix.Translation((1, 0, 10)).inverted()
    labels = labels_of([LabeledVertex(cube, number, number) for number in range(8)], depsgraph)
    for is_perspective in (True, False):
        view = SimpleNamespace(view_matrix=from_above, is_perspective=is_perspective)
        near = {label.number for label in labels if label.faces(view)}
        assert near == {vertex.index for vertex in cube.data.vertices if vertex.co.z > 0}
