# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Show one channel of a material, such as its roughness, as emitted light, so that Cycles can bake it.

Cycles' own passes leave colors of metals black and have no pass for metallic and alpha. The channel is therefore read
from the shaders of the material, through Mix Shader, Add Shader and groups, and linked to an Emission shader.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import bpy

from ..files.image_files import files_in_frame
from ..nodes.node_math import Value, math_node, new_node, vector_math_node
from ..nodes.node_trees import own_tree
from ..nodes.shown_nodes import linked_output, nodes_of, shown_tree, source_node

_METALS = ("BSDF_GLOSSY", "BSDF_METALLIC")


@dataclass(frozen=True)
class Channel:
    """A channel of the Principled BSDF.

    Attributes
    ----------
    name : str
        As in the Principled BSDF.
    inputs : tuple of str
        Names of the inputs of shaders that hold it.
    default : (r, g, b)
        Its value without a material.
    is_color : bool
        Whether its images are sRGB encoded.
    """

    name: str
    inputs: tuple[str, ...]
    default: tuple[float, float, float]
    is_color: bool = False


BASE_COLOR = Channel("Base Color", ("Base Color", "Color"), (0.8, 0.8, 0.8), is_color=True)
EMISSION = Channel("Emission", (), (0.0, 0.0, 0.0), is_color=True)
METALLIC = Channel("Metallic", ("Metallic",), (0.0, 0.0, 0.0))
ROUGHNESS = Channel("Roughness", ("Roughness",), (0.5, 0.5, 0.5))
ALPHA = Channel("Alpha", ("Alpha",), (1.0, 1.0, 1.0))
NORMAL = Channel("Normal", (), (0.5, 0.5, 1.0))
VALUES = (BASE_COLOR, METALLIC, ROUGHNESS, ALPHA, EMISSION)
"""The channels that are values of sockets; the base color is the first."""

_BLACK, _WHITE = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)
# Larger than all values of textures.
_NEVER_REACHED = 1e38


@dataclass(frozen=True)
class ShownChannel:
    """A material that emits a channel.

    Attributes
    ----------
    material : bpy.types.Material
        New.
    groups : list of bpy.types.NodeTree
        New groups that it uses.
    value : (r, g, b) or None
        The channel if it is the same everywhere.
    """

    material: bpy.types.Material
    groups: list[bpy.types.NodeTree]
    value: tuple[float, float, float] | None


def shown_channel(source: bpy.types.Material | None, channel: Channel) -> ShownChannel:
    """Create a material that emits a channel of another one, or of none."""
    if source is None or shown_tree(source) is None:
        material = bpy.data.materials.new("Channel")
        tree = own_tree(material)
        value = _without_nodes(source, channel)
        groups = []
    else:
        material = source.copy()
        tree = material.node_tree
        reader = _Reader(channel, [], _reads_alpha(source))
        output = tree.get_output_node("CYCLES") or tree.get_output_node("ALL")
        value = channel.default if output is None else reader.of(tree, output.inputs["Surface"])
        groups = reader.groups
    output = tree.get_output_node("CYCLES") or tree.get_output_node("ALL") or tree.nodes.new("ShaderNodeOutputMaterial")
    for own in output.inputs:
        for link in list(own.links):
            tree.links.remove(link)
    color = value if isinstance(value, bpy.types.NodeSocket) else (*value, 1.0)
    emission = new_node(tree, "ShaderNodeEmission", {"Color": color})
    tree.links.new(emission.outputs[0], output.inputs["Surface"])
    return ShownChannel(material, groups, None if isinstance(value, bpy.types.NodeSocket) else value)


def has_normals(materials: Sequence[bpy.types.Material | None]) -> bool:
    """Return whether any of the materials changes the normals of a surface."""
    return any(
        node.inputs[name].is_linked
        for node in nodes_of(materials)
        for name in ("Normal", "Displacement")
        if _takes(node, name)
    )


def missing_images(materials: Sequence[bpy.types.Material | None], frame: int) -> list[bpy.types.Image]:
    """Return images in materials of which a file does not exist that is read in a scene frame."""
    shown = [node for node in nodes_of(materials) if node.type == "TEX_IMAGE" and node.image is not None]
    files = ((node.image, file) for node in shown for file in files_in_frame(node.image, node.image_user, frame))
    return list(dict.fromkeys(image for image, file in files if not file.is_file()))


def _takes(node: bpy.types.Node, name: str) -> bool:
    """Return whether a node is a shader or output with an input of a name."""
    return name in node.inputs and (node.type.startswith("BSDF") or node.type == "OUTPUT_MATERIAL")


def _reads_alpha(material: bpy.types.Material) -> bool:
    """Return whether a material reads the alpha of an image."""
    return any(node.type == "TEX_IMAGE" and node.outputs["Alpha"].is_linked for node in nodes_of([material]))


def _is_transparent(socket: bpy.types.NodeSocket) -> bool:
    """Return whether a Transparent BSDF is linked to a shader input."""
    node = source_node(socket)
    return node is not None and node.type == "BSDF_TRANSPARENT"


def _without_nodes(material: bpy.types.Material | None, channel: Channel) -> tuple[float, float, float]:
    """Return a channel of a material without nodes."""
    if material is None:
        return channel.default
    own = {
        BASE_COLOR: tuple(material.diffuse_color[:3]),
        METALLIC: (material.metallic,) * 3,
        ROUGHNESS: (material.roughness,) * 3,
    }
    return own.get(channel, channel.default)


