# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What is asked of an object before its mesh is read or written."""

from __future__ import annotations

import bpy

from ..errors import InputError


def readable_mesh(obj: bpy.types.Object) -> bpy.types.Mesh:
    """Return the mesh of an object, brought up to date where it is being edited.

    Raises
    ------
    InputError
        Not a mesh.
    """
    if obj.type != "MESH":
        kind = obj.bl_rna.properties["type"].enum_items[obj.type].name.lower()
        raise InputError(
            "{object} is not a mesh but of type {kind}; convert it: Object > Convert > Mesh.",
            object=obj.name,
            kind=kind,
        )
    if obj.data.is_editmode:
        obj.update_from_editmode()
    return obj.data


def other_vertices(obj: bpy.types.Object) -> InputError:
    """Return what is raised where a mesh has changed too much while there was work on it."""
    return InputError("{object} has other vertices than when the work on it began; start again.", object=obj.name)


def writable_mesh(obj: bpy.types.Object) -> bpy.types.Mesh:
    """Return the mesh of an object to which something is to be written.

    Raises
    ------
    InputError
        Not a mesh, in Edit Mode (which would overwrite it), or linked from another file.
    """
    mesh = readable_mesh(obj)
    linked = next((block for block in (obj, mesh) if not block.is_editable), None)
    if linked is not None:
        raise InputError(
            "{object} is linked from another file and cannot be changed here; make it local with its data: "
            "Object > Relations > Make Local.",
            object=linked.name,
        )
    if mesh.is_editmode:
        raise InputError("{object} is in Edit Mode; leave it with Tab, then try again.", object=obj.name)
    return mesh
