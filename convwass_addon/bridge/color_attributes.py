# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Convert color attributes to arrays and back."""

from __future__ import annotations

import bpy
import numpy as np
from numpy.typing import ArrayLike, NDArray

from .element_values import corner_vertices, element_values
from .mesh_checks import other_kind
from .scene_colors import set_colors

_KINDS = ("BYTE_COLOR", "FLOAT_COLOR")


def color_names(obj: bpy.types.Object) -> list[str]:
    """Return the names of the color attributes of a mesh object in order."""
    return [attribute.name for attribute in obj.data.color_attributes]


def read_colors(obj: bpy.types.Object, name: str) -> NDArray[np.float64]:
    """Return a color attribute as scene linear RGBA, per vertex, (n, 4), or per face corner, (l, 4)."""
    attribute = obj.data.color_attributes[name]
    return element_values(attribute.data, "color", 4).astype(np.float64)


def is_per_corner(obj: bpy.types.Object, name: str) -> bool:
    """Return whether a color attribute has one color per face corner."""
    return obj.data.color_attributes[name].domain == "CORNER"


def color_kind(obj: bpy.types.Object, name: str) -> str:
    """Return the data type of a color attribute, BYTE_COLOR or FLOAT_COLOR."""
    return obj.data.color_attributes[name].data_type


def require_color_name(obj: bpy.types.Object, name: str) -> None:
    """Check that a name is free or belongs to a color attribute.

    Raises
    ------
    InputError
        The name belongs to something else.
    """
    attribute = obj.data.attributes.get(name)
    if name in obj.vertex_groups or (attribute is not None and attribute.data_type not in _KINDS):
        raise other_kind(obj, name)


def write_colors(obj: bpy.types.Object, name: str, colors: ArrayLike, kind: str = "BYTE_COLOR") -> None:
    """Write one scene linear RGBA color per vertex, (n, 4), to a color attribute of any domain; created if missing.

    Parameters
    ----------
    obj : bpy.types.Object
        A mesh object, not in Edit Mode.
    name : str
        Name of the attribute.
    colors : (n, 4) array_like
        One color per vertex.
    kind : str
        Data type of a new attribute: BYTE_COLOR or FLOAT_COLOR.

    Raises
    ------
    InputError
        The name belongs to something else.
    """
    require_color_name(obj, name)
    mesh = obj.data
    attribute = mesh.color_attributes.get(name)
    if attribute is None:
        attribute = mesh.color_attributes.new(name, kind, "POINT")
        if attribute.name != name:
            mesh.color_attributes.remove(attribute)
            raise other_kind(obj, name)
    values = np.asarray(colors, dtype=np.float32)
    set_colors(attribute, values[corner_vertices(mesh)] if attribute.domain == "CORNER" else values)
    mesh.update()


def show_colors(obj: bpy.types.Object, name: str) -> None:
    """Make a color attribute the active one, which viewports show."""
    obj.data.color_attributes.active_color_name = name
