# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials of frames that mix the shaders of the inputs' material slots at every point."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import bpy

from ...edited_materials import remember_made
from ...handles import Handle, found
from ...nodes.node_math import new_node
from ...nodes.shown_nodes import shown_output
from ...unused_data import remove_if_unused
from .frame_attributes import COLOR, LOOK, SOURCE_WEIGHT
from .look_mixing import MixedLook, group_look, show_looks
from .materials import ROUGHNESS, drop_unused_groups, mark_as_frames, principled_of, wire

EMISSION = "Emission Color"
"""Key of the emitted light: color times strength."""

_STRENGTH = "Emission Strength"
# Emission is mixed as one value, and the base color comes from an attribute.
_LEFT_OUT = ("Base Color", EMISSION, _STRENGTH, "Weight")

# Settings of materials besides their nodes, which frames have if all of their materials agree.
_SETTINGS = ("surface_render_method", "use_backface_culling", "use_transparent_shadow")
# The one in which only materials with a displacement have a say.
_DISPLACEMENT = "displacement_method"

Value = tuple[float, ...]


@dataclass(frozen=True)
class ShaderValues:
    """The unlinked values of a material's shader, by the socket names of the Principled BSDF.

    Attributes
    ----------
    values : dict of str to tuple of float
        Scalars have one component, colors four. Linked sockets and sockets of other shaders are left out; `EMISSION` is
        only present if light is emitted.
    """

    values: Mapping[str, Value] = field(default_factory=dict)

    @classmethod
    def of(cls, material: bpy.types.Material | None) -> ShaderValues:
        """Read the values of a material."""
        if material is None:
            return cls()
        emitter = emission_node(material)
        if emitter is not None:
            return cls({EMISSION: _emitted(emitter.inputs["Color"], emitter.inputs["Strength"])})
        shader = principled_of(material)
        if shader is None:
            return cls()
        values = {socket.name: _value(socket) for socket in shader.inputs if _is_mixed(socket)}
        light = _emitted(shader.inputs[EMISSION], shader.inputs[_STRENGTH])
        return cls(values | ({EMISSION: light} if any(light[:3]) else {}))


def emission_node(material: bpy.types.Material) -> bpy.types.Node | None:
    """Return the Emission shader if it is linked directly to the surface output, else None."""
    output = shown_output(material.node_tree) if material.node_tree else None
    links = output.inputs["Surface"].links if output is not None else ()
    node = links[0].from_node if links else None
    return node if node is not None and node.type == "EMISSION" else None


@dataclass(frozen=True)
class WholeLooks:
    """The materials of inputs as node groups.

    Attributes
    ----------
    groups : sequence of sequence of Handle or None
        The group of every slot of every input; None for slots without nodes, and for those that no face has.
    how : str
        How they are mixed; see :func:`.look_mixing.show_looks`.
    """

    groups: Sequence[Sequence[Handle | None]]
    how: str

    def of(self, slots: Sequence[int]) -> list[bpy.types.NodeTree | None]:
        """Return the groups of some slots, one per input."""
        handles = [groups[slot] for groups, slot in zip(self.groups, slots, strict=True)]
        return [None if own is None else own.find() for own in handles]

    def of_input(self, index: int) -> dict[int, bpy.types.NodeTree]:
        """Return the groups of an input by their slots."""
        handles = enumerate(self.groups[index])
        groups = {slot: handle.find() for slot, handle in handles if handle is not None}
        return {slot: group for slot, group in groups.items() if group is not None}


