# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Geometry nodes that evaluate mixtures of stored fields: their surfaces, and their values at points.

They only use nodes of Blender 4.5 and later: Volume Cube takes the mixture, and Volume to Mesh extracts its surface.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import bpy

from ...nodes.node_math import (
    clamped,
    feed,
    math_node,
    named_attribute,
    new_node,
    stored_attribute,
    sum_over,
    vector_math_node,
    weighted_sum,
)
from ...sequence import object_info
from .field_sampler import position_node, sample_index, set_position
from .stored_fields import BAND, FIELD, SCALE, VOLUME, StoredFields

_MIXED = "mixed"
# Rounds of smoothing the surface, and Newton steps that move it back to the level.
_EVENING_ROUNDS, _NEWTON_STEPS = 2, 2
# Shorter gradients are unreliable; those of distances have length one.
_LEAST_SLOPE = 0.2
# Largest length of a Newton step, in cells.
_LONGEST_STEP = 0.5


@dataclass(frozen=True)
class Term:
    """One of the stored blends in a mixture.

    Attributes
    ----------
    index : bpy.types.NodeSocket
        Its index, an integer.
    weight : bpy.types.NodeSocket
        Its weight; the weights of a mixture sum to one.
    """

    index: bpy.types.NodeSocket
    weight: bpy.types.NodeSocket


@dataclass(frozen=True)
class Sampled:
    """A field at points.

    Attributes
    ----------
    value : bpy.types.NodeSocket
        In cells.
    gradient : bpy.types.NodeSocket
        In cells per cell.
    """

    value: bpy.types.NodeSocket
    gradient: bpy.types.NodeSocket


