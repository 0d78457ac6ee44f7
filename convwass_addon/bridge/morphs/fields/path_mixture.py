# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A node group that shows a path of blends at any value, as a mixture of two baked blends."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import numpy as np

from ...nodes.node_math import clamped, math_node, new_node, sum_over, switch
from ...nodes.node_trees import GroupInput, add_inputs
from ...sequence import object_info, transformed
from ..frame_switch import FrameSwitch
from ..looks.frame_attributes import VELOCITY
from ..looks.frame_colors import colored
from ..stored import frame_number
from .field_nodes import FieldMixture, Term
from .field_sampler import position_node, sample_index, set_position
from .field_velocity import field_velocity
from .mixed_frames import DETAIL, DETAIL_TIP, MixedFrames, carried_attributes, columns_of
from .moved_frames import has_velocity, moved_about_centers, moved_frame
from .stored_fields import LOSES_PARTS, OFFSET, Column, StoredFields

VALUE = "Morph"
"""Input: 0 is the first shape, 1 the second, and so on."""

SPEED = "Speed"
"""Input for motion blur: speed of the value, as a multiple of its speed in the bake."""

MOMENT = (
    GroupInput(VALUE, "Float", 0.0, "Blend to show: 0 is the first shape, 1 the second, and so on"),
    GroupInput(DETAIL, "Bool", True, DETAIL_TIP),
    GroupInput(SPEED, "Float", 1.0, "Speed of the value as a multiple of its speed in the bake, for motion blur"),
)
"""Inputs of the group."""

PACE = "pace"
"""Column of the table of steps: steps per second in the bake, from every blend to the next."""


def path_columns(frames: Sequence[bpy.types.Object], per_second: float) -> list[Column]:
    """Return the columns of the table of steps of a path, baked at a number of frames per second."""
    numbers = np.array([frame_number(obj) for obj in frames], dtype=np.float64)
    steps = np.diff(numbers, append=2 * numbers[-1] - numbers[-2])
    return [*columns_of(frames), Column(PACE, "FLOAT", per_second / steps)]


def moment_group(name: str, fields: StoredFields, blends: FrameSwitch) -> bpy.types.NodeTree:
    """Create a node group that shows a path at any value; it can be used without a modifier, and is marked as an asset.

    Its inputs are those of `MOMENT`, its output is a mesh at the position of the frame objects. Unchanged shapes are
    shown with their own mesh.

    Parameters
    ----------
    name : str
        Name of the group.
    fields : StoredFields
        Table of the blends, with `path_columns` and its vertices at the values on the X axis.
    blends : FrameSwitch
        The blends.
    """
    tree = bpy.data.node_groups.new(name, "GeometryNodeTree")
    tree.is_modifier = True
    add_inputs(tree, MOMENT)
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    inputs = tree.nodes.new("NodeGroupInput").outputs
    terms = _neighbors(tree, object_info(tree, fields.steps).outputs["Geometry"], inputs[VALUE], len(blends.frames))
    mixture = FieldMixture(tree, fields, terms)
    is_moving, seconds = VELOCITY in carried_attributes(blends.frames), _seconds(mixture)
    targets = moved_about_centers(mixture, blends, seconds) if is_moving else None
    mixed = MixedFrames(mixture, blends, targets)
    pace = mixture.of_step("FLOAT", PACE, terms[0])
    rates = (math_node(tree, "MULTIPLY", pace, -1.0), pace)
    velocity = field_velocity(mixture, rates, [OFFSET])
    shown = mixed.geometry(inputs[DETAIL], velocity, inputs[SPEED])
    shown = set_position(tree, mixed.with_materials(shown), offset=mixed.mixed_column("FLOAT_VECTOR", OFFSET))
    if is_moving:
        known = math_node(tree, "MAXIMUM", *(has_velocity(mixture, term) for term in terms))
        moves = math_node(tree, "MULTIPLY", mixture.of_step("FLOAT", LOSES_PARTS, terms[0]), known)
        moved = moved_frame(mixture, blends, seconds, inputs[SPEED])
        shown = switch(tree, "GEOMETRY", moves, shown, moved)
    is_later = math_node(tree, "GREATER_THAN", terms[1].weight, 0.5)
    nearer = switch(tree, "FLOAT", is_later, terms[0].index, terms[1].index)
    blend = blends.at(tree, nearer)
    shown = switch(tree, "GEOMETRY", mixed.is_shape, shown, blend["Geometry"])
    shown = transformed(tree, shown, blend["Transform"])
    shown = colored(tree, shown, mixed.color, blends.frames)
    new_node(tree, "NodeGroupOutput", {"Geometry": shown})
    tree.asset_mark()
    return tree


def _seconds(mixture: FieldMixture) -> tuple[bpy.types.NodeSocket, bpy.types.NodeSocket]:
    """Return the time from the blends before and after a moment to it; the latter is negative."""
    tree, (before, after) = mixture.tree, mixture.terms
    pace = mixture.of_step("FLOAT", PACE, before)
    backward = math_node(tree, "MULTIPLY", before.weight, -1.0)
    return tuple(math_node(tree, "DIVIDE", share, pace) for share in (after.weight, backward))


def _neighbors(
    tree: bpy.types.NodeTree, steps: bpy.types.NodeSocket, value: bpy.types.NodeSocket, count: int
) -> tuple[Term, Term]:
    """Return the blends before and after a value, with their weights."""
    along = new_node(tree, "ShaderNodeSeparateXYZ", {0: position_node(tree)}).outputs["X"]
    passed = math_node(tree, "SUBTRACT", 1.0, math_node(tree, "LESS_THAN", value, along))
    index = clamped(tree, math_node(tree, "SUBTRACT", sum_over(tree, steps, passed), 1.0), 0.0, count - 2.0)
    following = math_node(tree, "ADD", index, 1.0)
    low, high = (sample_index(tree, steps, "FLOAT", along, place) for place in (index, following))
    share = math_node(tree, "DIVIDE", math_node(tree, "SUBTRACT", value, low), math_node(tree, "SUBTRACT", high, low))
    share.node.use_clamp = True
    return Term(index, math_node(tree, "SUBTRACT", 1.0, share)), Term(following, share)