class MixedMaterials:
    """Materials of a morph's frames, one for every combination of input material slots that occurs on a face.

    Parameters
    ----------
    name : str
        Name of the material of the first slots, and of that of empty ones; Blender may append a number.
    slots : sequence of sequence of bpy.types.Material or None
        The material slots of every input, at least one each.
    looks : WholeLooks, optional
        The inputs' materials; without them, only the values of their shaders are mixed.
    """

    def __init__(
        self,
        name: str,
        slots: Sequence[Sequence[bpy.types.Material | None]],
        looks: WholeLooks | None = None,
    ) -> None:
        self._looks, self._name = looks, name
        self._values = [[ShaderValues.of(own) for own in slots_of] for slots_of in slots]
        self._settings = [[_settings(own) for own in slots_of] for slots_of in slots]
        self._names = [["" if own is None else own.name for own in slots_of] for slots_of in slots]
        self._made: dict[tuple[int, ...], Handle] = {}
        self._make((0,) * len(slots), name)

    def of(self, slots: Sequence[int]) -> bpy.types.Material | None:
        """Return the material of faces that come from these slots, one per input; None if it was deleted."""
        key = tuple(slots)
        if key not in self._made:
            own = [names[slot] for names, slot in zip(self._names, key, strict=True)]
            named = " and ".join(dict.fromkeys(filter(None, own)))
            self._make(key, f"Morph {named}" if named else self._name)
        return self._made[key].find()

    @property
    def are_whole(self) -> bool:
        """Whether they are the inputs' own materials."""
        return self._looks is not None

    def drop_unused(self) -> None:
        """Remove materials that no frame uses."""
        remove_if_unused(found(list(self._made.values())))
        drop_unused_groups()

    def _make(self, key: tuple[int, ...], name: str) -> None:
        values = [values[slot] for values, slot in zip(self._values, key, strict=True)]
        material = _carrying_material(name, values)
        if self._looks is not None:
            tree, groups = material.node_tree, self._looks.of(key)
            shares = _shares(tree, len(values))
            looks = [
                _simple_look(tree, number, own, share) if group is None else group_look(tree, group, share)
                for number, (own, group, share) in enumerate(zip(values, groups, shares, strict=True), start=1)
            ]
            show_looks(material, looks, self._looks.how)
            for name, value in _agreed([own[slot] for own, slot in zip(self._settings, key, strict=True)]).items():
                setattr(material, name, value)
        remember_made(material)
        self._made[key] = Handle.of("materials", material)


def _settings(material: bpy.types.Material | None) -> dict[str, object]:
    """Return the settings in which a material has a say; without a material, they are Blender's defaults."""
    if material is None:
        return {name: bpy.types.Material.bl_rna.properties[name].default for name in _SETTINGS}
    return {name: getattr(material, name) for name in _SETTINGS} | _displacement_method(material)


def _agreed(settings: Sequence[Mapping[str, object]]) -> dict[str, object]:
    """Return the settings in which all agree that have a say."""
    values = {name: {own[name] for own in settings if name in own} for name in (*_SETTINGS, _DISPLACEMENT)}
    return {name: own.pop() for name, own in values.items() if len(own) == 1}


def _displacement_method(material: bpy.types.Material) -> dict[str, object]:
    """Return how a material is displaced, which is nothing if it is not."""
    output = shown_output(material.node_tree) if material.node_tree else None
    if output is None or not output.inputs["Displacement"].is_linked:
        return {}
    return {_DISPLACEMENT: getattr(material, _DISPLACEMENT)}


def _simple_look(tree: bpy.types.NodeTree, number: int, shader: ShaderValues, share: bpy.types.NodeSocket) -> MixedLook:
    """Add a shader with the values and the carried color of an input, numbered from 1."""
    principled = tree.nodes.new("ShaderNodeBsdfPrincipled")
    principled.inputs["Roughness"].default_value = ROUGHNESS
    for socket in principled.inputs:
        if socket.name in shader.values and not socket.is_unavailable:
            _set(socket, shader.values[socket.name])
    principled.inputs[_STRENGTH].default_value = 1.0 if EMISSION in shader.values else 0.0
    color = new_node(tree, "ShaderNodeVertexColor", layer_name=LOOK.format(number))
    tree.links.new(color.outputs["Color"], principled.inputs["Base Color"])
    return MixedLook(principled.outputs["BSDF"], None, share)


