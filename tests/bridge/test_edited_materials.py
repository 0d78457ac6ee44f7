# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether edits of materials are noticed, for all nodes that Blender has."""

from __future__ import annotations

import bpy
import pytest

from convwass_addon.bridge.edited_materials import is_edited, remember_made
from convwass_addon.bridge.nodes.node_trees import own_tree


def new_material(name="Made"):
    material = bpy.data.materials.new(name)
    own_tree(material)
    return material


def node_kinds(tree):
    """Return the types of nodes that a tree can have."""
    kinds = []
    for kind in sorted(dir(bpy.types)):
        try:
            node = tree.nodes.new(kind)
        except (RuntimeError, TypeError):
            continue
        tree.nodes.remove(node)
        kinds.append(kind)
    return kinds


@pytest.mark.parametrize("in_group", [False, True])
def test_every_type_of_node_can_be_compared(in_group):
    material = new_material()
    tree = material.node_tree
    if in_group:
        group = tree.nodes.new("ShaderNodeGroup")
        group.node_tree = tree = bpy.data.node_groups.new("Group", "ShaderNodeTree")
    kinds = node_kinds(tree)
    assert len(kinds) > 80
    for kind in kinds:
        node = tree.nodes.new(kind)
        remember_made(material)
        assert not is_edited(material), kind
        tree.nodes.remove(node)
        assert is_edited(material), kind


def test_paired_nodes_of_zones_can_be_compared():
    material = new_material()
    nodes, kinds = material.node_tree.nodes, node_kinds(material.node_tree)
    starts = [kind for kind in kinds if hasattr(nodes.new(kind), "pair_with_output")]
    if not starts:
        pytest.skip("this Blender has no zones in materials")
    for kind in starts:
        start, end, other = (nodes.new(own) for own in (kind, *[kind.replace("Input", "Output")] * 2))
        assert start.pair_with_output(end)
        remember_made(material)
        assert not is_edited(material), kind
        # Its nodes are the same, but another one ends it.
        assert start.pair_with_output(other)
        assert is_edited(material), kind


@pytest.mark.parametrize("has_file", [False, True])
def test_an_image_is_told_by_its_file_not_by_its_name(has_file):
    material = new_material()
    node = material.node_tree.nodes.new("ShaderNodeTexImage")
    node.image, other = (bpy.data.images.new("Coat", 4, size) for size in (4, 8))
    if has_file:
        for image, name in ((node.image, "//coat.png"), (other, "//skin.png")):
            image.source, image.filepath = "FILE", name
    remember_made(material)
    node.image.name = "Fur"
    assert not is_edited(material)
    node.image = other
    assert is_edited(material)
