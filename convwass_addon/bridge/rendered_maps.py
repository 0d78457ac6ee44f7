# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The UV map and the color attribute of a mesh that renders use where a material names none."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import bpy

from .element_values import element_values, write_attribute
from .morphs.looks.frame_attributes import COLOR

_SHARED_UVS, _SHARED_COLORS = "UVs of Parts", "Colors of Parts"


def render_uv_map(mesh: bpy.types.Mesh) -> bpy.types.MeshUVLoopLayer | None:
    """Return the UV map that renders use where none is named, or None."""
    return next((own for own in mesh.uv_layers if own.active_render), mesh.uv_layers.active)


def render_colors(mesh: bpy.types.Mesh) -> bpy.types.Attribute | None:
    """Return the color attribute that renders use where none is named, or None."""
    colors = mesh.color_attributes
    index = colors.render_color_index
    return colors[index] if 0 <= index < len(colors) else None


def share_uv_map(meshes: Sequence[bpy.types.Mesh]) -> str:
    """Give meshes that are to be joined their rendered UV maps under one name, too, and return it."""
    shown = [(mesh, own.name) for mesh in meshes if (own := render_uv_map(mesh)) is not None]
    shared = _shared_name(shown, _SHARED_UVS)
    for mesh, name in shown:
        if name != shared:
            values = element_values(mesh.uv_layers[name].uv, "vector", 2)
            write_attribute(mesh, shared, "FLOAT2", values, "CORNER")
    return shared


def share_colors(meshes: Sequence[bpy.types.Mesh]) -> str:
    """Give meshes that are to be joined their rendered colors under one name, too, and return it."""
    shown = [(mesh, own.name) for mesh in meshes if (own := render_colors(mesh)) is not None]
    shared = _shared_name(shown, _SHARED_COLORS)
    for mesh, name in shown:
        if name != shared:
            own = mesh.color_attributes[name]
            write_attribute(mesh, shared, own.data_type, element_values(own.data, "color", 4), own.domain)
    return shared


def render_with(mesh: bpy.types.Mesh, uv_map: str, colors: str) -> None:
    """Let renders use a UV map and a color attribute, if a mesh has them; they also become the active ones."""
    if uv_map in mesh.uv_layers:
        mesh.uv_layers.active = mesh.uv_layers[uv_map]
        mesh.uv_layers[uv_map].active_render = True
    if colors in mesh.color_attributes:
        attributes = mesh.color_attributes
        attributes.active_color_index = attributes.render_color_index = attributes.find(colors)


def put_rendered_first(mesh: bpy.types.Mesh) -> None:
    """Make the UV map that renders use the first one, which they use where nodes show the mesh as a part of another."""
    shown = render_uv_map(mesh)
    if shown is None or shown == mesh.uv_layers[0]:
        return
    active = mesh.uv_layers.active.name if mesh.uv_layers.active else shown.name
    names = sorted((layer.name for layer in mesh.uv_layers), key=lambda name: name != shown.name)
    values = {name: element_values(mesh.uv_layers[name].uv, "vector", 2) for name in names}
    for name in names:
        mesh.uv_layers.remove(mesh.uv_layers[name])
    for name, own in values.items():
        write_attribute(mesh, name, "FLOAT2", own, "CORNER")
    mesh.uv_layers.active = mesh.uv_layers[active]
    mesh.uv_layers[0].active_render = True


def take_color_name(table: bpy.types.Mesh, frames: Iterable[bpy.types.ID]) -> None:
    """Let renders of a table by which nodes show frames use the colors that they use on the shapes among these."""
    meshes = (data for data in frames if isinstance(data, bpy.types.Mesh))
    names = (own.name for mesh in meshes if (own := render_colors(mesh)) is not None)
    table.attributes.default_color_name = next((name for name in names if name != COLOR), "")


def _shared_name(shown: Sequence[tuple[bpy.types.Mesh, str]], otherwise: str) -> str:
    """Return the first name of what meshes show that none has for something else; empty if they show nothing."""
    if not shown:
        return ""
    names = dict.fromkeys(name for _, name in shown)
    free = (name for name in names if all(name == own or name not in mesh.attributes for mesh, own in shown))
    return next(free, otherwise)