class FieldMixture:
    """A mixture of stored fields in a node tree.

    Parameters
    ----------
    tree : bpy.types.NodeTree
        Node group of the new nodes.
    fields : StoredFields
        The fields of a morph.
    terms : sequence of Term
        The mixed blends.
    """

    def __init__(self, tree: bpy.types.NodeTree, fields: StoredFields, terms: Sequence[Term]) -> None:
        self.tree, self._fields, self._grid, self.terms = tree, fields, fields.grid, list(terms)
        self.weights = [term.weight for term in terms]
        # Every further node makes all later changes of the tree slower.
        self._attributes: dict[tuple[str, str], bpy.types.NodeSocket] = {}
        self._of_steps: dict[tuple[str, str, int], bpy.types.NodeSocket] = {}
        self._samples = object_info(tree, fields.samples).outputs["Geometry"]
        self._steps = object_info(tree, fields.steps).outputs["Geometry"]
        own = [self._field_of(term) for term in terms]
        # Stored, because the mixture is used several times.
        self._geometry = stored_attribute(tree, self._samples, _MIXED, weighted_sum(tree, own, self.weights))
        self._mixed = named_attribute(tree, _MIXED)
        self.level = self._level()

    @property
    def spacing(self) -> float:
        """Size of a cell in scene units."""
        return self._grid.spacing

    def of_step(self, kind: str, name: str, term: Term) -> bpy.types.NodeSocket:
        """Return a value of a blend from the table; `kind` is a data type of Sample Index."""
        key = (kind, name, term.index.as_pointer())
        if key not in self._of_steps:
            if (kind, name) not in self._attributes:
                self._attributes[kind, name] = named_attribute(self.tree, name, kind)
            value = self._attributes[kind, name]
            self._of_steps[key] = sample_index(self.tree, self._steps, kind, value, term.index)
        return self._of_steps[key]

    def of_steps(self, kind: str, name: str) -> list[bpy.types.NodeSocket]:
        """Return the values of all terms from the table; see `of_step`."""
        return [self.of_step(kind, name, term) for term in self.terms]

    def surface(self) -> bpy.types.NodeSocket:
        """Return a quad mesh that encloses the mixed volume, relative to the center of the blends."""
        tree, grid = self.tree, self._grid
        inputs = {
            "Density": sample_index(tree, self._geometry, "FLOAT", self._mixed, self._index()),
            "Background": -BAND,
            # In cells, because OpenVDB does not create grids with cells smaller than 1.5e-5.
            "Min": (0.0,) * 3,
            "Max": [n - 1.0 for n in grid.shape],
        }
        inputs |= {f"Resolution {axis}": count for axis, count in zip("XYZ", grid.shape, strict=True)}
        cube = new_node(tree, "GeometryNodeVolumeCube", inputs)
        inputs = {"Volume": cube.outputs["Volume"], "Threshold": self.level}
        drawn = new_node(tree, "GeometryNodeVolumeToMesh", inputs)
        place = vector_math_node(tree, "SCALE", position_node(tree), grid.spacing)
        place = vector_math_node(tree, "ADD", place, tuple(grid.low))
        return self._evened(set_position(tree, drawn.outputs["Mesh"], position=place))

    def sampled(self, position: bpy.types.NodeSocket) -> Sampled:
        """Return the mixture at points relative to the center, in scene units."""
        return self._sample(self._geometry, self._mixed, position)

    def sampled_term(self, term: Term, position: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
        """Return one of the fields at points, in cells."""
        return self._sample(self._samples, self._field_of(term), position).value

    def _field_of(self, term: Term) -> bpy.types.NodeSocket:
        """Return the field of a blend at the samples, in cells."""
        tree = self.tree
        name = new_node(tree, "FunctionNodeFormatString", {"Format": FIELD.replace("{}", "{number}")})
        name.format_items.new("INT", "number")
        tree.links.new(term.index, name.inputs["number"])
        return math_node(tree, "MULTIPLY", named_attribute(tree, name.outputs["String"]), 1.0 / SCALE)

    def _level(self) -> bpy.types.NodeSocket:
        """Return the level at which the mixture encloses the mixed volume, by one Newton step from zero.

        The volume is counted as for `VOLUME`, and its derivative is the number of samples within half a cell.
        """
        tree = self.tree
        wanted = weighted_sum(tree, self.of_steps("FLOAT", VOLUME), self.weights)
        inside = math_node(tree, "ADD", self._mixed, 0.5)
        inside.node.use_clamp = True
        near = math_node(tree, "LESS_THAN", math_node(tree, "ABSOLUTE", self._mixed), 0.5)
        excess = math_node(tree, "SUBTRACT", sum_over(tree, self._geometry, inside), wanted)
        count = math_node(tree, "MAXIMUM", sum_over(tree, self._geometry, near), 1.0)
        level = math_node(tree, "DIVIDE", excess, count)
        return clamped(tree, level, -0.5, 0.5)

    def _index(self) -> bpy.types.NodeSocket:
        """Return the index of the sample at the position in cells."""
        tree = self.tree
        cell = vector_math_node(tree, "FLOOR", vector_math_node(tree, "ADD", position_node(tree), (0.5, 0.5, 0.5)))
        return vector_math_node(tree, "DOT_PRODUCT", cell, self._grid.strides)

    def _evened(self, mesh: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
        """Move vertices to the mean of their neighbors, and back onto the surface by Newton steps."""
        tree = self.tree
        inputs = {"Iterations": _EVENING_ROUNDS}
        blur = new_node(tree, "GeometryNodeBlurAttribute", inputs, data_type="FLOAT_VECTOR")
        feed(tree, [next(s for s in blur.inputs if s.enabled)], [position_node(tree)])
        mesh = set_position(tree, mesh, position=next(s for s in blur.outputs if s.enabled))
        for _ in range(_NEWTON_STEPS):
            found = self.sampled(position_node(tree))
            lengths = vector_math_node(tree, "DOT_PRODUCT", found.gradient, found.gradient)
            missing = math_node(tree, "SUBTRACT", self.level, found.value)
            step = math_node(tree, "DIVIDE", missing, math_node(tree, "MAXIMUM", lengths, _LEAST_SLOPE**2))
            step = clamped(tree, step, -_LONGEST_STEP, _LONGEST_STEP)
            step = math_node(tree, "MULTIPLY", step, self._grid.spacing)
            mesh = set_position(tree, mesh, offset=vector_math_node(tree, "SCALE", found.gradient, step))
        return mesh

    def _sample(
        self, geometry: bpy.types.NodeSocket, field: bpy.types.NodeSocket, position: bpy.types.NodeSocket
    ) -> Sampled:
        inputs = {0: geometry, 1: field, 2: position}
        node = new_node(self.tree, "GeometryNodeGroup", inputs, node_tree=self._fields.sampler)
        return Sampled(node.outputs["Value"], node.outputs["Gradient"])
