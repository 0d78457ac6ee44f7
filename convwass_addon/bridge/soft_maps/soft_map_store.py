# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Soft maps stored with their source object: saved with the file, copied with the object, and validated when read."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from enum import Enum

import bpy
import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ..element_values import element_values
from ..mesh_checks import linked_elsewhere, readable_mesh
from .soft_map_bytes import MappedSide, MeshMark, StoredSoftMap, packed, unpacked

MAPS_KEY = "convwass_soft_maps"
"""Custom property of a source object: a group of maps, each with its target, counts of both meshes, and its bytes."""

_TARGET, _COUNTS, _DATA = "target", "counts", "data"


class MapState(Enum):
    """Whether a map still fits its meshes."""

    CURRENT = "as it was"
    RESHAPED = "vertices have been moved"
    OTHER = "has other vertices or faces"


def require_storable(source: bpy.types.Object) -> None:
    """Raise InputError if an object cannot store maps: it is linked from another file, or a library override."""
    if not source.is_editable:
        raise linked_elsewhere(source)
    if source.override_library:
        raise InputError(
            "{object} is a library override, which loses its soft maps when the file is saved; make it local: "
            "Object > Relations > Make Local.",
            object=source.name,
        )


def require_storable_between(source: bpy.types.Object, target: bpy.types.Object) -> None:
    """Raise InputError if the source of a map cannot store it; the message says so if the target could."""
    if not _can_store(source) and _can_store(target):
        raise InputError(
            "{object} is linked from another file, or overrides an object of one, and cannot keep soft maps; press "
            "Swap Source and Target, compute the map, and transfer from Target to Source.",
            object=source.name,
        )
    require_storable(source)


def _can_store(source: bpy.types.Object) -> bool:
    return source.is_editable and source.override_library is None


def store_soft_map(source: bpy.types.Object, target: bpy.types.Object, stored: StoredSoftMap) -> None:
    """Store a map with its source object, and replace the map to the same target; raises as `require_storable`."""
    require_storable(source)
    sides = (stored.source, stored.target)
    counts = [number for side in sides for number in (side.mark.vertices, side.mark.polygons)]
    entry = {_TARGET: target, _COUNTS: counts, _DATA: packed(stored)}
    _replace(source, target, [entry])


def stored_soft_map(source: bpy.types.Object, target: bpy.types.Object) -> StoredSoftMap:
    """Read and validate a map from `store_soft_map`.

    Raises
    ------
    InputError
        There is no map to this target, or it is damaged or from a newer version.
    """
    entry = _entry(source, target)
    if entry is None:
        raise InputError(
            "{source} has no soft map to {target}; compute it first.", source=source.name, target=target.name
        )
    try:
        return unpacked(entry.get(_DATA))
    except (ValueError, TypeError, KeyError, RecursionError) as error:
        raise InputError(
            "The soft map that is stored with {object} is damaged ({reason}); compute it again.",
            object=source.name,
            reason=str(error),
        ) from error


def forget_soft_map(source: bpy.types.Object, target: bpy.types.Object) -> None:
    """Remove a map from its source object, and keep those to other targets."""
    _replace(source, target, [])


def _replace(source: bpy.types.Object, target: bpy.types.Object, entries: list[dict[str, object]]) -> None:
    """Replace the map to a target by other entries, and remove the maps to deleted objects, which are useless."""
    kept = [dict(own) for own in _entries(source) if own.get(_TARGET) not in (None, target)] + entries
    if kept:
        source[MAPS_KEY] = {str(place): own for place, own in enumerate(kept)}
    elif MAPS_KEY in source:
        del source[MAPS_KEY]


def has_soft_map(source: bpy.types.Object, target: bpy.types.Object) -> bool:
    """Return whether a map is stored; fast enough for a panel."""
    return _entry(source, target) is not None


def recounted(source: bpy.types.Object, target: bpy.types.Object) -> list[str]:
    """Return the names of objects whose number of vertices or faces differs from their map.

    Fast enough for a panel. In Edit Mode, the numbers are those from before it was entered.
    """
    entry = _entry(source, target)
    counts = list(entry.get(_COUNTS, ())) if entry is not None else []
    if len(counts) != 4:
        return []
    now = {obj: [len(obj.data.vertices), len(obj.data.polygons)] for obj in (source, target)}
    pairs = ((source, counts[:2]), (target, counts[2:]))
    return list(dict.fromkeys(obj.name for obj, own in pairs if now[obj] != own))


def mesh_mark(obj: bpy.types.Object) -> MeshMark:
    """Return a mark that identifies the mesh of an object.

    Raises
    ------
    InputError
        Not a mesh.
    """
    mesh = readable_mesh(obj)
    corners = element_values(mesh.loops, "vertex_index", kind=np.int32)
    starts = element_values(mesh.polygons, "loop_start", kind=np.int32)
    points = element_values(mesh.vertices, "co", 3)
    return MeshMark(len(mesh.vertices), len(mesh.polygons), _digest(corners, starts), _digest(points))


def mapped_side(obj: bpy.types.Object, triangles: NDArray[np.int64]) -> MappedSide:
    """Return the stored data of one mesh of a map; raises InputError if it is invalid."""
    return MappedSide(mesh_mark(obj), triangles)


def map_state(obj: bpy.types.Object, side: MappedSide) -> MapState:
    """Return whether a mesh is still that of a stored map; raises InputError if the stored data is invalid."""
    now = mesh_mark(obj)
    if (now.vertices, now.polygons, now.topology) != (side.mark.vertices, side.mark.polygons, side.mark.topology):
        return MapState.OTHER
    return MapState.CURRENT if now.shape == side.mark.shape else MapState.RESHAPED


def _digest(*arrays: NDArray) -> str:
    digest = hashlib.blake2b(digest_size=12)
    for array in arrays:
        digest.update(array.tobytes())
    return digest.hexdigest()


def _entries(source: bpy.types.Object) -> Iterator[object]:
    """Yield the stored maps, skipping entries that are not groups."""
    maps = source.get(MAPS_KEY)
    for entry in maps.values() if hasattr(maps, "values") else ():
        if hasattr(entry, "get"):
            yield entry


def _entry(source: bpy.types.Object, target: bpy.types.Object) -> object | None:
    return next((entry for entry in _entries(source) if entry.get(_TARGET) == target), None)
