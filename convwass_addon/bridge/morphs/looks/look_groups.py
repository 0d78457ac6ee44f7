# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Copies of the materials of an input, as node groups that read what frames carry.

Textures of the input are mapped by its UV maps or positions, which frames do not have. In the copies, nodes that would
read these read attributes of frames instead.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import bpy

from ...nodes.node_copies import can_copy, copied_nodes
from ...nodes.node_math import new_node
from ...nodes.node_trees import node_trees
from ...nodes.shown_nodes import shown_output, shown_tree
from ...object_names import numbered_names
from ...object_values import ObjectValues, reads_property
from .frame_attributes import CARRIED, CARRIED_UV, GENERATED, REST_NORMAL, REST_POSITION
from .materials import mark_as_frames

SURFACE, DISPLACEMENT = "Surface", "Displacement"
"""Outputs of the groups."""

GENERATED_TEXTURES = (
    "TEX_NOISE",
    "TEX_VORONOI",
    "TEX_WAVE",
    "TEX_MAGIC",
    "TEX_GRADIENT",
    "TEX_CHECKER",
    "TEX_BRICK",
    "TEX_GABOR",
)
"""Types of textures that use generated coordinates if nothing is linked to their vector."""

# Blender's limit for names of attributes, in bytes.
_LONGEST = 63


@dataclass
class CarriedNames:
    """Names of the attributes with which frames carry what the materials of one input read.

    Attributes
    ----------
    number : int
        Number of the input, from 1.
    uv_maps, attributes : sequence of str
        Names of the UV maps, and of the other attributes and vertex groups that it has.
    default_uv, default_color : str
        The UV map and the color attribute that nodes without a name read; empty if there is none.
    values_of_object : ObjectValues
        What materials read of the object itself.
    material_index : int
        Pass index of the material whose nodes are being copied.
    uvs, values : dict of str to str
        The UV maps and other attributes requested so far: names on the input, by names on frames.
    vectors : set of str
        The positions and normals requested so far: names on frames.
    cut : dict of str to str
        Names on frames of UV maps and other attributes, by what these would be if they could have any length.
    """

    number: int
    uv_maps: Sequence[str]
    attributes: Sequence[str]
    default_uv: str
    default_color: str
    values_of_object: ObjectValues
    material_index: int = 0
    uvs: dict[str, str] = field(default_factory=dict)
    values: dict[str, str] = field(default_factory=dict)
    vectors: set[str] = field(default_factory=set)
    cut: dict[str, str] = field(default_factory=dict)

    def uv(self, name: str) -> str:
        """Return the name on frames of a UV map, by default that of renders; empty if there is none.

        If the input has no map of the name, frames have none of the returned name either.
        """
        own = name or self.default_uv
        if not own:
            return ""
        carried = self._carried(CARRIED_UV, own)
        if own in self.uv_maps:
            self.uvs[carried] = own
        return carried

    def value(self, name: str) -> str:
        """Return the name on frames of another attribute; the same name if there is none."""
        if name in self.uv_maps:
            return self.uv(name)
        if name not in self.attributes:
            return name
        carried = self._carried(CARRIED, name)
        self.values[carried] = name
        return carried

    def vector(self, pattern: str) -> str:
        """Return the name on frames of a position or normal, such as `REST_POSITION`."""
        carried = pattern.format(self.number)
        self.vectors.add(carried)
        return carried

    def _carried(self, pattern: str, name: str) -> str:
        """Return the name on frames of an attribute, which no other one has."""
        whole = pattern.format(self.number, name)
        if whole not in self.cut:
            taken = self.cut.values()
            self.cut[whole] = next(own for own in numbered_names(whole, _LONGEST) if own not in taken)
        return self.cut[whole]


class LookGroups:
    """Node groups of the materials of one input.

    Parameters
    ----------
    names : CarriedNames
        Names on frames; it collects what the groups read.
    """

    def __init__(self, names: CarriedNames) -> None:
        self.names = names
        self._copies: dict[tuple[bpy.types.NodeTree, int], bpy.types.NodeTree] = {}

    def of(self, material: bpy.types.Material) -> bpy.types.NodeTree | None:
        """Return a new group with the outputs `SURFACE` and `DISPLACEMENT`; None if the nodes cannot be copied."""
        if not is_wrapped(material):
            return None
        source = material.node_tree
        output = shown_output(source)
        group = bpy.data.node_groups.new(f"Look of {material.name}", "ShaderNodeTree")
        mark_as_frames(group)
        group.interface.new_socket(SURFACE, in_out="OUTPUT", socket_type="NodeSocketShader")
        group.interface.new_socket(DISPLACEMENT, in_out="OUTPUT", socket_type="NodeSocketVector")
        copies = copied_nodes(source, group)
        result = group.nodes.new("NodeGroupOutput")
        if output is not None:
            result.location = output.location
            for name in (SURFACE, DISPLACEMENT):
                for link in copies[output.name].inputs[name].links:
                    group.links.new(link.from_socket, result.inputs[name])
        for node in list(group.nodes):
            if node.type.startswith("OUTPUT_"):
                group.nodes.remove(node)
        self.names.material_index = material.pass_index
        self._redirect(group)
        return group

    def _redirect(self, tree: bpy.types.NodeTree) -> None:
        for node in list(tree.nodes):
            if node.type == "GROUP" and node.node_tree is not None:
                node.node_tree = self._redirected(node.node_tree)
            elif node.type in GENERATED_TEXTURES:
                _give_vector(tree, node, lambda: _attribute(tree, self.names.vector(GENERATED)))
            elif node.type in _REDIRECTS:
                _REDIRECTS[node.type](tree, node, self.names)

    def _redirected(self, tree: bpy.types.NodeTree) -> bpy.types.NodeTree:
        """Return a copy of a nested group, which materials with the same index share."""
        key = tree, self.names.material_index
        if key not in self._copies:
            copy = self._copies[key] = tree.copy()
            mark_as_frames(copy)
            self._redirect(copy)
        return self._copies[key]


