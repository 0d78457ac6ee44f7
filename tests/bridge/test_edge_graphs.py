# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes of edges as joints."""

from __future__ import annotations

import bmesh
import bpy
import numpy as np
import pytest

from convwass_addon.bridge.armatures.edge_graphs import edge_graph
from convwass_addon.bridge.armatures.pins import PINNED, clear_pins, pin_joints, pinned_ends, unpin_joints
from convwass_addon.bridge.armatures.rigs import is_posed, move_joints, rig_graph
from convwass_addon.errors import InputError
from tests.rigs import lines

POINTS = [(0, 0, 0), (1, 0, 0), (9, 9, 9), (1, 1, 0)]
EDGES = [(0, 1), (1, 3)]


@pytest.fixture
def path():
    """Three vertices in a row, and a loose one between their numbers."""
    return lines(POINTS, EDGES)


def test_vertices_with_edges_are_joints(path):
    path.scale = (2, 2, 2)
    bpy.context.view_layer.update()
    rig = edge_graph(path)
    assert rig.graph.names == ("0", "1", "3")
    assert rig.graph.edges.tolist() == [[0, 1], [1, 2]]
    np.testing.assert_allclose(rig.graph.positions, 2.0 * np.array(POINTS)[[0, 1, 3]])
    assert not is_posed(path)


@pytest.mark.parametrize("mode", ["OBJECT", "EDIT"])
def test_joints_and_pins_in_either_mode(path, mode):
    path.location = (0, 0, 5)
    bpy.context.view_layer.objects.active = path
    bpy.context.view_layer.update()
    bpy.ops.object.mode_set(mode=mode)
    rig = rig_graph(path)
    assert pinned_ends(path) == []
    pin_joints(path, rig, [rig.joint("0"), rig.joint("3")])
    assert pinned_ends(path) == ["0", "3"]
    assert rig_graph(path).graph.pinned.tolist() == [True, False, True]
    unpin_joints(path, rig, [0])
    assert pinned_ends(path) == ["3"]
    wanted = rig.graph.positions + np.array([(0, 0, 1), (0, 2, 0), (3, 0, 0)])
    assert move_joints(path, rig, wanted) == []
    np.testing.assert_allclose(rig_graph(path).graph.positions, wanted)
    bpy.ops.object.mode_set(mode="OBJECT")
    np.testing.assert_allclose(rig_graph(path).graph.positions, wanted)
    assert tuple(path.data.vertices[2].co) == (9, 9, 9)
    assert pinned_ends(path) == ["3"]
    clear_pins(path)
    assert pinned_ends(path) == []


def test_selected_vertices_count_in_edit_mode_alone(path):
    assert not rig_graph(path).selected.any()
    bpy.context.view_layer.objects.active = path
    bpy.ops.object.mode_set(mode="EDIT")
    edited = bmesh.from_edit_mesh(path.data)
    for vertex in edited.verts:
        vertex.select_set(vertex.index == 3)
    edited.select_flush_mode()
    assert rig_graph(path).selected.tolist() == [False, False, True]


def test_invalid_skeletons_are_refused():
    bpy.ops.mesh.primitive_cube_add()
    with pytest.raises(InputError, match="Cube has faces; a skeleton must be an armature"):
        edge_graph(bpy.context.object)
    with pytest.raises(InputError, match="Dots has no edges"):
        edge_graph(lines(POINTS, [], "Dots"))
    bpy.ops.object.empty_add()
    with pytest.raises(InputError, match="is not a mesh"):
        edge_graph(bpy.context.object)


def test_other_vertices_than_before_are_refused(path):
    rig = edge_graph(path)
    path.data.vertices.add(1)
    with pytest.raises(InputError, match="The vertices of Lines have changed since the start"):
        move_joints(path, rig, rig.graph.positions)


def test_an_attribute_of_that_name_may_be_the_users(path):
    path.data.attributes.new(PINNED, "FLOAT", "POINT")
    assert pinned_ends(path) == []
    with pytest.raises(InputError, match="An attribute named Pinned already exists"):
        pin_joints(path, rig_graph(path), [0])
