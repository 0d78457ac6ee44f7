# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Read and write a property of all elements of a mesh at once."""

from __future__ import annotations

from typing import Literal

import bpy
import numpy as np
from numpy.typing import DTypeLike, NDArray

# Names of the values of attributes, and their types; by default "value" and float32.
_PROPERTIES = {"FLOAT_VECTOR": "vector", "FLOAT2": "vector", "FLOAT_COLOR": "color", "BYTE_COLOR": "color"}
_TYPES = {"BOOLEAN": bool, "INT": np.int32, "INT8": np.int32}


def element_values(
    elements: bpy.types.bpy_prop_collection, name: str, width: int = 1, kind: DTypeLike = np.float32
) -> NDArray:
    """Return a property of all elements of a collection, such as the vertices or the data of an attribute.

    Parameters
    ----------
    elements : bpy.types.bpy_prop_collection
        n elements.
    name : str
        The property.
    width : int
        How many numbers it has.
    kind : dtype
        Their type in Blender, by which they are copied without conversion.

    Returns
    -------
    (n,), or (n, width) for several numbers
    """
    values = np.empty(len(elements) * width, kind)
    elements.foreach_get(name, values)
    return values if width == 1 else values.reshape(-1, width)


def vectors_of(elements: bpy.types.bpy_prop_collection, name: str = "co") -> NDArray[np.float64]:
    """Return vectors of all elements, (n, 3), in double precision; by default positions, as of vertices and of keys."""
    return element_values(elements, name, 3).astype(np.float64)


def triangle_corners(mesh: bpy.types.Mesh, kind: Literal["vertices", "loops"]) -> NDArray[np.int32]:
    """Return the vertices or the face corners at the corners of the triangles of a mesh, (m, 3)."""
    mesh.calc_loop_triangles()
    return element_values(mesh.loop_triangles, kind, 3, np.int32)


def write_attribute(
    mesh: bpy.types.Mesh, name: str, kind: str, values: NDArray, domain: str = "POINT"
) -> bpy.types.Attribute:
    """Give a mesh an attribute of a kind, such as "FLOAT_VECTOR", instead of an earlier one of the same name."""
    if name in mesh.attributes:
        mesh.attributes.remove(mesh.attributes[name])
    attribute = mesh.attributes.new(name, kind, domain)
    flat = np.ascontiguousarray(values, _TYPES.get(kind, np.float32)).ravel()
    attribute.data.foreach_set(_PROPERTIES.get(kind, "value"), flat)
    return attribute
