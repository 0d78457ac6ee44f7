# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks before the mesh of an object is read or written."""

from __future__ import annotations

import bpy

from ..errors import InputError

CONVERTIBLE = ("CURVE", "FONT", "SURFACE", "META", "CURVES", "POINTCLOUD", "GREASEPENCIL")
"""Types of objects that Object > Convert > Mesh accepts."""


def not_a_mesh(obj: bpy.types.Object) -> InputError:
    """Return the error for an object that is not a mesh: convert it, or choose another one if it has no shape."""
    kind = obj.bl_rna.properties["type"].enum_items[obj.type].name.lower()
    if obj.type in CONVERTIBLE:
        return InputError(
            "{object} is not a mesh but of type {kind}; convert it: Object > Convert > Mesh.",
            object=obj.name,
            kind=kind,
        )
    return InputError(
        "{object} is not a mesh but of type {kind}, which cannot become one; choose a mesh, curve, text or metaball.",
        object=obj.name,
        kind=kind,
    )


def readable_mesh(obj: bpy.types.Object) -> bpy.types.Mesh:
    """Return the mesh of an object, including changes in Edit Mode.

    Raises
    ------
    InputError
        The object is not a mesh.
    """
    if obj.type != "MESH":
        raise not_a_mesh(obj)
    if obj.data.is_editmode:
        obj.update_from_editmode()
    return obj.data


def other_kind(obj: bpy.types.Object, name: str) -> InputError:
    """Return the error for a name that something else than the attribute to write already has."""
    return InputError(
        "{object} has an attribute or vertex group {name} of another kind; rename it, or choose another name.",
        object=obj.name,
        name=name,
    )


def other_vertices(obj: bpy.types.Object) -> InputError:
    """Return the error for a mesh that has changed too much during some work."""
    return InputError("The vertices of {object} have changed since the start; start again.", object=obj.name)


def writable_mesh(obj: bpy.types.Object) -> bpy.types.Mesh:
    """Return the mesh of an object for writing.

    Raises
    ------
    InputError
        The object is not a mesh, is in Edit Mode (which would overwrite the changes), or is linked from another file.
    """
    mesh = readable_mesh(obj)
    linked = next((block for block in (obj, mesh) if not block.is_editable), None)
    if linked is not None:
        raise linked_elsewhere(linked)
    require_not_edited(obj)
    return mesh


def linked_elsewhere(block: bpy.types.ID) -> InputError:
    """Return the error for an object or its data in another file."""
    return InputError(
        "{object} is linked from another file and cannot be changed here; make it local with its data: "
        "Object > Relations > Make Local.",
        object=block.name,
    )


def require_not_edited(obj: bpy.types.Object) -> None:
    """Raise InputError if the mesh of an object is in Edit Mode."""
    if obj.data.is_editmode:
        raise InputError("{object} is in Edit Mode; leave it with Tab, then try again.", object=obj.name)
