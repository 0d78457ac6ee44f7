# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Geometry nodes that evaluate mixtures of stored fields: their surfaces, and their values at points.

They only use nodes of Blender 4.5 and later: Volume Cube takes the mixture, and Volume to Mesh extracts its surface.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import bpy

from ..node_math import feed, math_node, vector_math_node, weighted_sum
from ..sequence import object_info
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
        self._tree, self._fields, self._grid, self.terms = tree, fields, fields.grid, list(terms)
        self._weights = [term.weight for term in terms]
        # Every further node makes all later changes of the tree slower.
        self._attributes: dict[tuple[str, str], bpy.types.NodeSocket] = {}
        self._of_steps: dict[tuple[str, str, int], bpy.types.NodeSocket] = {}
        self._samples = object_info(tree, fields.samples).outputs["Geometry"]
        self._steps = object_info(tree, fields.steps).outputs["Geometry"]
        own = [self._field_of(term) for term in terms]
        self._geometry = self._stored(weighted_sum(tree, own, self._weights))
        self._mixed = self._attribute("FLOAT", _MIXED)
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
                self._attributes[kind, name] = self._attribute(kind, name)
            self._of_steps[key] = self._at(self._steps, kind, self._attributes[kind, name], term.index)
        return self._of_steps[key]

    def surface(self) -> bpy.types.NodeSocket:
        """Return a quad mesh that encloses the mixed volume, relative to the center of the blends."""
        tree, grid = self._tree, self._grid
        cube = tree.nodes.new("GeometryNodeVolumeCube")
        # In cells, because OpenVDB does not create grids with cells smaller than 1.5e-5.
        cube.inputs["Min"].default_value, cube.inputs["Max"].default_value = (0.0,) * 3, [n - 1.0 for n in grid.shape]
        for axis, count in zip("XYZ", grid.shape, strict=True):
            cube.inputs[f"Resolution {axis}"].default_value = count
        cube.inputs["Background"].default_value = -BAND
        tree.links.new(self._at(self._geometry, "FLOAT", self._mixed, self._index()), cube.inputs["Density"])
        drawn = tree.nodes.new("GeometryNodeVolumeToMesh")
        feed(tree, [drawn.inputs["Volume"], drawn.inputs["Threshold"]], [cube.outputs["Volume"], self.level])
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
        tree = self._tree
        name = tree.nodes.new("FunctionNodeFormatString")
        name.inputs["Format"].default_value = FIELD.replace("{}", "{number}")
        name.format_items.new("INT", "number")
        tree.links.new(term.index, name.inputs["number"])
        steps = self._attribute("FLOAT", name.outputs["String"])
        return math_node(tree, "MULTIPLY", steps, 1.0 / SCALE)

    def _stored(self, mixed: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
        """Return the samples with the mixture stored as an attribute, because it is used several times."""
        tree = self._tree
        node = tree.nodes.new("GeometryNodeStoreNamedAttribute")
        node.data_type, node.domain = "FLOAT", "POINT"
        node.inputs["Name"].default_value = _MIXED
        feed(tree, [node.inputs["Geometry"], node.inputs["Value"]], [self._samples, mixed])
        return node.outputs["Geometry"]

    def _level(self) -> bpy.types.NodeSocket:
        """Return the level at which the mixture encloses the mixed volume, by one Newton step from zero.

        The volume is counted as for `VOLUME`, and its derivative is the number of samples within half a cell.
        """
        tree = self._tree
        wanted = weighted_sum(tree, [self.of_step("FLOAT", VOLUME, term) for term in self.terms], self._weights)
        inside = math_node(tree, "ADD", self._mixed, 0.5)
        inside.node.use_clamp = True
        near = math_node(tree, "LESS_THAN", math_node(tree, "ABSOLUTE", self._mixed), 0.5)
        excess = math_node(tree, "SUBTRACT", self._total(inside), wanted)
        level = math_node(tree, "DIVIDE", excess, math_node(tree, "MAXIMUM", self._total(near), 1.0))
        return math_node(tree, "MAXIMUM", math_node(tree, "MINIMUM", level, 0.5), -0.5)

    def _total(self, values: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
        """Return the sum of a field over all samples."""
        node = self._tree.nodes.new("GeometryNodeAttributeStatistic")
        node.data_type, node.domain = "FLOAT", "POINT"
        feed(self._tree, [node.inputs["Geometry"], node.inputs["Attribute"]], [self._geometry, values])
        return node.outputs["Sum"]

    def _index(self) -> bpy.types.NodeSocket:
        """Return the index of the sample at the position in cells."""
        tree = self._tree
        cell = vector_math_node(tree, "FLOOR", vector_math_node(tree, "ADD", position_node(tree), (0.5, 0.5, 0.5)))
        return vector_math_node(tree, "DOT_PRODUCT", cell, self._grid.strides)

    def _evened(self, mesh: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
        """Move vertices to the mean of their neighbors, and back onto the surface by Newton steps."""
        tree = self._tree
        blur = tree.nodes.new("GeometryNodeBlurAttribute")
        blur.data_type = "FLOAT_VECTOR"
        blur.inputs["Iterations"].default_value = _EVENING_ROUNDS
        feed(tree, [next(s for s in blur.inputs if s.enabled)], [position_node(tree)])
        mesh = set_position(tree, mesh, position=next(s for s in blur.outputs if s.enabled))
        for _ in range(_NEWTON_STEPS):
            found = self.sampled(position_node(tree))
            lengths = vector_math_node(tree, "DOT_PRODUCT", found.gradient, found.gradient)
            missing = math_node(tree, "SUBTRACT", self.level, found.value)
            step = math_node(tree, "DIVIDE", missing, math_node(tree, "MAXIMUM", lengths, _LEAST_SLOPE**2))
            step = math_node(tree, "MAXIMUM", math_node(tree, "MINIMUM", step, _LONGEST_STEP), -_LONGEST_STEP)
            step = math_node(tree, "MULTIPLY", step, self._grid.spacing)
            mesh = set_position(tree, mesh, offset=vector_math_node(tree, "SCALE", found.gradient, step))
        return mesh

    def _sample(
        self, geometry: bpy.types.NodeSocket, field: bpy.types.NodeSocket, position: bpy.types.NodeSocket
    ) -> Sampled:
        node = self._tree.nodes.new("GeometryNodeGroup")
        node.node_tree = self._fields.sampler
        feed(self._tree, node.inputs, [geometry, field, position])
        return Sampled(node.outputs["Value"], node.outputs["Gradient"])

    def _attribute(self, kind: str, name: str | bpy.types.NodeSocket) -> bpy.types.NodeSocket:
        node = self._tree.nodes.new("GeometryNodeInputNamedAttribute")
        node.data_type = kind
        feed(self._tree, [node.inputs["Name"]], [name])
        return next(socket for socket in node.outputs if socket.enabled)

    def _at(
        self, geometry: bpy.types.NodeSocket, kind: str, value: bpy.types.NodeSocket, index: bpy.types.NodeSocket
    ) -> bpy.types.NodeSocket:
        return sample_index(self._tree, geometry, kind, value, index)
