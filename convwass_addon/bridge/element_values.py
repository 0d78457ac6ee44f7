# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Read and write a property of all elements of a mesh at once."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import bpy
import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from .scene_colors import set_colors

# Names of the values of attributes, and their types; by default "value" and float32.
_PROPERTIES = {"FLOAT_VECTOR": "vector", "FLOAT2": "vector"}
_COLORS = ("FLOAT_COLOR", "BYTE_COLOR")
_TYPES = {"BOOLEAN": bool, "INT": np.int32, "INT8": np.int8}


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


def write_floats(elements: bpy.types.bpy_prop_collection, name: str, values: ArrayLike) -> None:
    """Write a property of all elements of a collection in single precision; `values` as from `element_values`."""
    # Only contiguous arrays of exactly this type are copied in one operation; others are copied element by element.
    elements.foreach_set(name, np.ascontiguousarray(values, dtype=np.float32).ravel())


def vectors_of(elements: bpy.types.bpy_prop_collection, name: str = "co") -> NDArray[np.float64]:
    """Return vectors of all elements, (n, 3), in double precision; by default positions, as of vertices and of keys."""
    return element_values(elements, name, 3).astype(np.float64)


def vertex_positions(mesh: bpy.types.Mesh) -> NDArray[np.float32]:
    """Return the positions of the vertices of a mesh, (n, 3), in single precision."""
    positions = _stored(mesh, "position", "FLOAT_VECTOR", "POINT")
    return element_values(mesh.vertices, "co", 3) if positions is None else element_values(positions, "vector", 3)


def corner_vertices(mesh: bpy.types.Mesh) -> NDArray[np.int32]:
    """Return the vertex at every face corner of a mesh."""
    corners = _stored(mesh, ".corner_vert", "INT", "CORNER")
    if corners is None:
        return element_values(mesh.loops, "vertex_index", kind=np.int32)
    return element_values(corners, "value", kind=np.int32)


@dataclass(frozen=True)
class MeshTriangles:
    """The triangles of a mesh.

    Attributes
    ----------
    vertices : (m, 3) int32
        The vertices at their corners.
    loops : (m, 3) int32
        The face corners there.
    """

    vertices: NDArray[np.int32]
    loops: NDArray[np.int32]

    @classmethod
    def of(cls, mesh: bpy.types.Mesh) -> MeshTriangles:
        """Read the triangles into which Blender divides the polygons of a mesh."""
        corners = corner_vertices(mesh)
        if len(corners) == 3 * len(mesh.polygons):
            return cls(corners.reshape(-1, 3), np.arange(len(corners), dtype=np.int32).reshape(-1, 3))
        mesh.calc_loop_triangles()
        # Slow, since Blender returns those of one triangle after the other; so their vertices are looked up.
        loops = element_values(mesh.loop_triangles, "loops", 3, np.int32)
        return cls(corners.take(loops), loops)


def triangle_corners(mesh: bpy.types.Mesh, kind: Literal["vertices", "loops"]) -> NDArray[np.int32]:
    """Return the vertices or the face corners at the corners of the triangles of a mesh, (m, 3)."""
    triangles = MeshTriangles.of(mesh)
    return triangles.loops if kind == "loops" else triangles.vertices


def triangle_polygons(mesh: bpy.types.Mesh) -> NDArray[np.int32]:
    """Return the polygon that every triangle of a mesh is a part of, (m,)."""
    mesh.calc_loop_triangles()
    return element_values(mesh.loop_triangle_polygons, "value", kind=np.int32)


def triangle_materials(mesh: bpy.types.Mesh) -> NDArray[np.int32]:
    """Return the index of the material slot of every triangle of a mesh, (m,); it may be invalid."""
    stored = _stored(mesh, "material_index", "INT", "FACE")
    if stored is None:
        of_polygons = element_values(mesh.polygons, "material_index", kind=np.int32)
    else:
        of_polygons = element_values(stored, "value", kind=np.int32)
    return of_polygons.take(triangle_polygons(mesh))


def _stored(mesh: bpy.types.Mesh, name: str, kind: str, domain: str) -> bpy.types.bpy_prop_collection | None:
    """Return the data of an attribute; None if there is no such one, or the mesh is in Edit Mode, which hides it.

    Reading the same from the elements takes a hundred times as long.
    """
    attribute = None if mesh.is_editmode else mesh.attributes.get(name)
    if attribute is None or (attribute.data_type, attribute.domain) != (kind, domain):
        return None
    return attribute.data


def write_attribute(
    mesh: bpy.types.Mesh, name: str, kind: str, values: NDArray, domain: str = "POINT"
) -> bpy.types.Attribute:
    """Give a mesh an attribute of a kind, such as "FLOAT_VECTOR", instead of an earlier one of the same name."""
    if name in mesh.attributes:
        mesh.attributes.remove(mesh.attributes[name])
    attribute = mesh.attributes.new(name, kind, domain)
    if kind in _COLORS:
        set_colors(attribute, values)
    else:
        flat = np.ascontiguousarray(values, _TYPES.get(kind, np.float32)).ravel()
        attribute.data.foreach_set(_PROPERTIES.get(kind, "value"), flat)
    return attribute
