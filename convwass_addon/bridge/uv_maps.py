# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Convert UV maps to arrays with one point per face corner, and back; seams as pairs of vertices."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .element_values import element_values, write_floats
from .mesh_checks import other_kind

_MOST_MAPS = 8


def uv_names(obj: bpy.types.Object) -> list[str]:
    """Return the names of the UV maps of a mesh object in order."""
    return [layer.name for layer in obj.data.uv_layers]


def read_uvs(obj: bpy.types.Object, name: str) -> NDArray[np.float64]:
    """Return a UV map, (l, 2)."""
    return element_values(obj.data.uv_layers[name].uv, "vector", 2).astype(np.float64)


def require_uv_names(obj: bpy.types.Object, names: Sequence[str]) -> None:
    """Raise InputError if an object cannot have these UV maps.

    Raises
    ------
    InputError
        There would be too many, or a name is used for something else.
    """
    new = [name for name in names if name not in obj.data.uv_layers]
    taken = next((name for name in new if name in obj.data.attributes or name in obj.vertex_groups), None)
    if taken is not None:
        raise other_kind(obj, taken)
    count = len(obj.data.uv_layers) + len(new)
    if count > _MOST_MAPS:
        raise InputError(
            "{object} would have {count} UV maps, and Blender allows {most}; remove some.",
            object=obj.name,
            count=count,
            most=_MOST_MAPS,
        )


def add_uv_map(mesh: bpy.types.Mesh, name: str, owner: str) -> bpy.types.MeshUVLoopLayer:
    """Add a UV map to a mesh, and return it; its name gets a number if the mesh has such a map.

    Raises
    ------
    InputError
        The mesh, which messages call `owner`, has as many as Blender allows.
    """
    if len(mesh.uv_layers) == _MOST_MAPS:
        raise InputError("{name} has eight UV maps; delete one.", name=owner)
    return mesh.uv_layers.new(name=name, do_init=False)


def write_uvs(obj: bpy.types.Object, name: str, loops: NDArray[np.int64], places: NDArray[np.float64]) -> None:
    """Write a UV map, creating it if necessary.

    Parameters
    ----------
    obj : bpy.types.Object
        A mesh object in any mode except Edit Mode.
    name : str
        Name of the map.
    loops : (k,) int64
        Face corners to write; others keep their position.
    places : (k, 2) float64
        Positions of these face corners.
    """
    mesh = obj.data
    if name not in mesh.uv_layers:
        mesh.uv_layers.new(name=name, do_init=False)
    values = read_uvs(obj, name)
    values[loops] = places
    write_floats(mesh.uv_layers[name].uv, "vector", values)
    mesh.update()


def mark_seams(obj: bpy.types.Object, seams: NDArray[np.int64]) -> None:
    """Mark edges as seams, (s, 2) vertices, in addition to existing seams."""
    mesh = obj.data
    ends = element_values(mesh.edges, "vertices", 2, np.int32)
    marked = element_values(mesh.edges, "use_seam", kind=bool)
    count = len(mesh.vertices)
    keys, wanted = (
        np.sort(np.asarray(pairs).reshape(-1, 2), axis=1).astype(np.int64) @ (count, 1) for pairs in (ends, seams)
    )
    mesh.edges.foreach_set("use_seam", marked | np.isin(keys, wanted))
    mesh.update()
