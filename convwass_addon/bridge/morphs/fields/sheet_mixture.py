# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Geometry Nodes that show a sheet of blends at any position, as a mixture of three baked blends."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray

from ...nodes.node_math import clamped, math_node, new_node, stored_attribute, switch, vector_math_node
from ..frame_switch import FrameSwitch
from ..looks.frame_attributes import VELOCITY
from .field_nodes import FieldMixture, Term
from .field_sampler import set_position
from .field_velocity import field_velocity
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
    blends: FrameSwitch,
    lattice: SheetLattice,
    place: bpy.types.NodeSocket,
    detail: bpy.types.NodeSocket,
    handle_velocity: bpy.types.NodeSocket,
) -> SeenMixture:
    """Return the blend of a sheet at a position on its pad; outside of the pad, at its edge.

    Parameters
    ----------
    tree : bpy.types.NodeTree
        Node group of the new nodes.
    fields : StoredFields
        Table of the blends, with `sheet_columns`.
    blends : FrameSwitch
        The blends.
    lattice : SheetLattice
        Positions of the blends.
    place : bpy.types.NodeSocket
        Position in local space of the pad.
    detail : bpy.types.NodeSocket
        Whether the surface is projected onto the baked meshes.
    handle_velocity : bpy.types.NodeSocket
        Change of the position per second, for motion blur.
    """
    cell = _Cell.of(tree, lattice, _place_on_sheet(tree, lattice, place))
    mixture = FieldMixture(tree, fields, cell.terms(tree, lattice))
    mixed = MixedFrames(mixture, blends)
    change = _along_sheet(tree, lattice, handle_velocity)
    rates = cell.rates(tree, change.row, change.column)
    velocity = field_velocity(mixture, rates, [OFFSET, _SHOWN])
    still = mixed.geometry(detail)
    moves = math_node(tree, "GREATER_THAN", vector_math_node(tree, "LENGTH", handle_velocity), 0.0)
    moving = stored_attribute(tree, still, VELOCITY, velocity, "FLOAT_VECTOR")
    shown = switch(tree, "GEOMETRY", moves, still, moving)
    shown = mixed.with_materials(shown)
    for name in (OFFSET, _SHOWN):
        shown = set_position(tree, shown, offset=mixed.mixed_column("FLOAT_VECTOR", name))
    return SeenMixture(shown, mixed.color, mixed.is_shape)


@dataclass(frozen=True)
class _Cell:
    """The triangle of blends around a position: one of the two halves of a cell of rows and columns.

    Every cell is cut from its first to its last corner, which in a triangular sheet are as close as neighbors in a row.
    """

    first_row: bpy.types.NodeSocket
    first_column: bpy.types.NodeSocket
    down: bpy.types.NodeSocket
    along: bpy.types.NodeSocket
    """Position in the cell, from 0 to 1."""
    turned: bpy.types.NodeSocket
    """1 in the half at the end of the first row, 0 in the other one."""

    @classmethod
    def of(cls, tree: bpy.types.NodeTree, lattice: SheetLattice, place: _SheetPlace) -> _Cell:
        """Find the cell of a position on a sheet."""
        last = lattice.last - 1.0
        first_row, first_column = (
            math_node(tree, "MINIMUM", math_node(tree, "FLOOR", number), last) for number in (place.row, place.column)
        )
        down = math_node(tree, "SUBTRACT", place.row, first_row)
        along = math_node(tree, "SUBTRACT", place.column, first_column)
        return cls(first_row, first_column, down, along, math_node(tree, "GREATER_THAN", along, down))

    def terms(self, tree: bpy.types.NodeTree, lattice: SheetLattice) -> list[Term]:
        """Return the corners of the triangle, with the barycentric coordinates of the position."""
        more, less = (math_node(tree, name, self.down, self.along) for name in ("MAXIMUM", "MINIMUM"))
        next_row, next_column = (math_node(tree, "ADD", own, 1.0) for own in (self.first_row, self.first_column))
        middle_row = switch(tree, "FLOAT", self.turned, next_row, self.first_row)
        middle_column = switch(tree, "FLOAT", self.turned, self.first_column, next_column)
        places = ((self.first_row, self.first_column), (middle_row, middle_column), (next_row, next_column))
        weights = (math_node(tree, "SUBTRACT", 1.0, more), math_node(tree, "SUBTRACT", more, less), less)
        return [Term(_number(tree, lattice, *own), weight) for own, weight in zip(places, weights, strict=True)]

    def rates(
        self, tree: bpy.types.NodeTree, row_rate: bpy.types.NodeSocket, column_rate: bpy.types.NodeSocket
    ) -> list[bpy.types.NodeSocket]:
        """Return how fast the barycentric coordinates change, from the speed of row and column."""
        more = switch(tree, "FLOAT", self.turned, row_rate, column_rate)
        less = switch(tree, "FLOAT", self.turned, column_rate, row_rate)
        return [math_node(tree, "MULTIPLY", more, -1.0), math_node(tree, "SUBTRACT", more, less), less]


@dataclass(frozen=True)
class _SheetPlace:
    """A position on a sheet, in rows and columns."""

    row: bpy.types.NodeSocket
    column: bpy.types.NodeSocket


def _place_on_sheet(tree: bpy.types.NodeTree, lattice: SheetLattice, place: bpy.types.NodeSocket) -> _SheetPlace:
    """Return the row and column of a position on the pad, clamped to the sheet."""
    first = (float(lattice.first[0]), 0.0, float(lattice.first[2]))
    free = _along_sheet(tree, lattice, vector_math_node(tree, "SUBTRACT", place, first))
    row = clamped(tree, free.row, 0.0, float(lattice.last))
    if not lattice.is_triangle:
        return _SheetPlace(row, clamped(tree, free.column, 0.0, float(lattice.last)))
    # Rows begin half a step to the left of the row above.
    shift = math_node(tree, "MULTIPLY", math_node(tree, "SUBTRACT", row, free.row), 0.5)
    return _SheetPlace(row, clamped(tree, math_node(tree, "ADD", free.column, shift), 0.0, row))


def _along_sheet(tree: bpy.types.NodeTree, lattice: SheetLattice, vector: bpy.types.NodeSocket) -> _SheetPlace:
    """Return a vector on the pad in rows and columns."""
    axes = new_node(tree, "ShaderNodeSeparateXYZ", {0: vector})
    row = math_node(tree, "DIVIDE", axes.outputs["Z"], -lattice.rise * lattice.step)
    column = math_node(tree, "DIVIDE", axes.outputs["X"], lattice.step)
    return _SheetPlace(row, math_node(tree, "MULTIPLY_ADD", row, 0.5, column) if lattice.is_triangle else column)


def _number(
    tree: bpy.types.NodeTree, lattice: SheetLattice, row: bpy.types.NodeSocket, column: bpy.types.NodeSocket
) -> bpy.types.NodeSocket:
    """Return the index of the blend in a row and a column."""
    if not lattice.is_triangle:
        return math_node(tree, "MULTIPLY_ADD", row, lattice.last + 1.0, column)
    before = math_node(tree, "MULTIPLY", math_node(tree, "MULTIPLY", row, math_node(tree, "ADD", row, 1.0)), 0.5)
    return math_node(tree, "ADD", before, column)
