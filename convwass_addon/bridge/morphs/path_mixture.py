# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Geometry nodes that show a path of blends at any value: the two baked blends beside it, mixed."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import numpy as np

from ..node_math import feed, math_node, vector_math_node
from ..sequence import object_info
from .field_nodes import FieldMixture, Term
from .field_sampler import position_node, sample_index, set_position
from .mixed_frames import MixedFrames, SeenMixture, columns_of
from .stored import INDEX_KEY
from .stored_fields import OFFSET, Column, StoredFields

PACE = "pace"
"""Column of the table of steps: how many steps the bake makes in a second, from every blend to the next."""


def path_columns(frames: Sequence[bpy.types.Object], per_second: float) -> list[Column]:
    """Return what the table of steps says of the blends of a path, baked with so many frames per second."""
    numbers = np.array([obj[INDEX_KEY] for obj in frames], dtype=np.float64)
    steps = np.diff(numbers, append=2 * numbers[-1] - numbers[-2])
    return [*columns_of(frames), Column(PACE, "FLOAT", per_second / steps)]


def mixed_path(
    tree: bpy.types.NodeTree,
    fields: StoredFields,
    frames: Sequence[bpy.types.Object],
    meshes: Sequence[bpy.types.NodeSocket],
    value: bpy.types.NodeSocket,
    speed: bpy.types.NodeSocket,
) -> SeenMixture:
    """Return what is seen of a path at a value, in the local space of the frames.

    Parameters
    ----------
    tree : bpy.types.NodeTree
        Where they go.
    fields : StoredFields
        Of the blends, with `path_columns` and its vertices at the values on the X axis.
    frames : sequence of bpy.types.Object
        The blends.
    meshes : sequence of bpy.types.NodeSocket
        Their meshes in their local space.
    value : bpy.types.NodeSocket
        Between the first and the last value.
    speed : bpy.types.NodeSocket
        How fast the path is played, as a multiple of the pace of the bake.
    """
    before, after = _neighbors(tree, object_info(tree, fields.steps).outputs["Geometry"], value, len(frames))
    mixture = FieldMixture(tree, fields, [before, after])
    mixed = MixedFrames(tree, fields, frames, meshes, mixture)
    shown = mixed.dressed(mixed.geometry(_velocity(tree, mixture, fields.grid.spacing), speed))
    shown = set_position(tree, shown, offset=mixed.mixed_column("FLOAT_VECTOR", OFFSET))
    return SeenMixture(shown, mixed.color, mixed.is_shape)


def _neighbors(
    tree: bpy.types.NodeTree, steps: bpy.types.NodeSocket, value: bpy.types.NodeSocket, count: int
) -> tuple[Term, Term]:
    """Return the blends before and after a value, with their shares."""
    along = tree.nodes.new("ShaderNodeSeparateXYZ")
    tree.links.new(position_node(tree), along.inputs[0])
    passed = math_node(tree, "SUBTRACT", 1.0, math_node(tree, "LESS_THAN", value, along.outputs["X"]))
    total = tree.nodes.new("GeometryNodeAttributeStatistic")
    total.data_type, total.domain = "FLOAT", "POINT"
    feed(tree, [total.inputs["Geometry"], total.inputs["Attribute"]], [steps, passed])
    index = math_node(tree, "SUBTRACT", total.outputs["Sum"], 1.0)
    index = math_node(tree, "MAXIMUM", math_node(tree, "MINIMUM", index, count - 2.0), 0.0)
    following = math_node(tree, "ADD", index, 1.0)
    low, high = (sample_index(tree, steps, "FLOAT", along.outputs["X"], place) for place in (index, following))
    share = math_node(tree, "DIVIDE", math_node(tree, "SUBTRACT", value, low), math_node(tree, "SUBTRACT", high, low))
    share.node.use_clamp = True
    return Term(index, math_node(tree, "SUBTRACT", 1.0, share)), Term(following, share)


def _velocity(tree: bpy.types.NodeTree, mixture: FieldMixture, spacing: float) -> bpy.types.NodeSocket:
    """Return how fast points move along their normals at the pace of the bake, and with the center.

    On the level of a field f(x, s) a point moves by -df/ds / |grad f| along the gradient.
    """
    before, after = mixture.terms
    position = position_node(tree)
    values = [mixture.sampled_term(term, position) for term in (before, after)]
    gradient = mixture.sampled(position).gradient
    square = math_node(tree, "MAXIMUM", vector_math_node(tree, "DOT_PRODUCT", gradient, gradient), 0.04)
    change = math_node(tree, "DIVIDE", math_node(tree, "SUBTRACT", *values), square)
    along = vector_math_node(tree, "SCALE", gradient, math_node(tree, "MULTIPLY", change, spacing))
    offsets = [mixture.of_step("FLOAT_VECTOR", OFFSET, term) for term in (after, before)]
    total = vector_math_node(tree, "ADD", along, vector_math_node(tree, "SUBTRACT", *offsets))
    return vector_math_node(tree, "SCALE", total, mixture.of_step("FLOAT", PACE, before))
