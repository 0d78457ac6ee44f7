# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Choices by index in nested node groups."""

from __future__ import annotations

import bpy
import numpy as np
import pytest

from convwass_addon.bridge.files.mesh_sequences import mesh_sequences
from convwass_addon.bridge.nodes import index_switch as module
from convwass_addon.bridge.nodes.index_switch import chosen, index_switch
from convwass_addon.bridge.nodes.node_math import new_node
from convwass_addon.bridge.nodes.node_trees import node_trees
from convwass_addon.bridge.sequence import frame_group, object_info, table_object


def point(height):
    """An object with one vertex at a height."""
    mesh = bpy.data.meshes.new("Point")
    mesh.from_pydata([(0.0, 0.0, height)], [], [])
    return bpy.data.objects.new("Point", mesh)


def shown(obj):
    bpy.context.view_layer.update()
    mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    return [vertex.co.z for vertex in mesh.vertices]


@pytest.mark.parametrize("count", [1, 3, 4, 9, 10, 28])
def test_each_index_returns_its_choice(monkeypatch, count):
    monkeypatch.setattr(module, "_MOST", 3)
    heights = np.arange(float(count))
    points = [point(height) for height in heights]
    group = index_switch(
        "Points", {"Geometry": "GEOMETRY"}, points, lambda tree, obj: [object_info(tree, obj).outputs["Geometry"]]
    )
    tree = frame_group("Test")
    index = new_node(tree, "FunctionNodeInputInt")
    new_node(tree, "NodeGroupOutput", {"Geometry": chosen(tree, group, index.outputs["Integer"])["Geometry"]})
    obj = table_object("Test", [(0.0, 0.0, 0.0)], tree)
    bpy.context.scene.collection.objects.link(obj)
    found = []
    for place in range(count):
        index.integer = place
        found += shown(obj)
    np.testing.assert_array_equal(found, heights)


def test_no_tree_grows_with_the_number_of_choices():
    points = [point(0.0) for _ in range(200)]
    with mesh_sequences({"Points": [(obj,) for obj in points]}, 1) as (obj,):
        trees = node_trees(obj.modifiers[0].node_group)
        assert max(len(tree.nodes) for tree in trees) < 100
    assert not bpy.data.node_groups


def test_a_frame_may_show_nothing_or_several_objects():
    low, high = point(1.0), point(2.0)
    with mesh_sequences({"Points": [(low,), (), (low, high)]}, 1) as (obj,):
        found = []
        for frame in (1, 2, 3):
            bpy.context.scene.frame_set(frame)
            found.append(shown(obj))
    assert found == [[1.0], [], [2.0, 1.0]]
