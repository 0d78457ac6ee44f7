# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Geometry nodes for the velocity of a mixture whose weights change, read from the stored fields."""

from __future__ import annotations

from collections.abc import Sequence

import bpy

from ..node_math import math_node, vector_math_node, weighted_sum, weighted_vectors
from .field_nodes import FieldMixture
from .field_sampler import position_node

# Gradients of signed distances have length 1; where parts meet they are shorter, and velocities would be too large.
_LEAST_SLOPE = 0.2


def field_velocity(
    tree: bpy.types.NodeTree,
    mixture: FieldMixture,
    rates: Sequence[bpy.types.NodeSocket],
    spacing: float,
    offsets: Sequence[str],
) -> bpy.types.NodeSocket:
    """Return the velocity of points on the surface of a mixture, along their normals and with the center.

    On a level of a field f(x, t), a point moves by -df/dt / |grad f| along the gradient; df/dt is the sum of the rates
    of the weights times the fields.

    Parameters
    ----------
    tree : bpy.types.NodeTree
        Node group of the new nodes.
    mixture : FieldMixture
        The mixture.
    rates : sequence of bpy.types.NodeSocket
        Change of the weight of every term per second, of sum 0.
    spacing : float
        Size of the cells of the fields.
    offsets : sequence of str
        Columns of the table of steps by which the mixture is moved.
    """
    position = position_node(tree)
    values = [mixture.sampled_term(term, position) for term in mixture.terms]
    change = weighted_sum(tree, values, rates)
    gradient = mixture.sampled(position).gradient
    square = vector_math_node(tree, "DOT_PRODUCT", gradient, gradient)
    square = math_node(tree, "MAXIMUM", square, _LEAST_SLOPE**2)
    speed = math_node(tree, "MULTIPLY", math_node(tree, "DIVIDE", change, square), -spacing)
    velocity = vector_math_node(tree, "SCALE", gradient, speed)
    for name in offsets:
        places = [mixture.of_step("FLOAT_VECTOR", name, term) for term in mixture.terms]
        velocity = vector_math_node(tree, "ADD", velocity, weighted_vectors(tree, places, rates))
    return velocity