def _carrying_material(name: str, shaders: Sequence[ShaderValues]) -> bpy.types.Material:
    """Create a material that mixes the shaders of the inputs at every point.

    Its base color is the attribute `COLOR`. All other unlinked values are mixed by `SOURCE_WEIGHT`. Without these
    attributes, and for values that a shader lacks, the defaults of frames are used.
    """
    material = bpy.data.materials.new(name)
    wire(material, "ShaderNodeVertexColor", layer_name=COLOR)
    mark_as_frames(material)
    tree, principled = material.node_tree, principled_of(material)
    shares = _shares(tree, len(shaders))
    for socket in principled.inputs:
        if _is_mixed(socket):
            usual = (ROUGHNESS,) if socket.name == "Roughness" else _value(socket)
            _mix(tree, socket, shares, [one.values.get(socket.name, usual) for one in shaders], usual)
    light = [one.values.get(EMISSION, (0.0, 0.0, 0.0, 1.0)) for one in shaders]
    if any(any(own[:3]) for own in light):
        principled.inputs[_STRENGTH].default_value = 1.0
        _mix(tree, principled.inputs[EMISSION], shares, light, (0.0, 0.0, 0.0, 1.0))
    return material


def _shares(tree: bpy.types.NodeTree, count: int) -> list[bpy.types.NodeSocket]:
    """Return the sockets with the shares of the inputs."""
    sockets = []
    for index in range(1, count + 1):
        settings = {"attribute_name": SOURCE_WEIGHT.format(index), "location": (-1100.0, -200.0 * index)}
        sockets.append(new_node(tree, "ShaderNodeAttribute", **settings).outputs["Fac"])
    return sockets


def _mix(
    tree: bpy.types.NodeTree,
    socket: bpy.types.NodeSocket,
    shares: Sequence[bpy.types.NodeSocket],
    values: Sequence[Value],
    usual: Value,
) -> None:
    """Set a socket to the default plus the inputs' differences from it, weighted by their shares."""
    if all(own == values[0] for own in values):
        _set(socket, values[0])
        return
    is_number = len(usual) == 1
    mixed = None
    for index, (share, own) in enumerate(zip(shares, values, strict=True)):
        sums = tree.nodes.new("ShaderNodeMath" if is_number else "ShaderNodeVectorMath")
        sums.operation = "MULTIPLY_ADD"
        sums.location = (-900.0 + 160.0 * index, socket.node.location.y - 60.0 * list(socket.node.inputs).index(socket))
        tree.links.new(share, sums.inputs[0])
        _set(sums.inputs[1], tuple(a - b for a, b in zip(own, usual, strict=True)))
        _set(sums.inputs[2], usual)
        if mixed is not None:
            tree.links.new(mixed, sums.inputs[2])
        mixed = sums.outputs[0]
    tree.links.new(mixed, socket)


def _is_mixed(socket: bpy.types.NodeSocket) -> bool:
    """Return whether a socket has an unlinked value that frames mix.

    Blender does not find unavailable ones by their names, such as those for another kind of subsurface scattering.
    """
    is_value = socket.type in ("VALUE", "RGBA") and not socket.is_unavailable
    return is_value and socket.name not in _LEFT_OUT and not socket.is_linked


def _value(socket: bpy.types.NodeSocket) -> Value:
    return (socket.default_value,) if socket.type == "VALUE" else tuple(socket.default_value)


def _set(socket: bpy.types.NodeSocket, value: Value) -> None:
    if socket.type == "VALUE":
        socket.default_value = value[0]
    else:
        socket.default_value = value[: len(socket.default_value)]


def _emitted(color: bpy.types.NodeSocket, strength: bpy.types.NodeSocket) -> Value:
    """Return color times strength; a linked color counts as white, a linked strength as zero."""
    power = 0.0 if strength.is_linked else float(strength.default_value)
    plain = (1.0, 1.0, 1.0) if color.is_linked else tuple(color.default_value)[:3]
    return (*(power * channel for channel in plain), 1.0)
