# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Find what the frames of a morph do not show of the materials of the inputs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import bpy
import numpy as np

from ....applications.morphs.appearance import Appearance, Plain
from ....applications.morphs.diagnostics import Diagnostic
from ...keyframes import has_animation
from ...nodes.node_trees import node_trees
from ...nodes.shown_nodes import nodes_of, shown_output
from .appearance import upstream_links
from .materials import base_color, is_object_color, principled_of
from .mixed_materials import emission_node

# Kinds of diagnostics, in the order in which they are shown.
_PROCEDURAL, _SHADER, _MISSING, _NODES = "LOOK_PROCEDURAL", "LOOK_SHADER", "LOOK_MISSING", "LOOK_NODES"
_ANIMATED, _PASSES = "LOOK_ANIMATED", "LOOK_AOV"
_NORMALS, _MAPS, _TILES, _BLURRED = "LOOK_NORMALS", "LOOK_MAPS", "LOOK_TILES", "LOOK_BLURRED"
_VOLUME, _SPACE = "LOOK_VOLUME", "LOOK_SPACE"
_ORDER = (
    _PROCEDURAL,
    _SHADER,
    _MISSING,
    _NODES,
    _ANIMATED,
    _NORMALS,
    _MAPS,
    _TILES,
    _VOLUME,
    _SPACE,
    _PASSES,
    _BLURRED,
)
_NORMAL_SOCKETS = ("Normal", "Coat Normal", "Tangent")
_COLOR_NODES = ("TEX_IMAGE", "VERTEX_COLOR", "ATTRIBUTE")


@dataclass(frozen=True)
class DroppedPart:
    """Something that frames do not show.

    Attributes
    ----------
    kind : str
        Kind of the diagnostic; see :mod:`.diagnostics`.
    material : str
        Name of the material.
    sockets : tuple of str
        Names of the shader sockets whose textures are ignored.
    """

    kind: str
    material: str
    sockets: tuple[str, ...] = ()


def dropped_parts(mesh: bpy.types.Mesh, appearance: Appearance) -> list[DroppedPart]:
    """Find what frames do not show of the materials of an input.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        A frozen copy.
    appearance : Appearance
        Its colors and materials, as they were read.
    """
    found = []
    for slot in np.unique(appearance.materials):
        material = mesh.materials[slot] if len(mesh.materials) else None
        if material is not None and material.node_tree is not None:
            found += _of_material(material, is_plain=isinstance(appearance.paints[slot], Plain))
    return found


def dropped_passes(materials: Sequence[bpy.types.Material]) -> list[DroppedPart]:
    """Find the passes of materials that no frames have, whatever they have of the nodes."""
    passing = [own for own in materials if any(node.type == "OUTPUT_AOV" for node in nodes_of([own]))]
    return [DroppedPart(_PASSES, material.name) for material in passing]


def dropped_with_looks(materials: Sequence[bpy.types.Material]) -> list[DroppedPart]:
    """Find what frames do not show of materials whose nodes they have completely."""
    found = []
    for material in materials:
        output = shown_output(material.node_tree)
        if output is not None and output.inputs["Volume"].is_linked:
            found.append(DroppedPart(_VOLUME, material.name))
        if any(node.type == "NORMAL_MAP" and node.space != "TANGENT" for node in nodes_of([material])):
            found.append(DroppedPart(_SPACE, material.name))
        data = material.node_tree.animation_data
        if data is not None and data.nla_tracks:
            found.append(DroppedPart(_ANIMATED, material.name))
    return found


def dropped_notes(names: Sequence[str], dropped: Sequence[Sequence[DroppedPart]]) -> list[Diagnostic]:
    """Return diagnostics about the inputs with these names, the worst first."""
    notes = []
    for kind in _ORDER:
        own = [(name, one) for name, parts in zip(names, dropped, strict=True) for one in parts if one.kind == kind]
        if own:
            # Shapes may share materials.
            materials = dict.fromkeys(one.material for _, one in own)
            sockets = dict.fromkeys(socket for _, one in own for socket in one.sockets)
            values = {"materials": ", ".join(materials), "names": ", ".join(dict.fromkeys(name for name, _ in own))}
            notes.append(Diagnostic(kind, values | ({"sockets": ", ".join(sockets)} if sockets else {})))
    return notes


def _of_material(material: bpy.types.Material, is_plain: bool) -> Iterator[DroppedPart]:
    output = shown_output(material.node_tree)
    emitter, shader = emission_node(material), principled_of(material)
    if any(has_animation(tree) for tree in node_trees(material.node_tree)):
        yield DroppedPart(_ANIMATED, material.name)
    if output is not None and _links_other_shaders(output):
        yield DroppedPart(_SHADER, material.name)
    if output is not None and output.inputs["Displacement"].is_linked:
        yield DroppedPart(_NORMALS, material.name)
    shown = emitter or shader
    if shown is None:
        return
    if shown == shader:
        yield from _of_base_color(material, is_plain)
        if any(shader.inputs[name].is_linked for name in _NORMAL_SOCKETS):
            yield DroppedPart(_NORMALS, material.name)
    known = ("Base Color", *_NORMAL_SOCKETS)
    linked = tuple(socket.name for socket in shown.inputs if socket.is_linked and socket.name not in known)
    if linked:
        yield DroppedPart(_MAPS, material.name, linked)


def _links_other_shaders(output: bpy.types.Node) -> bool:
    """Return whether anything but a single Principled BSDF or Emission is linked to the output."""
    links = [*output.inputs["Surface"].links, *output.inputs["Volume"].links]
    return any(link.from_node.type not in ("BSDF_PRINCIPLED", "EMISSION") for link in links)


def _of_base_color(material: bpy.types.Material, is_plain: bool) -> Iterator[DroppedPart]:
    base = base_color(material)
    if not base.is_linked:
        return
    links = upstream_links(base)
    images = [link.from_node for link in links if link.from_node.type == "TEX_IMAGE"]
    if is_plain:
        if not is_object_color(links[0].from_socket):
            has_color = any(is_object_color(link.from_socket) for link in links)
            yield DroppedPart(_NODES if has_color else _MISSING if images else _PROCEDURAL, material.name)
        return
    if links[0].from_node.type not in _COLOR_NODES or links[0].from_socket.name != "Color":
        yield DroppedPart(_NODES, material.name)
    if images:
        is_tiled = images[0].image is not None and images[0].image.source == "TILED"
        yield DroppedPart(_TILES if is_tiled else _BLURRED, material.name)
