# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the vertices of guides were chosen, to find them again after vertices were added or deleted."""

from __future__ import annotations

import math
from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Vector
from numpy.typing import NDArray

from ...geometry.affine import transformed_points
from ..element_values import element_values

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
    """

    count: int
    local: Point
    world: Point

    @classmethod
    def of(cls, obj: bpy.types.Object, vertex: int) -> Place:
        """Return where a vertex of a mesh object is."""
        local = obj.data.vertices[vertex].co
        return cls(len(obj.data.vertices), tuple(local), tuple(obj.matrix_world @ local))

    @classmethod
    def of_entry(cls, entry: dict[str, object]) -> Place:
        """Return a place from its `vars`; raises Python's own errors if they are damaged."""
        found = cls(int(entry["count"]), *(tuple(map(float, entry[space])) for space in ("local", "world")))
        if not all(len(own) == 3 and all(map(math.isfinite, own)) for own in (found.local, found.world)):
            raise ValueError("a place of a guide has no three coordinates")
        return found


def has_vertex(obj: bpy.types.Object, vertex: int) -> bool:
    """Return whether an object is a mesh that has a vertex."""
    return obj.type == "MESH" and 0 <= vertex < len(obj.data.vertices)


def vertex_now(obj: bpy.types.Object, vertex: int, place: Place | None) -> int | None:
    """Return the vertex that is now where another one was chosen.

    While a mesh has as many vertices as then, its vertices have the same numbers, also if they were moved. Otherwise it
    is the vertex at the old position, or else the nearest one.

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
    if place is None or obj.type != "MESH" or len(obj.data.vertices) == place.count:
        return vertex if has_vertex(obj, vertex) else None
    key = (obj.session_uid, place)
    found = _FOUND.get(key)
    if found is None or not found.is_still_there(obj):
        found = _FOUND[key] = _Found.near(obj, place)
    return found.vertex


@dataclass(frozen=True)
class _Found:
    """A vertex that was found, which saves a search whenever a view or a panel is drawn."""

    vertex: int | None
    count: int
    co: Vector | None

    @classmethod
    def near(cls, obj: bpy.types.Object, place: Place) -> _Found:
        vertex = _searched(obj, place)
        co = None if vertex is None else obj.data.vertices[vertex].co.copy()
        return cls(vertex, len(obj.data.vertices), co)

    def is_still_there(self, obj: bpy.types.Object) -> bool:
        vertices = obj.data.vertices
        return len(vertices) == self.count and (self.vertex is None or vertices[self.vertex].co == self.co)


_FOUND: dict[tuple[int, Place], _Found] = {}


def _searched(obj: bpy.types.Object, place: Place) -> int | None:
    """Return the vertex at a place in local space, or else in world space, or else the nearest one that is near."""
    local = element_values(obj.data.vertices, "co", 3).astype(np.float64)
    if not len(local):
        return None
    world = transformed_points(local, obj.matrix_world)
    tried = (_nearest(local, place.local), _nearest(world, place.world))
    return next((vertex for reach in (_SAME, _NEAR) for vertex, distance in tried if distance <= reach), None)


def _nearest(points: NDArray[np.float64], place: Point) -> tuple[int, float]:
    """Return the point nearest to a place, and its distance relative to the diagonal of all points."""
    distances = np.linalg.norm(points - np.array(place), axis=1)
    vertex = int(distances.argmin())
    diagonal = float(np.linalg.norm(np.ptp(points, axis=0)))
    return vertex, float(distances[vertex]) / max(diagonal, np.finfo(float).tiny)