def is_wrapped(material: bpy.types.Material) -> bool:
    """Return whether :class:`LookGroups` can copy a material."""
    tree = shown_tree(material)
    return tree is not None and all(can_copy(own) for own in node_trees(tree))


def _redirect_image(tree: bpy.types.NodeTree, node: bpy.types.Node, names: CarriedNames) -> None:
    if names.uv(""):
        _give_vector(tree, node, lambda: _uv_map(tree, names.uv("")))


def _redirect_coordinates(tree: bpy.types.NodeTree, node: bpy.types.Node, names: CarriedNames) -> None:
    """Replace the outputs of a Texture Coordinate node; those of other objects and of cameras remain."""
    if node.outputs["UV"].is_linked and names.uv(""):
        _relink(tree, node.outputs["UV"], _uv_map(tree, names.uv("")))
    own = {"Generated": GENERATED, "Normal": REST_NORMAL}
    if node.object is None:
        own["Object"] = REST_POSITION
    for name, pattern in own.items():
        if node.outputs[name].is_linked:
            _relink(tree, node.outputs[name], _attribute(tree, names.vector(pattern)))


def _redirect_uv_name(tree: bpy.types.NodeTree, node: bpy.types.Node, names: CarriedNames) -> None:
    """Rename the UV map of a UV Map, Normal Map or Tangent node."""
    if node.type == "NORMAL_MAP" and node.space != "TANGENT":
        return
    if node.type == "TANGENT" and node.direction_type != "UV_MAP":
        return
    # Cycles shows other attributes and vertex groups, too.
    node.uv_map = names.value(node.uv_map) if node.uv_map in names.attributes else names.uv(node.uv_map)


def _redirect_color(tree: bpy.types.NodeTree, node: bpy.types.Node, names: CarriedNames) -> None:
    node.layer_name = names.value(node.layer_name or names.default_color)


def _redirect_attribute(tree: bpy.types.NodeTree, node: bpy.types.Node, names: CarriedNames) -> None:
    if node.attribute_type == "GEOMETRY":
        node.attribute_name = names.value(node.attribute_name)
    elif reads_property(node):
        *color, alpha = names.values_of_object.properties[node.attribute_name]
        shown = {"Color": color, "Vector": color, "Fac": sum(color) / 3.0, "Alpha": alpha}
        _replace_outputs(tree, node, shown)


def _redirect_object(tree: bpy.types.NodeTree, node: bpy.types.Node, names: CarriedNames) -> None:
    """Replace what is read of the object, and the index of the material, which frames do not have."""
    own = names.values_of_object
    shown = {
        "Location": own.location,
        "Color": own.color[:3],
        "Alpha": own.color[3],
        "Object Index": own.index,
        "Material Index": names.material_index,
        "Random": own.random,
    }
    _replace_outputs(tree, node, shown)


_REDIRECTS: dict[str, Callable[[bpy.types.NodeTree, bpy.types.Node, CarriedNames], None]] = {
    "TEX_IMAGE": _redirect_image,
    "TEX_COORD": _redirect_coordinates,
    "UVMAP": _redirect_uv_name,
    "NORMAL_MAP": _redirect_uv_name,
    "TANGENT": _redirect_uv_name,
    "VERTEX_COLOR": _redirect_color,
    "ATTRIBUTE": _redirect_attribute,
    "OBJECT_INFO": _redirect_object,
}


def _give_vector(tree: bpy.types.NodeTree, node: bpy.types.Node, make: Callable[[], bpy.types.NodeSocket]) -> None:
    """Link coordinates to a texture that has none."""
    socket = node.inputs["Vector"]
    if socket.enabled and not socket.is_linked:
        made = make()
        made.node.location = (node.location.x - 200.0, node.location.y)
        tree.links.new(made, socket)


def _uv_map(tree: bpy.types.NodeTree, name: str) -> bpy.types.NodeSocket:
    return new_node(tree, "ShaderNodeUVMap", uv_map=name).outputs["UV"]


def _attribute(tree: bpy.types.NodeTree, name: str) -> bpy.types.NodeSocket:
    return new_node(tree, "ShaderNodeAttribute", attribute_name=name).outputs["Vector"]


def _replace_outputs(
    tree: bpy.types.NodeTree, node: bpy.types.Node, values: Mapping[str, float | Sequence[float]]
) -> None:
    """Replace outputs of a node by constants, by their names."""
    for name, value in values.items():
        if node.outputs[name].is_linked:
            _relink(tree, node.outputs[name], _constant(tree, value))


def _constant(tree: bpy.types.NodeTree, value: float | Sequence[float]) -> bpy.types.NodeSocket:
    """Return a number or a vector; colors are vectors, too, because those of RGB nodes cannot be negative."""
    if isinstance(value, Sequence):
        return new_node(tree, "ShaderNodeCombineXYZ", dict(enumerate(value))).outputs[0]
    socket = tree.nodes.new("ShaderNodeValue").outputs[0]
    socket.default_value = value
    return socket


def _relink(tree: bpy.types.NodeTree, old: bpy.types.NodeSocket, new: bpy.types.NodeSocket) -> None:
    """Move all links of an output to another one."""
    new.node.location = old.node.location
    for link in list(old.links):
        tree.links.new(new, link.to_socket)
