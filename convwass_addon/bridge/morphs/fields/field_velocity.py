# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Geometry nodes for the velocity of a mixture whose weights change, read from the stored fields."""

from __future__ import annotations

from collections.abc import Sequence

import bpy

from ...nodes.node_math import math_node, vector_math_node, weighted_sum, weighted_vectors
from .field_nodes import FieldMixture
from .field_sampler import position_node

# Gradients of signed distances have length 1; where parts meet they are shorter, and velocities would be too large.
_LEAST_SLOPE = 0.2


def field_velocity(
    mixture: FieldMixture, rates: Sequence[bpy.types.NodeSocket], offsets: Sequence[str]
) -> bpy.types.NodeSocket:
    """Return the velocity of points on the surface of a mixture, along their normals and with the center.

    On a level of a field f(x, t), a point moves by -df/dt / |grad f| along the gradient; df/dt is the sum of the rates
    of the weights times the fields.

    Parameters
    ----------
    mixture : FieldMixture
        The mixture.
    rates : sequence of bpy.types.NodeSocket
        Change of the weight of every term per second, of sum 0.
    offsets : sequence of str
        Columns of the table of steps by which the mixture is moved.
    """
    tree = mixture.tree
    position = position_node(tree)
    values = [mixture.sampled_term(term, position) for term in mixture.terms]
    change = weighted_sum(tree, values, rates)
    gradient = mixture.sampled(position).gradient
    square = vector_math_node(tree, "DOT_PRODUCT", gradient, gradient)
    square = math_node(tree, "MAXIMUM", square, _LEAST_SLOPE**2)
    speed = math_node(tree, "MULTIPLY", math_node(tree, "DIVIDE", change, square), -mixture.spacing)
    velocity = vector_math_node(tree, "SCALE", gradient, speed)
    for name in offsets:
        moved = weighted_vectors(tree, mixture.of_steps("FLOAT_VECTOR", name), rates)
        velocity = vector_math_node(tree, "ADD", velocity, moved)
    return velocity