@dataclass
class _Reader:
    """Reads a channel from shaders.

    Attributes
    ----------
    channel : Channel
        The channel.
    groups : list of bpy.types.NodeTree
        Copies of groups, with an output for the channel.
    reads_alpha : bool
        Whether the material reads the alpha of an image.
    """

    channel: Channel
    groups: list[bpy.types.NodeTree]
    reads_alpha: bool

    def of(self, tree: bpy.types.NodeTree, socket: bpy.types.NodeSocket) -> Value:
        """Return the channel of what is linked to a shader input."""
        node = source_node(socket)
        if node is None:
            return self.channel.default if self.channel != BASE_COLOR else _BLACK
        if node.type == "MIX_SHADER":
            return self._of_mixture(tree, node)
        if node.type == "ADD_SHADER":
            return self._of_sum(tree, node)
        if node.type == "GROUP" and node.node_tree is not None:
            return self._of_group(node, linked_output(socket))
        return self._using_all(tree, node, self._of_shader(tree, node))

    def _using_all(self, tree: bpy.types.NodeTree, node: bpy.types.Node, value: Value) -> Value:
        """Return the same value, computed such that everything linked to a node is in use.

        Cycles divides the colors of an image by its alpha only where the alpha is in use, too.
        """
        if not (self.reads_alpha and isinstance(value, bpy.types.NodeSocket)):
            return value
        for source in filter(None, map(linked_output, node.inputs)):
            if source.type != "SHADER":
                nothing = math_node(tree, "GREATER_THAN", source, _NEVER_REACHED)
                value = vector_math_node(tree, "ADD", value, nothing)
        return value

    def _of_mixture(self, tree: bpy.types.NodeTree, node: bpy.types.Node) -> Value:
        """Mix the channels of two shaders; what is mixed with transparency keeps its own, and has an alpha instead."""
        solid = [socket for socket in node.inputs[1:] if not _is_transparent(socket)]
        if self.channel != ALPHA and len(solid) == 1:
            return self._using_all(tree, node, self.of(tree, solid[0]))
        return _mixed(tree, node.inputs[0], *(self.of(tree, socket) for socket in node.inputs[1:]))

    def _of_sum(self, tree: bpy.types.NodeTree, node: bpy.types.Node) -> Value:
        """Add emissions; other channels are those of the first shader that does not only emit."""
        if self.channel == EMISSION:
            return vector_math_node(tree, "ADD", *(self.of(tree, socket) for socket in node.inputs))
        sources = [source_node(socket) for socket in node.inputs]
        solid = next((k for k, own in enumerate(sources) if own is not None and own.type != "EMISSION"), 0)
        return self.of(tree, node.inputs[solid])

    def _of_group(self, node: bpy.types.Node, shader: bpy.types.NodeSocket) -> Value:
        """Add an output with the channel of a shader output to a copy of a group."""
        copy = node.node_tree.copy()
        self.groups.append(copy)
        result = next((own for own in copy.nodes if own.type == "GROUP_OUTPUT" and own.is_active_output), None)
        if result is None:
            return self.channel.default
        inner = next(own for own in result.inputs if own.identifier == shader.identifier)
        value = self.of(copy, inner)
        if not isinstance(value, bpy.types.NodeSocket):
            return value
        made = copy.interface.new_socket("Channel", in_out="OUTPUT", socket_type="NodeSocketColor")
        copy.links.new(value, next(own for own in result.inputs if own.identifier == made.identifier))
        node.node_tree = copy
        return next(own for own in node.outputs if own.identifier == made.identifier)

    def _of_shader(self, tree: bpy.types.NodeTree, node: bpy.types.Node) -> Value:
        if self.channel == EMISSION:
            return _emission(tree, node)
        if node.type == "EMISSION":
            return _BLACK if self.channel == BASE_COLOR else self.channel.default
        if self.channel == METALLIC and node.type in _METALS:
            return _WHITE
        if self.channel == ALPHA and node.type == "BSDF_TRANSPARENT":
            return _BLACK
        name = next((name for name in self.channel.inputs if name in node.inputs), None)
        return self.channel.default if name is None else _value(node.inputs[name])


def _emission(tree: bpy.types.NodeTree, node: bpy.types.Node) -> Value:
    """Return the light that a shader emits."""
    names = {"EMISSION": ("Color", "Strength"), "BSDF_PRINCIPLED": ("Emission Color", "Emission Strength")}
    if node.type not in names:
        return _BLACK
    color, strength = (_value(node.inputs[name]) for name in names[node.type])
    if not isinstance(strength, bpy.types.NodeSocket):
        if strength[0] == 0.0:
            return _BLACK
        if not isinstance(color, bpy.types.NodeSocket):
            return tuple(strength[0] * own for own in color)
    return vector_math_node(tree, "MULTIPLY", color, strength)


def _value(socket: bpy.types.NodeSocket) -> Value:
    """Return what is linked to an input, or its own value as a color."""
    if source_node(socket) is not None:
        return socket.links[0].from_socket
    own = socket.default_value
    return (own,) * 3 if isinstance(own, float) else tuple(own)[:3]


def _mixed(tree: bpy.types.NodeTree, factor: bpy.types.NodeSocket, first: Value, second: Value) -> Value:
    """Return the mixture of two values by the factor of a Mix Shader."""
    if not any(isinstance(own, bpy.types.NodeSocket) for own in (first, second)) and first == second:
        return first
    share = _value(factor)
    difference = vector_math_node(tree, "SUBTRACT", second, first)
    return vector_math_node(tree, "MULTIPLY_ADD", difference, share, first)
