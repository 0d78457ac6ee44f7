# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A node group that interpolates samples on a grid, and nodes for points of geometries."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import bpy
import numpy as np
from numpy.typing import NDArray

from ...nodes.node_math import math_node, new_node, vector_math_node
from ...nodes.node_trees import geometry_group


@dataclass(frozen=True)
class SampleGrid:
    """Positions of samples.

    Attributes
    ----------
    low : (3,) float64
        The first sample.
    spacing : float
        Size of a cell.
    shape : (int, int, int)
        Samples along the axes, numbered in the order of `ravel`.
    """

    low: NDArray[np.float64]
    spacing: float
    shape: tuple[int, int, int]

    @property
    def strides(self) -> tuple[float, float, float]:
        """Change of the sample index per step along the axes."""
        _, ny, nz = self.shape
        return (float(ny * nz), float(nz), 1.0)


def field_sampler(name: str, grid: SampleGrid) -> bpy.types.NodeTree:
    """Create the node group that interpolates a field between the eight samples around a position."""
    inputs = {"Samples": "Geometry", "Field": "Float", "Position": "Vector"}
    tree = geometry_group(name, inputs, {"Value": "Float", "Gradient": "Vector"})
    geometry, field, position = tree.nodes.new("NodeGroupInput").outputs[:3]
    place = vector_math_node(tree, "SUBTRACT", position, tuple(grid.low))
    place = vector_math_node(tree, "SCALE", place, 1.0 / grid.spacing)
    place = vector_math_node(tree, "MAXIMUM", place, (0.0, 0.0, 0.0))
    place = vector_math_node(tree, "MINIMUM", place, tuple(float(n) - 1.001 for n in grid.shape))
    cell = vector_math_node(tree, "FLOOR", place)
    part = new_node(tree, "ShaderNodeSeparateXYZ", {0: vector_math_node(tree, "SUBTRACT", place, cell)})
    first = vector_math_node(tree, "DOT_PRODUCT", cell, grid.strides)
    corners = {}
    for corner in product((0, 1), repeat=3):
        shift = sum(c * stride for c, stride in zip(corner, grid.strides, strict=True))
        corners[corner] = sample_index(tree, geometry, "FLOAT", field, math_node(tree, "ADD", first, shift))
    value, slopes = _interpolated(tree, corners, list(part.outputs))
    gradient = new_node(tree, "ShaderNodeCombineXYZ", dict(enumerate(slopes))).outputs[0]
    new_node(tree, "NodeGroupOutput", {"Value": value, "Gradient": gradient})
    return tree


def _interpolated(
    tree: bpy.types.NodeTree,
    corners: dict[tuple[int, ...], bpy.types.NodeSocket],
    shares: Sequence[bpy.types.NodeSocket],
) -> tuple[bpy.types.NodeSocket, list[bpy.types.NodeSocket]]:
    """Return the trilinear interpolation of values at the corners of a cell, and its derivatives."""
    if not shares:
        return corners[()], []
    low = {key[1:]: value for key, value in corners.items() if key[0] == 0}
    high = {key[1:]: value for key, value in corners.items() if key[0] == 1}
    lower, lower_slopes = _interpolated(tree, low, shares[1:])
    upper, upper_slopes = _interpolated(tree, high, shares[1:])
    difference = math_node(tree, "SUBTRACT", upper, lower)
    value = math_node(tree, "MULTIPLY_ADD", difference, shares[0], lower)
    slopes = [
        math_node(tree, "MULTIPLY_ADD", math_node(tree, "SUBTRACT", b, a), shares[0], a)
        for a, b in zip(lower_slopes, upper_slopes, strict=True)
    ]
    return value, [difference, *slopes]


def position_node(tree: bpy.types.NodeTree) -> bpy.types.NodeSocket:
    """Return the position field."""
    return tree.nodes.new("GeometryNodeInputPosition").outputs["Position"]


def set_position(
    tree: bpy.types.NodeTree,
    geometry: bpy.types.NodeSocket,
    *,
    position: bpy.types.NodeSocket | None = None,
    offset: bpy.types.NodeSocket | None = None,
) -> bpy.types.NodeSocket:
    """Return a geometry with points moved to positions, or by offsets."""
    inputs = {"Geometry": geometry, "Position": position, "Offset": offset}
    given = {name: value for name, value in inputs.items() if value is not None}
    return new_node(tree, "GeometryNodeSetPosition", given).outputs["Geometry"]


def sample_index(
    tree: bpy.types.NodeTree,
    geometry: bpy.types.NodeSocket,
    kind: str,
    value: bpy.types.NodeSocket,
    index: bpy.types.NodeSocket,
    domain: str = "POINT",
) -> bpy.types.NodeSocket:
    """Return a value at a point or face of a geometry, by index."""
    inputs = {"Geometry": geometry, "Value": value, "Index": index}
    return new_node(tree, "GeometryNodeSampleIndex", inputs, data_type=kind, domain=domain).outputs["Value"]
