# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Geometry Nodes that show mixtures of baked blends: the surface of mixed fields, projected onto the baked meshes.

Fields contain nothing smaller than their cells. Every vertex is therefore moved along its normal by the difference
between the distances to the baked meshes and the fields, so that a mixture of a single blend equals that blend. It
takes colors, weights and velocities from the closest points of the meshes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import bpy
import numpy as np

from ...nodes.node_math import (
    math_node,
    new_node,
    stored_attribute,
    switch,
    total,
    vector_math_node,
    weighted_sum,
    weighted_vectors,
)
from ..frame_switch import FrameSwitch
from ..looks.frame_attributes import CUSTOM_NORMAL, LOOKS, SOURCE_WEIGHT, VELOCITY
from ..stored import WEIGHTS_KEY, frame_weights
from .enclosed_volume import with_volume
from .field_nodes import FieldMixture, Term
from .field_sampler import set_position
from .laid_mixture import LaidMixture
from .moved_frames import HAS
from .stored_fields import COLOR, ENCLOSED, Column

DETAIL = "Detail"
"""Input: whether the surface is projected onto the baked meshes."""

DETAIL_TIP = "Lay the surface onto the baked meshes; without it, it is coarser and plays two to three times as fast"

INTERPOLATE = "Interpolate"
"""Input of a modifier: whether blends are mixed, or the nearest baked one is shown."""

# Column of the table of steps: whether a blend is an unchanged shape.
_SHAPE = "shape"
# With a weight above this, a mixture counts as a single blend.
_ALONE = 1.0 - 1e-3
# Vertices are moved by at most this many cells to enclose the mixed volume; where a mixture misses a thin part, the
# rest must not swell visibly (docs/performance, "Moments of players").
_MOST_INFLATED = 0.2
# Data types in nodes, which have no vectors of two numbers, by those of attributes.
_KINDS = {
    "FLOAT": "FLOAT",
    "FLOAT2": "FLOAT_VECTOR",
    "FLOAT_VECTOR": "FLOAT_VECTOR",
    "BYTE_COLOR": "FLOAT_COLOR",
    "FLOAT_COLOR": "FLOAT_COLOR",
}
_OWN = ("position", CUSTOM_NORMAL, LOOKS)


def carried_attributes(frames: Sequence[bpy.types.Object]) -> dict[str, str]:
    """Return the names of the point attributes of the meshes of blends, with their data types in nodes.

    The weights of the shapes are left out, because they are the same at all points.
    """
    return {
        attribute.name: _KINDS[attribute.data_type]
        for obj in frames
        for attribute in obj.data.attributes
        if attribute.domain == "POINT"
        and attribute.data_type in _KINDS
        and attribute.name not in _OWN
        and not attribute.name.startswith((".", SOURCE_WEIGHT.format("")))
    }


def carried_uv_maps(frames: Sequence[bpy.types.Object]) -> list[str]:
    """Return the names of the UV maps that the materials of blends read."""
    blends = [obj for obj in frames if LOOKS in obj.data.attributes]
    return list(dict.fromkeys(layer.name for obj in blends for layer in obj.data.uv_layers))


def is_shape(frame: bpy.types.Object) -> bool:
    """Return whether a frame object shows an unchanged shape."""
    return max(frame[WEIGHTS_KEY]) == 1.0


def columns_of(frames: Sequence[bpy.types.Object]) -> list[Column]:
    """Return the columns of the table of steps for :class:`MixedFrames`."""
    weights = frame_weights(frames)
    shapes = np.array([float(is_shape(obj)) for obj in frames])
    columns = [Column(SOURCE_WEIGHT.format(number), "FLOAT", own) for number, own in enumerate(weights.T, start=1)]
    columns.append(Column(_SHAPE, "FLOAT", shapes))
    for name in carried_attributes(frames):
        has = [float(name in obj.data.attributes) for obj in frames]
        columns.append(Column(HAS.format(name), "FLOAT", np.array(has)))
    return columns


