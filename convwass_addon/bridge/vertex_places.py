# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Where vertices were chosen, to find them again after others were added, deleted or sorted."""

from __future__ import annotations

import math
import zlib
from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Vector
from numpy.typing import NDArray

from ..geometry.algebra.affine import transformed_points
from .element_values import element_values, vectors_of

Point = tuple[float, float, float]

# Largest distances relative to the diagonal of the mesh: of a vertex that is the same one, in single precision, and of
# the nearest one that takes its place.
_SAME, _NEAR = 1e-5, 0.1


@dataclass(frozen=True)
class Place:
    """Where a vertex was.

    Attributes
    ----------
    count : int
        Number of vertices of its mesh.
    local : (float, float, float)
        Its position before modifiers, in local space.
    world : (float, float, float)
        The same in world space, which stays when a transform is applied.
    edges : int
        Checksum of the edges of its mesh, which changes if vertices get other numbers; 0 if unknown.
    """

    count: int
    local: Point
    world: Point
    edges: int = 0

    @classmethod
    def of(cls, obj: bpy.types.Object, vertex: int) -> Place:
        """Return where a vertex of a mesh object is."""
        local = obj.data.vertices[vertex].co
        return cls(len(obj.data.vertices), tuple(local), tuple(obj.matrix_world @ local), _edges_checksum(obj.data))

    @classmethod
    def of_entry(cls, entry: dict[str, object]) -> Place:
        """Return a place from its `vars`; raises Python's own errors if they are damaged."""
        points = (tuple(map(float, entry[space])) for space in ("local", "world"))
        found = cls(int(entry["count"]), *points, int(entry.get("edges", 0)))
        if not all(len(own) == 3 and all(map(math.isfinite, own)) for own in (found.local, found.world)):
            raise ValueError("a place of a guide has no three coordinates")
        return found


def has_vertex(obj: bpy.types.Object, vertex: int) -> bool:
    """Return whether an object is a mesh that has a vertex."""
    return obj.type == "MESH" and 0 <= vertex < len(obj.data.vertices)


def vertex_now(obj: bpy.types.Object, vertex: int, place: Place | None) -> int | None:
    """Return the vertex that is now where another one was chosen.

    While a mesh has as many vertices as then and the same edges, its vertices have the same numbers, also if they were
    moved. Otherwise it is the vertex at the old position, or else the nearest one, or with as many vertices as then the
    one of the same number.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, which may be no mesh any more.
    vertex : int
        Its number then.
    place : Place or None
        Where it was; None if that is unknown, so that only its number tells.

    Returns
    -------
    int or None
        None if there is no vertex, or none near.
    """
    own = vertex if has_vertex(obj, vertex) else None
    if place is None or obj.type != "MESH":
        return own
    keeps_count = len(obj.data.vertices) == place.count
    if keeps_count and (own is None or tuple(obj.data.vertices[vertex].co) == place.local):
        return own
    key = (obj.session_uid, vertex, place)
    found = _FOUND.get(key)
    if found is None or not found.is_still_there(obj):
        found = _FOUND[key] = _Found.of(obj, _searched(obj, place, vertex if keeps_count else None))
    return found.vertex


@dataclass(frozen=True)
class _Found:
    """A vertex that was found, which saves a search whenever a view or a panel is drawn."""

    vertex: int | None
    count: int
    co: Vector | None

    @classmethod
    def of(cls, obj: bpy.types.Object, vertex: int | None) -> _Found:
        co = None if vertex is None else obj.data.vertices[vertex].co.copy()
        return cls(vertex, len(obj.data.vertices), co)

    def is_still_there(self, obj: bpy.types.Object) -> bool:
        vertices = obj.data.vertices
        return len(vertices) == self.count and (self.vertex is None or vertices[self.vertex].co == self.co)


_FOUND: dict[tuple[int, int, Place], _Found] = {}


def _searched(obj: bpy.types.Object, place: Place, numbered: int | None) -> int | None:
    """Return the vertex at a place in local space, or else in world space, or else the nearest one that is near.

    If the mesh has as many vertices as before, another one than that of the same number must be exactly there.
    """
    if numbered is not None and place.edges in (0, _edges_checksum(obj.data)):
        return numbered
    local = vectors_of(obj.data.vertices)
    if not len(local):
        return None
    world = transformed_points(local, obj.matrix_world)
    tried = (_nearest(local, place.local), _nearest(world, place.world))
    reaches = (_SAME, _NEAR) if numbered is None else (_SAME,)
    return next((vertex for reach in reaches for vertex, distance in tried if distance <= reach), numbered)


def _edges_checksum(mesh: bpy.types.Mesh) -> int:
    """Return a checksum of the vertices of all edges in their order, which fits a property of Blender."""
    return zlib.crc32(element_values(mesh.edges, "vertices", 2, np.int32)) & 0x7FFFFFFF


def _nearest(points: NDArray[np.float64], place: Point) -> tuple[int, float]:
    """Return the point nearest to a place, and its distance relative to the diagonal of all points."""
    distances = np.linalg.norm(points - np.array(place), axis=1)
    vertex = int(distances.argmin())
    diagonal = float(np.linalg.norm(np.ptp(points, axis=0)))
    return vertex, float(distances[vertex]) / max(diagonal, np.finfo(float).tiny)
