# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tell whether a user has edited a material or node group of the add-on, and whether two materials were made alike."""

from __future__ import annotations

import hashlib
from collections.abc import Collection, Iterator

import bpy

from .keyframes import curves_of, drivers_of

MADE_KEY = "convwass_made"
"""Custom property of a material or node group: a digest of its nodes and settings as they were made."""

# What Blender sets, and what does not change how a material looks.
_NO_SETTINGS = frozenset(
    [
        "use_fake_user",
        "use_extra_user",
        "tag",
        "use_nodes",
        "is_runtime_data",
        "paint_active_slot",
        "paint_clone_slot",
        "preview_render_type",
        "use_preview_world",
    ]
)
_NO_VALUES = frozenset(("rna_type", "select", "frame_current", "is_valid", "inputs", "outputs"))
_NO_NODE_VALUES = _NO_VALUES | frozenset(
    [
        "name",
        "label",
        "parent",
        "location",
        "location_absolute",
        "width",
        "height",
        "dimensions",
        "hide",
        "color",
        "use_custom_color",
        "show_options",
        "show_preview",
        "show_texture",
        "warning_propagation",
        "panel_states",
        "internal_links",
        "node_tree",
    ]
)


def remember_made(block: bpy.types.Material | bpy.types.NodeTree) -> None:
    """Store with a new material or node group how it was made."""
    block[MADE_KEY] = _digest(block)


def made_as(material: bpy.types.Material) -> str | None:
    """Return a text that is the same for materials that were made alike; None if that was not stored."""
    return material.get(MADE_KEY)


def is_edited(block: bpy.types.Material | bpy.types.NodeTree) -> bool:
    """Return whether a material or node group, or a group in it, was edited since it was made, or may have been."""
    return block.get(MADE_KEY) != _digest(block)


def _digest(block: bpy.types.Material | bpy.types.NodeTree) -> str:
    lines = _lines_of_material if isinstance(block, bpy.types.Material) else _lines_of_tree
    text = "\n".join(lines(block))
    return hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()[:32]


def _lines_of_material(material: bpy.types.Material) -> Iterator[str]:
    for prop in material.bl_rna.properties:
        is_setting = prop.type in ("BOOLEAN", "INT", "FLOAT", "ENUM") and not prop.is_readonly
        if is_setting and prop.identifier not in _NO_SETTINGS:
            yield f"{prop.identifier}={_text(getattr(material, prop.identifier))}"
    if material.grease_pencil is not None:
        yield from _lines_of(material.grease_pencil, "grease_pencil", _NO_VALUES, ())
    if material.node_tree is not None:
        yield from _lines_of_tree(material.node_tree)


def _lines_of_tree(tree: bpy.types.NodeTree) -> Iterator[str]:
    """Describe a tree and the groups in it, whose names depend on what else is in the file."""
    moving = {}
    for curve in curves_of(tree):
        moving.setdefault(curve.data_path, []).append([tuple(key.co) for key in curve.keyframe_points])
    for curve in drivers_of(tree):
        moving.setdefault(curve.data_path, []).append([*_lines_of(curve.driver, "", _NO_VALUES, ())])
    yield _text(sorted(moving.items()))
    for node in sorted(tree.nodes, key=lambda node: node.name):
        yield f"{node.bl_idname} {node.name}"
        path = node.path_from_id()
        yield from _lines_of(node, path, _NO_NODE_VALUES, moving)
        for name in ("inputs", "outputs"):
            for index, socket in enumerate(getattr(node, name)):
                place = f"{path}.{name}[{index}].default_value"
                if hasattr(socket, "default_value") and place not in moving:
                    yield f"{place}={_text(socket.default_value)}"
        if getattr(node, "node_tree", None) is not None:
            yield from _lines_of_tree(node.node_tree)
    yield from sorted(_text_of_link(link) for link in tree.links)


def _lines_of(
    struct: bpy.types.bpy_struct, path: str, left_out: Collection[str], moving: Collection[str]
) -> Iterator[str]:
    """Describe the values of a struct and of those in it, apart from animated ones, which change by themselves."""
    for prop in struct.bl_rna.properties:
        name, place = prop.identifier, f"{path}.{prop.identifier}"
        if name in left_out or name.startswith("bl_") or place in moving:
            continue
        value = getattr(struct, name)
        if isinstance(value, (bpy.types.Node, bpy.types.NodeSocket)):
            # Described elsewhere. Some nodes point to themselves or to each other.
            yield f"{place}={_text(value.name)}"
        elif prop.type == "COLLECTION":
            for index, item in enumerate(value):
                yield from _lines_of(item, f"{place}[{index}]", _NO_VALUES, moving)
        elif prop.type == "POINTER" and value is not None and not isinstance(value, bpy.types.ID):
            yield from _lines_of(value, place, _NO_VALUES, moving)
        elif prop.type == "POINTER" or not prop.is_readonly:
            yield f"{place}={_text(value)}"


def _text_of_link(link: bpy.types.NodeLink) -> str:
    ends = (link.from_node.name, link.from_socket.identifier, link.to_node.name, link.to_socket.identifier)
    return _text((*ends, link.is_muted))


def _text(value: object) -> str:
    if isinstance(value, bpy.types.Image):
        # An image that is renamed, or moved with the .blend file, is the same.
        return f"image {bpy.path.basename(value.filepath) or (value.source, *value.size)}"
    if isinstance(value, bpy.types.ID):
        return repr(value)
    if isinstance(value, (set, frozenset)):
        return repr(sorted(value))
    if hasattr(value, "__iter__") and not isinstance(value, str):
        return f"({', '.join(map(_text, value))})"
    return repr(value)