@dataclass(frozen=True)
class SeenMixture:
    """A visible mixture.

    Attributes
    ----------
    geometry : bpy.types.NodeSocket
        Its mesh, with the materials of the blends.
    color : bpy.types.NodeSocket
        The mixed color of the frame objects.
    is_shape : bpy.types.NodeSocket
        1 if it is an unchanged shape, which has its own mesh; otherwise 0.
    """

    geometry: bpy.types.NodeSocket
    color: bpy.types.NodeSocket
    is_shape: bpy.types.NodeSocket


@dataclass(frozen=True)
class MixedFrames:
    """A mixture of baked blends in a node tree.

    Attributes
    ----------
    mixture : FieldMixture
        Terms of the mixture, of fields with the columns of `columns_of`.
    blends : FrameSwitch
        The blends.
    targets : sequence of bpy.types.NodeSocket or None
        What the surface is projected onto, one mesh per term about the center of its blend; None for the baked meshes.
    """

    mixture: FieldMixture
    blends: FrameSwitch
    targets: Sequence[bpy.types.NodeSocket] | None = None

    @property
    def tree(self) -> bpy.types.NodeTree:
        """The node group of the nodes."""
        return self.mixture.tree

    def geometry(
        self,
        detail: bpy.types.NodeSocket,
        velocity: bpy.types.NodeSocket | None = None,
        pace: bpy.types.NodeSocket | None = None,
    ) -> bpy.types.NodeSocket:
        """Return the mesh around the center of the blends, with the attributes of the meshes.

        Parameters
        ----------
        detail : bpy.types.NodeSocket
            Whether it is projected onto the baked meshes.
        velocity : bpy.types.NodeSocket or None
            Velocity of points whose meshes have none.
        pace : bpy.types.NodeSocket or None
            Factor for velocities; without it there are none.
        """
        laid = self._laid(self.mixture.terms, self.targets)
        surface = self.mixture.surface()
        on_meshes = self._smooth(set_position(self.tree, surface, offset=laid.correction()))
        if any(CUSTOM_NORMAL in obj.data.attributes for obj in self.blends.frames):
            on_meshes = self._shaded(on_meshes, laid.normal())
        shown = switch(self.tree, "GEOMETRY", detail, self._smooth(surface), on_meshes)
        volume = self.mixed_column("FLOAT", ENCLOSED)
        shown = with_volume(self.tree, shown, volume, _MOST_INFLATED * self.mixture.spacing)
        for number in range(1, len(self.blends.frames[0][WEIGHTS_KEY]) + 1):
            name = SOURCE_WEIGHT.format(number)
            shown = stored_attribute(self.tree, shown, name, self.mixed_column("FLOAT", name))
        shown = switch(self.tree, "GEOMETRY", detail, shown, self._with_uv_maps(shown))
        names = carried_attributes(self.blends.frames)
        if names:
            shown, points = laid.with_nearest(shown, "POINT")
        for name, kind in names.items():
            if name != VELOCITY:
                mixed = self._mixed(kind, laid.at_points(kind, name, points), self._shares(name))
                shown = stored_attribute(self.tree, shown, name, mixed, kind)
        if pace is None:
            return shown
        if VELOCITY in names:
            values = laid.at_points("FLOAT_VECTOR", VELOCITY, points)
            velocity = self._mixed("FLOAT_VECTOR", values, self._shares(VELOCITY))
        if velocity is not None:
            velocity = vector_math_node(self.tree, "SCALE", velocity, pace)
            shown = stored_attribute(self.tree, shown, VELOCITY, velocity, "FLOAT_VECTOR")
        return shown

    def _with_uv_maps(self, geometry: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
        """Return a mesh with the UV maps of the largest blend, and the mark of meshes that have them."""
        names = carried_uv_maps(self.blends.frames)
        if not any(LOOKS in obj.data.attributes for obj in self.blends.frames):
            return geometry
        laid = self._laid([self._largest_blend()])
        for name in names:
            geometry = stored_attribute(self.tree, geometry, name, laid.at_corners(name), "FLOAT2", "CORNER")
        mark = self.tree.nodes.new("ShaderNodeValue")
        mark.outputs[0].default_value = 1.0
        return stored_attribute(self.tree, geometry, LOOKS, mark.outputs[0])

    @property
    def color(self) -> bpy.types.NodeSocket:
        """Return the mixed color of the frame objects."""
        return self.mixed_column("FLOAT_COLOR", COLOR)

    @property
    def is_shape(self) -> bpy.types.NodeSocket:
        """Return 1 if the whole mixture is an unchanged shape, otherwise 0."""
        tree, found = self.tree, []
        for term in self.mixture.terms:
            alone = math_node(tree, "GREATER_THAN", term.weight, _ALONE)
            found.append(math_node(tree, "MULTIPLY", alone, self.mixture.of_step("FLOAT", _SHAPE, term)))
        return total(tree, found)

    def mixed_column(self, kind: str, name: str) -> bpy.types.NodeSocket:
        """Return the mean of numbers, vectors or colors in the table of steps."""
        return self._mixed(kind, self.mixture.of_steps(kind, name), self.mixture.weights)

    def with_materials(self, geometry: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
        """Return a mesh with the material of the blends; if there are several, with that of the nearest face."""
        blends = [obj for obj in self.blends.frames if not is_shape(obj)] or self.blends.frames
        used = dict.fromkeys(slot.material for obj in blends for slot in obj.material_slots if slot.material)
        if len(used) < 2:
            return self._with_material(geometry, next(iter(used), None))
        laid = self._laid([self._largest_blend()])
        geometry, (face,) = laid.with_nearest(geometry, "FACE")
        for material in used:
            geometry = self._with_material(geometry, material, laid.has_material(material, face))
        return geometry

    def _laid(self, terms: Sequence[Term], targets: Sequence[bpy.types.NodeSocket] | None = None) -> LaidMixture:
        """Return the closest points on the meshes of some terms, by default the baked ones."""
        if targets is None:
            targets = [self.blends.at(self.tree, term.index)["Geometry"] for term in terms]
        return LaidMixture(self.mixture, terms, targets)

    def _largest_blend(self) -> Term:
        """Return the term with the largest weight among those that are not unchanged shapes."""
        tree, best = self.tree, None
        for term in self.mixture.terms:
            shape = self.mixture.of_step("FLOAT", _SHAPE, term)
            weight = math_node(tree, "SUBTRACT", term.weight, math_node(tree, "MULTIPLY", shape, 2.0))
            if best is None:
                best = Term(term.index, weight)
                continue
            more = math_node(tree, "GREATER_THAN", weight, best.weight)
            index = switch(tree, "FLOAT", more, best.index, term.index)
            best = Term(index, math_node(tree, "MAXIMUM", weight, best.weight))
        return best

    def _with_material(
        self,
        geometry: bpy.types.NodeSocket,
        material: bpy.types.Material | None,
        selection: bpy.types.NodeSocket | None = None,
    ) -> bpy.types.NodeSocket:
        inputs = {"Material": material, "Geometry": geometry, "Selection": True if selection is None else selection}
        return new_node(self.tree, "GeometryNodeSetMaterial", inputs).outputs["Geometry"]

    def _shares(self, name: str) -> list[bpy.types.NodeSocket]:
        """Return the weights of the meshes for an attribute: 0 for those without it."""
        tree = self.tree
        has = zip(self.mixture.of_steps("FLOAT", HAS.format(name)), self.mixture.weights, strict=True)
        own = [math_node(tree, "MULTIPLY", *both) for both in has]
        whole = math_node(tree, "MAXIMUM", total(tree, own), 1e-6)
        return [math_node(tree, "DIVIDE", one, whole) for one in own]

    def _mixed(
        self, kind: str, values: Sequence[bpy.types.NodeSocket], shares: Sequence[bpy.types.NodeSocket]
    ) -> bpy.types.NodeSocket:
        return (weighted_sum if kind == "FLOAT" else weighted_vectors)(self.tree, values, shares)

    def _shaded(self, mesh: bpy.types.NodeSocket, normal: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
        """Return a mesh with other point normals."""
        inputs = {"Mesh": mesh, "Custom Normal": normal}
        return new_node(self.tree, "GeometryNodeSetMeshNormal", inputs, mode="FREE", domain="POINT").outputs["Mesh"]

    def _smooth(self, geometry: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
        return new_node(self.tree, "GeometryNodeSetShadeSmooth", {"Geometry": geometry}).outputs["Geometry"]
