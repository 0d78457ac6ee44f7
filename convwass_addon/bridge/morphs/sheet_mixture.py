# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Geometry Nodes that show a sheet of blends at any position, as a mixture of three baked blends."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray

from ..node_math import math_node, switch
from ..sequence import object_info
from .field_nodes import FieldMixture, Term
from .field_sampler import set_position
from .mixed_frames import MixedFrames, SeenMixture, columns_of
from .stored_fields import OFFSET, Column, StoredFields

_SHOWN = "shown"


@dataclass(frozen=True)
class SheetLattice:
    """Positions of the blends of a sheet on a pad in the XZ plane.

    Attributes
    ----------
    first : (3,) float64
        Position of the blend in the first row and column.
    step : float
        Step between blends of a row.
    rise : float
        Offset between rows, in steps.
    last : int
        Index of the last row.
    is_triangle : bool
        Whether each row is longer than the previous one by one blend, half a step on both sides, instead of equally
        long.
    """

    first: NDArray[np.float64]
    step: float
    rise: float
    last: int
    is_triangle: bool


def sheet_columns(frames: Sequence[bpy.types.Object], feet: NDArray[np.float64]) -> list[Column]:
    """Return the columns of the table of steps of a sheet whose feet, (n, 3), are moved to the origin."""
    return [*columns_of(frames), Column(_SHOWN, "FLOAT_VECTOR", -feet)]


def mixed_sheet(
    tree: bpy.types.NodeTree,
    fields: StoredFields,
    frames: Sequence[bpy.types.Object],
    lattice: SheetLattice,
    place: bpy.types.NodeSocket,
    detail: bpy.types.NodeSocket,
) -> SeenMixture:
    """Return the blend of a sheet at a position on its pad; outside of the pad, at its edge.

    Parameters
    ----------
    tree : bpy.types.NodeTree
        Node group of the new nodes.
    fields : StoredFields
        Table of the blends, with `sheet_columns`.
    frames : sequence of bpy.types.Object
        The blends.
    lattice : SheetLattice
        Positions of the blends.
    place : bpy.types.NodeSocket
        Position in local space of the pad.
    detail : bpy.types.NodeSocket
        Whether the surface is projected onto the baked meshes.
    """
    meshes = [object_info(tree, obj).outputs["Geometry"] for obj in frames]
    mixture = FieldMixture(tree, fields, _corners(tree, lattice, place))
    mixed = MixedFrames(tree, fields, frames, meshes, mixture)
    shown = mixed.dressed(mixed.geometry(detail))
    for name in (OFFSET, _SHOWN):
        shown = set_position(tree, shown, offset=mixed.mixed_column("FLOAT_VECTOR", name))
    return SeenMixture(shown, mixed.color, mixed.is_shape)


def _corners(tree: bpy.types.NodeTree, lattice: SheetLattice, place: bpy.types.NodeSocket) -> list[Term]:
    """Return the corners of the triangle of blends around a position, with its barycentric coordinates.

    Every cell of rows and columns is cut from its first to its last corner, which in a triangular sheet are as close as
    neighbors in a row.
    """
    row, column = _row_and_column(tree, lattice, place)
    last = lattice.last - 1.0
    first_row, first_column = (
        math_node(tree, "MINIMUM", math_node(tree, "FLOOR", number), last) for number in (row, column)
    )
    down = math_node(tree, "SUBTRACT", row, first_row)
    along = math_node(tree, "SUBTRACT", column, first_column)
    turned = math_node(tree, "GREATER_THAN", along, down)
    more, less = math_node(tree, "MAXIMUM", down, along), math_node(tree, "MINIMUM", down, along)
    next_row, next_column = (math_node(tree, "ADD", number, 1.0) for number in (first_row, first_column))
    middle_row = switch(tree, "FLOAT", turned, next_row, first_row)
    middle_column = switch(tree, "FLOAT", turned, first_column, next_column)
    places = ((first_row, first_column), (middle_row, middle_column), (next_row, next_column))
    weights = (math_node(tree, "SUBTRACT", 1.0, more), math_node(tree, "SUBTRACT", more, less), less)
    return [Term(_number(tree, lattice, *own), weight) for own, weight in zip(places, weights, strict=True)]


def _row_and_column(
    tree: bpy.types.NodeTree, lattice: SheetLattice, place: bpy.types.NodeSocket
) -> tuple[bpy.types.NodeSocket, bpy.types.NodeSocket]:
    """Return the row and column of a position, clamped to the sheet."""
    axes = tree.nodes.new("ShaderNodeSeparateXYZ")
    tree.links.new(place, axes.inputs[0])
    row = math_node(tree, "SUBTRACT", float(lattice.first[2]), axes.outputs["Z"])
    row = _clamped(tree, math_node(tree, "DIVIDE", row, lattice.rise * lattice.step), float(lattice.last))
    column = math_node(tree, "SUBTRACT", axes.outputs["X"], float(lattice.first[0]))
    column = math_node(tree, "DIVIDE", column, lattice.step)
    if not lattice.is_triangle:
        return row, _clamped(tree, column, float(lattice.last))
    return row, _clamped(tree, math_node(tree, "MULTIPLY_ADD", row, 0.5, column), row)


def _clamped(
    tree: bpy.types.NodeTree, number: bpy.types.NodeSocket, most: bpy.types.NodeSocket | float
) -> bpy.types.NodeSocket:
    return math_node(tree, "MAXIMUM", math_node(tree, "MINIMUM", number, most), 0.0)


def _number(
    tree: bpy.types.NodeTree, lattice: SheetLattice, row: bpy.types.NodeSocket, column: bpy.types.NodeSocket
) -> bpy.types.NodeSocket:
    """Return the index of the blend in a row and a column."""
    if not lattice.is_triangle:
        return math_node(tree, "MULTIPLY_ADD", row, lattice.last + 1.0, column)
    before = math_node(tree, "MULTIPLY", math_node(tree, "MULTIPLY", row, math_node(tree, "ADD", row, 1.0)), 0.5)
    return math_node(tree, "ADD", before, column)
