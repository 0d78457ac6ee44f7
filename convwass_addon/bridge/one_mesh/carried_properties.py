# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Custom properties of a shape that its copy with shape keys has, too, and drivers that read them there."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress

import bpy

from ..keyframes import driver_variables
from .records import slider_names

# Begins the names of all properties that the add-on stores.
_OURS = "convwass_"

# What a copy in another space has of an object: custom properties, and the mesh with its shape keys.
_PLACELESS = ("[", "data.")


def custom_properties(obj: bpy.types.Object) -> list[str]:
    """Return the names of the custom properties of an object, except for those that this add-on has added."""
    # Blender 4.5 lists the settings of other add-ons, too.
    settings = {name for name, kind in obj.bl_rna.properties.items() if kind.is_runtime}
    names, others = obj.keys(), {*slider_names(obj), *settings}
    return [name for name in names if name not in others and not name.startswith(_OURS)]


def take_properties(obj: bpy.types.Object, source: bpy.types.Object, names: Sequence[str]) -> None:
    """Give an object custom properties of another one, with their limits and descriptions.

    Parameters
    ----------
    obj, source : bpy.types.Object
        The object, and the other one.
    names : sequence of str
        Names of the properties.
    """
    for name in names:
        value = source[name]
        obj[name] = value.to_dict() if hasattr(value, "to_dict") else value
        # Groups have neither limits nor a description.
        with suppress(TypeError):
            obj.id_properties_ui(name).update_from(source.id_properties_ui(name))


def read_from_copy(block: bpy.types.ID, source: bpy.types.Object, obj: bpy.types.Object, *, is_in_place: bool) -> None:
    """Let drivers read the copy of an object instead of its source, as far as the copy has what they read.

    Parameters
    ----------
    block : bpy.types.ID
        The data-block with the drivers.
    source, obj : bpy.types.Object
        The object, and its copy.
    is_in_place : bool
        Whether the copy has the transform of the object; otherwise, drivers read that of the object.
    """
    for variable in driver_variables(block):
        for target in variable.targets:
            if target.id == source and _has(obj, variable, target.data_path, is_in_place=is_in_place):
                target.id = obj


def _has(obj: bpy.types.Object, variable: bpy.types.DriverVariable, path: str, *, is_in_place: bool) -> bool:
    """Return whether the copy of an object has what a variable reads from the object, at a data path or by its kind."""
    if variable.type != "SINGLE_PROP":
        return is_in_place
    if not (is_in_place or path.startswith(_PLACELESS)):
        return False
    try:
        obj.path_resolve(path)
    except ValueError:
        return False
    return True
