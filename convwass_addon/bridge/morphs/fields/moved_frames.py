# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Geometry nodes that move baked meshes by their velocities to the moment of a mixture.

Halfway between two blends, a point that rotates by an angle a along a path of length s is then off by a s / 8; without
the move, it is off by s / 2.
"""

from __future__ import annotations

from collections.abc import Sequence

import bpy

from ...nodes.node_math import math_node, named_attribute, stored_attribute, switch, vector_math_node, weighted_vectors
from ..frame_switch import FrameSwitch
from ..looks.frame_attributes import VELOCITY
from .field_nodes import FieldMixture, Term
from .field_sampler import set_position
from .stored_fields import OFFSET

HAS = "has {}"
"""Column of the table of steps: 1 where a blend has an attribute, otherwise 0."""


def moved_about_centers(
    mixture: FieldMixture, blends: FrameSwitch, seconds: Sequence[bpy.types.NodeSocket]
) -> list[bpy.types.NodeSocket]:
    """Return the mesh of every term of a mixture, deformed to the moment, but with its center left in place.

    Parameters
    ----------
    mixture : FieldMixture
        Terms of the mixture.
    blends : FrameSwitch
        All blends. Their meshes do not move unless all terms have velocities.
    seconds : sequence of bpy.types.NodeSocket
        Time from the blend of every term to the moment.
    """
    tree, centers = mixture.tree, mixture.of_steps("FLOAT_VECTOR", OFFSET)
    center = weighted_vectors(tree, centers, mixture.weights)
    # Where only one of two meshes moves, their errors do not cancel: it is better if neither does.
    moving = has_velocity(mixture, mixture.terms[0])
    for term in mixture.terms[1:]:
        moving = math_node(tree, "MULTIPLY", moving, has_velocity(mixture, term))
    moved = []
    for term, own, since in zip(mixture.terms, centers, seconds, strict=True):
        way = vector_math_node(tree, "SCALE", velocity_of_points(tree), since)
        way = vector_math_node(tree, "SUBTRACT", way, vector_math_node(tree, "SUBTRACT", center, own))
        way = vector_math_node(tree, "SCALE", way, moving)
        moved.append(set_position(tree, blends.at(tree, term.index)["Geometry"], offset=way))
    return moved


def moved_frame(
    mixture: FieldMixture,
    blends: FrameSwitch,
    seconds: Sequence[bpy.types.NodeSocket],
    speed: bpy.types.NodeSocket,
) -> bpy.types.NodeSocket:
    """Return the mesh of the nearer of two terms, moved to the moment, with its velocities times a factor.

    For thin parts that move by more than their thickness: mixtures do not show them at all.
    """
    tree, (before, after) = mixture.tree, mixture.terms
    later = math_node(
        tree, "MULTIPLY", math_node(tree, "GREATER_THAN", after.weight, 0.5), has_velocity(mixture, after)
    )
    later = math_node(tree, "MAXIMUM", later, math_node(tree, "SUBTRACT", 1.0, has_velocity(mixture, before)))
    index = switch(tree, "FLOAT", later, before.index, after.index)
    since = switch(tree, "FLOAT", later, *seconds)
    velocity = velocity_of_points(tree)
    mesh = blends.at(tree, index)["Geometry"]
    moved = set_position(tree, mesh, offset=vector_math_node(tree, "SCALE", velocity, since))
    faster = vector_math_node(tree, "SCALE", velocity, speed)
    return stored_attribute(tree, moved, VELOCITY, faster, "FLOAT_VECTOR")


def has_velocity(mixture: FieldMixture, term: Term) -> bpy.types.NodeSocket:
    """Return 1 where the blend of a term has velocities, otherwise 0."""
    return mixture.of_step("FLOAT", HAS.format(VELOCITY), term)


def velocity_of_points(tree: bpy.types.NodeTree) -> bpy.types.NodeSocket:
    """Return the velocity stored on the points of a mesh, as a field; 0 if there is none."""
    return named_attribute(tree, VELOCITY, "FLOAT_VECTOR")
