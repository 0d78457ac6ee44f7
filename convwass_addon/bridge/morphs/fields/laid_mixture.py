# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes that lay the surface of a mixture onto baked meshes and read their normals, attributes and UV maps there."""

from __future__ import annotations

from collections.abc import Sequence

import bpy

from ...nodes.node_math import (
    clamped,
    math_node,
    named_attribute,
    new_node,
    total,
    vector_math_node,
    weighted_sum,
    weighted_vectors,
)
from .field_nodes import FieldMixture, Term
from .field_sampler import position_node, sample_index
from .stored_fields import OFFSET

# Closest points are ignored if they are farther away than this, in cells, or if the cosine between their direction and
# the normal is below the second number.
_FAR, _ASIDE = 1.5, 0.5
# Normals are mixed if the cosine of their angle exceeds this.
_AGREES = 0.4
# Largest correction of distances, in cells.
_MOST_CORRECTED = 1.0
# UV maps are read at the center of a face and this share of the way from there to each corner, and continued: the face
# then belongs to one side of all seams. Corners farther away in the texture than the limit are not continued.
_NEAR_CENTER, _MOST_CONTINUED = 0.05, 0.1


class LaidMixture:
    """Closest points of a mixture on the baked meshes of some terms.

    Parameters
    ----------
    mixture : FieldMixture
        The mixture.
    terms : sequence of Term
        Some of its terms.
    targets : sequence of bpy.types.NodeSocket
        The mesh of each term, about the center of its blend.
    """

    def __init__(self, mixture: FieldMixture, terms: Sequence[Term], targets: Sequence[bpy.types.NodeSocket]) -> None:
        tree = self._tree = mixture.tree
        self._mixture, self._terms, self._targets = mixture, list(terms), list(targets)
        self._spacing = mixture.spacing
        offsets = [mixture.of_step("FLOAT_VECTOR", OFFSET, term) for term in terms]
        self._places = [vector_math_node(tree, "ADD", position_node(tree), offset) for offset in offsets]

    def correction(self) -> bpy.types.NodeSocket:
        """Return the vector that moves a vertex to the mixed distance from the meshes."""
        tree, terms = self._tree, self._terms
        normal = tree.nodes.new("GeometryNodeInputNormal").outputs["Normal"]
        own = [self._missing(*each, normal) for each in zip(terms, self._places, self._targets, strict=True)]
        length = math_node(tree, "MULTIPLY", weighted_sum(tree, own, [term.weight for term in terms]), self._spacing)
        return vector_math_node(tree, "SCALE", normal, length)

    def normal(self) -> bpy.types.NodeSocket:
        """Return the mixed normal of the meshes; where they face another way, that of the mixture."""
        tree = self._tree
        own = tree.nodes.new("GeometryNodeInputNormal").outputs["Normal"]
        found, shares = [], []
        for term, place, target in zip(self._terms, self._places, self._targets, strict=True):
            theirs = tree.nodes.new("GeometryNodeInputNormal").outputs["Normal"]
            found.append(self._nearest_on(target, theirs, place))
            agreement = vector_math_node(tree, "DOT_PRODUCT", found[-1], own)
            agrees = math_node(tree, "GREATER_THAN", agreement, _AGREES)
            shares.append(math_node(tree, "MULTIPLY", agrees, term.weight))
        rest = math_node(tree, "SUBTRACT", 1.0, total(tree, shares))
        return vector_math_node(tree, "NORMALIZE", weighted_vectors(tree, [*found, own], [*shares, rest]))

    def with_nearest(
        self, geometry: bpy.types.NodeSocket, domain: str
    ) -> tuple[bpy.types.NodeSocket, list[bpy.types.NodeSocket]]:
        """Return a geometry that stores the index of the nearest point or face of every mesh, and these indices."""
        tree, found = self._tree, []
        capture = new_node(tree, "GeometryNodeCaptureAttribute", {"Geometry": geometry}, domain=domain)
        for number, (place, target) in enumerate(zip(self._places, self._targets, strict=True)):
            node = new_node(tree, "GeometryNodeSampleNearest", {0: target, 1: place}, domain=domain)
            name = f"Nearest {number}"
            capture.capture_items.new("INT", name)
            tree.links.new(node.outputs["Index"], capture.inputs[name])
            found.append(capture.outputs[name])
        return capture.outputs["Geometry"], found

    def has_material(self, material: bpy.types.Material, face: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
        """Return whether a face of the first mesh, by index, has a material."""
        has = new_node(self._tree, "GeometryNodeMaterialSelection", {"Material": material}).outputs["Selection"]
        return sample_index(self._tree, self._targets[0], "BOOLEAN", has, face, domain="FACE")

    def at_points(self, kind: str, name: str, points: Sequence[bpy.types.NodeSocket]) -> list[bpy.types.NodeSocket]:
        """Return an attribute of the nearest points."""
        value = named_attribute(self._tree, name, kind)
        pairs = zip(self._targets, points, strict=True)
        return [sample_index(self._tree, target, kind, value, point) for target, point in pairs]

    def at_corners(self, name: str) -> bpy.types.NodeSocket:
        """Return a UV map of the first mesh for the corners of faces, none of which reaches across a seam."""
        tree, place = self._tree, self._places[0]
        center = _of_face(tree, place)
        way = vector_math_node(tree, "SCALE", vector_math_node(tree, "SUBTRACT", place, center), _NEAR_CENTER)
        middle = _of_face(tree, self._on_surface(name, place))
        beside = self._on_surface(name, vector_math_node(tree, "ADD", center, way))
        step = vector_math_node(tree, "SCALE", vector_math_node(tree, "SUBTRACT", beside, middle), 1.0 / _NEAR_CENTER)
        is_near = math_node(tree, "LESS_THAN", vector_math_node(tree, "LENGTH", step), _MOST_CONTINUED)
        return vector_math_node(tree, "ADD", middle, vector_math_node(tree, "SCALE", step, is_near))

    def _on_surface(self, name: str, place: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
        """Return an attribute at the closest points of the first mesh."""
        return self._nearest_on(self._targets[0], named_attribute(self._tree, name, "FLOAT_VECTOR"), place)

    def _nearest_on(
        self, mesh: bpy.types.NodeSocket, vector: bpy.types.NodeSocket, place: bpy.types.NodeSocket
    ) -> bpy.types.NodeSocket:
        """Return a vector at the closest points of a mesh."""
        inputs = {"Mesh": mesh, "Value": vector, "Sample Position": place}
        node = new_node(self._tree, "GeometryNodeSampleNearestSurface", inputs, data_type="FLOAT_VECTOR")
        return node.outputs["Value"]

    def _missing(
        self,
        term: Term,
        place: bpy.types.NodeSocket,
        target: bpy.types.NodeSocket,
        normal: bpy.types.NodeSocket,
    ) -> bpy.types.NodeSocket:
        """Return by how many cells the distance to a mesh exceeds its field; 0 if unknown."""
        tree = self._tree
        inputs = {0: target, "Sample Position": place}
        node = new_node(tree, "GeometryNodeProximity", inputs, target_element="FACES")
        apart = vector_math_node(tree, "SUBTRACT", node.outputs["Position"], place)
        above = vector_math_node(tree, "DOT_PRODUCT", apart, normal)
        near = math_node(tree, "LESS_THAN", node.outputs["Distance"], _FAR * self._spacing)
        least = math_node(tree, "MULTIPLY", node.outputs["Distance"], _ASIDE)
        straight = math_node(tree, "GREATER_THAN", math_node(tree, "ABSOLUTE", above), least)
        known = math_node(tree, "MULTIPLY", near, straight)
        field = self._mixture.sampled_term(term, position_node(tree))
        missing = math_node(tree, "SUBTRACT", math_node(tree, "DIVIDE", above, self._spacing), field)
        missing = clamped(tree, missing, -_MOST_CORRECTED, _MOST_CORRECTED)
        return math_node(tree, "MULTIPLY", missing, known)


def _of_face(tree: bpy.types.NodeTree, value: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
    """Return a vector as it is for the face of a corner."""
    node = new_node(tree, "GeometryNodeFieldOnDomain", {0: value}, data_type="FLOAT_VECTOR", domain="FACE")
    return next(socket for socket in node.outputs if socket.enabled)
