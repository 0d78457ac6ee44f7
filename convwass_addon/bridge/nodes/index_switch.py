# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A node group that returns one of any number of choices by its index.

Blender updates a whole tree after each new node and link, so the time to build a single tree grows with the square of
the number of choices. They are therefore divided among nested groups of a few each.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TypeVar

import bpy

from .node_math import new_node, pick
from .node_trees import geometry_group

# Most choices, or nested groups, in a group.
_MOST = 32

_Choice = TypeVar("_Choice")


def index_switch(
    name: str,
    outputs: Mapping[str, str],
    choices: Sequence[_Choice],
    read: Callable[[bpy.types.NodeTree, _Choice], Sequence[object]],
) -> bpy.types.NodeTree:
    """Create a node group with the input *Index*, for a place among choices.

    Parameters
    ----------
    name : str
        Name of the group. Those of nested groups begin with a dot, so that Blender does not list them.
    outputs : mapping of str to str
        Names and types of the outputs, "GEOMETRY", "MATRIX" or "RGBA".
    choices : sequence
        At least one.
    read : callable
        Adds the nodes of a choice to a tree, and returns the value of each output: a socket or a constant.
    """
    trees = []
    for part in _divided(choices):
        tree = _new_group(f".{name}", outputs)
        values = [read(tree, choice) for choice in part]
        _return(tree, outputs, _index(tree), values)
        trees.append(tree)
    size = _MOST
    while len(trees) > 1:
        trees = [_nested(f".{name}", outputs, part, size) for part in _divided(trees)]
        size *= _MOST
    trees[0].name = name
    return trees[0]


def chosen(tree: bpy.types.NodeTree, group: bpy.types.NodeTree, index: bpy.types.NodeSocket) -> bpy.types.NodeOutputs:
    """Return the outputs of a group of `index_switch` at an index, as a new node of a tree."""
    return new_node(tree, "GeometryNodeGroup", {"Index": index}, node_tree=group).outputs


def _divided(items: Sequence[_Choice]) -> list[Sequence[_Choice]]:
    return [items[start : start + _MOST] for start in range(0, len(items), _MOST)]


def _new_group(name: str, outputs: Mapping[str, str]) -> bpy.types.NodeTree:
    """Create a group without nodes."""
    names = {"GEOMETRY": "Geometry", "MATRIX": "Matrix", "RGBA": "Color"}
    return geometry_group(name, {"Index": "Int"}, {label: names[kind] for label, kind in outputs.items()})


def _index(tree: bpy.types.NodeTree) -> bpy.types.NodeSocket:
    return tree.nodes.new("NodeGroupInput").outputs["Index"]


def _nested(
    name: str, outputs: Mapping[str, str], groups: Sequence[bpy.types.NodeTree], size: int
) -> bpy.types.NodeTree:
    """Create a group of groups, each with `size` choices."""
    tree = _new_group(name, outputs)
    index = _index(tree)
    within, place = (
        new_node(tree, "FunctionNodeIntegerMath", {0: index, 1: size}, operation=operation).outputs["Value"]
        for operation in ("MODULO", "DIVIDE_FLOOR")
    )
    _return(tree, outputs, place, [list(chosen(tree, group, within)) for group in groups])
    return tree


def _return(
    tree: bpy.types.NodeTree,
    outputs: Mapping[str, str],
    index: bpy.types.NodeSocket,
    values: Sequence[Sequence[object]],
) -> None:
    """Connect the outputs of a group to the values at an index, of which each choice has one per output."""
    columns = zip(outputs.items(), zip(*values, strict=True), strict=True)
    new_node(tree, "NodeGroupOutput", {label: pick(tree, kind, index, column) for (label, kind), column in columns})
