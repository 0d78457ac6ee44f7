# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The guides of a morph: corresponding vertices of its shapes, by names of objects (`object_names.unique_name`)."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import bpy
import numpy as np

from ...errors import InputError
from ...geometry.mesh import TriangleMesh
from ..object_names import object_of, unique_name
from ..surface_marks import bone_marks, empty_marks, group_marks
from ..surfaces import surface_mesh
from ..vertex_groups import group_names

if TYPE_CHECKING:
    from ...applications.motions.guides import Guide

LARGEST_GROUP = 0.05
"""Largest share of the vertices for a vertex group to mark a point, rather than hold bone weights."""


@dataclass(frozen=True)
class NamedGuide:
    """Corresponding vertices.

    Attributes
    ----------
    name : str
        Name given by the user, such as nose.
    points : mapping of str to int
        Vertex of the original mesh, by the unique name of the object, for some of the shapes.
    """

    name: str
    points: Mapping[str, int]

    def as_dict(self) -> dict[str, object]:
        """Return the guide as a dict for JSON."""
        return {"name": self.name, "points": dict(self.points)}


def parsed_guide(name: str, points: str) -> NamedGuide:
    """Parse one guide with points as JSON; raises InputError if they are invalid."""
    try:
        entry = {"name": name, "points": json.loads(points)}
    except ValueError as error:
        raise _unreadable(error) from error
    return guides_of_entries([entry])[0]


def parsed_guides(text: str) -> list[NamedGuide]:
    """Parse guides from JSON.

    Parameters
    ----------
    text : str
        ``[{"name": "nose", "points": {"Man": 12, "Woman": 345}}, ...]``; empty for none.

    Raises
    ------
    InputError
        The text is invalid.
    """
    if not text.strip():
        return []
    try:
        entries = json.loads(text)
    except ValueError as error:
        raise _unreadable(error) from error
    return guides_of_entries(entries)


def guides_of_entries(entries: object) -> list[NamedGuide]:
    """Return guides from the results of :meth:`NamedGuide.as_dict`, which may come from a file.

    Raises
    ------
    InputError
        An entry is invalid.
    """
    try:
        return [NamedGuide(str(entry.get("name", "")), _points(entry["points"])) for entry in entries]
    except (ValueError, TypeError, KeyError, AttributeError) as error:
        raise _unreadable(error) from error


def guides_among(guides: Sequence[NamedGuide], objects: Sequence[bpy.types.Object]) -> list[NamedGuide]:
    """Restrict guides to some objects; guides with fewer than two points left are dropped."""
    kept = (
        NamedGuide(guide.name, {name: vertex for name, vertex in guide.points.items() if object_of(name, objects)})
        for guide in guides
    )
    return [guide for guide in kept if len(guide.points) > 1]


def check_guide_names(guides: Sequence[NamedGuide], objects: Sequence[bpy.types.Object]) -> None:
    """Raise InputError if guides refer to other objects than those that are morphed, or to fewer than two."""
    for guide in guides:
        if len(guide.points) < 2:
            raise InputError(
                "A guide connects points of at least two shapes; mark the same point on another shape, too."
            )
        for name in guide.points:
            if object_of(name, objects) is None:
                raise InputError(
                    "The guides refer to {name}, which is not one of the shapes: {names}.",
                    name=name,
                    names=", ".join(unique_name(obj) for obj in objects),
                )


def _unreadable(error: Exception) -> InputError:
    return InputError(
        "The guides cannot be read ({reason}). Expected format: {example}.",
        reason=str(error),
        example='[{"name": "nose", "points": {"Man": 12, "Woman": 345}}]',
    )


def _points(points: object) -> dict[str, int]:
    found = dict(points)
    for name, vertex in found.items():
        if not isinstance(name, str) or not isinstance(vertex, int) or isinstance(vertex, bool):
            raise ValueError(f"{name}: {vertex} is no vertex number")
    return found


def guides_from_groups(
    objects: Sequence[bpy.types.Object], depsgraph: bpy.types.Depsgraph, largest: float = LARGEST_GROUP
) -> list[NamedGuide]:
    """Return a guide for every small vertex group that several objects have."""
    marks = {unique_name(obj): group_marks(obj, group_names(obj), depsgraph, largest) for obj in objects}
    return _shared(marks)


def guides_from_empties(
    objects: Sequence[bpy.types.Object], depsgraph: bpy.types.Depsgraph, empties: Sequence[bpy.types.Object]
) -> list[NamedGuide]:
    """Return guides from Empties of the same name on several objects; see :func:`.surface_marks.empty_marks`."""
    return _shared({unique_name(obj): own for obj, own in empty_marks(objects, depsgraph, empties).items()})


def guides_from_bones(objects: Sequence[bpy.types.Object], depsgraph: bpy.types.Depsgraph) -> list[NamedGuide]:
    """Return guides from bone ends of the same name in several rigs; see :func:`.surface_marks.bone_marks`."""
    return _shared({unique_name(obj): bone_marks(obj, depsgraph) for obj in objects})


def _shared(marks: Mapping[str, Mapping[str, int | None]]) -> list[NamedGuide]:
    """Return a guide for every name with a vertex on several objects."""
    names = dict.fromkeys(name for own in marks.values() for name in own)
    guides = []
    for name in names:
        points = {obj: own[name] for obj, own in marks.items() if own.get(name) is not None}
        if len(points) > 1:
            guides.append(NamedGuide(name, points))
    return guides


def guides_of_shapes(
    guides: Sequence[NamedGuide],
    objects: Sequence[bpy.types.Object],
    shapes: Sequence[TriangleMesh],
    depsgraph: bpy.types.Depsgraph,
) -> list[Guide]:
    """Convert guides to indices of shapes and their vertices.

    Parameters
    ----------
    guides : sequence of NamedGuide
        Points on other objects are ignored.
    objects : sequence of bpy.types.Object
        The inputs of the morph.
    shapes : sequence of TriangleMesh
        The evaluated inputs in world space. Their vertices may differ from those of the original meshes, so the nearest
        vertices are used.
    depsgraph : bpy.types.Depsgraph
        The dependency graph of the scene.

    Raises
    ------
    InputError
        A vertex does not exist.
    """
    own_meshes: dict[int, TriangleMesh] = {}
    found = []
    for index, guide in enumerate(guides, start=1):
        taken: dict[int, int] = {}
        for name, vertex in guide.points.items():
            obj = object_of(name, objects)
            if obj is not None:
                number = objects.index(obj)
                if number not in own_meshes:
                    own_meshes[number] = surface_mesh(obj, depsgraph)
                taken[number] = vertex_of_shape(
                    guide.name or str(index), name, vertex, own_meshes[number], shapes[number]
                )
        if len(taken) > 1:
            found.append(taken)
    return found


def vertex_of_shape(guide: str, name: str, vertex: int, own: TriangleMesh, shape: TriangleMesh) -> int:
    """Return the vertex of a shape that is nearest to a vertex of its original mesh.

    Parameters
    ----------
    guide, name : str
        Names of the guide and of the shape, for messages.
    vertex : int
        Vertex of the original mesh.
    own, shape : TriangleMesh
        The original mesh and the shape, both in world space.

    Raises
    ------
    InputError
        The original mesh has no such vertex.
    """
    if not 0 <= vertex < len(own.vertices):
        raise InputError(
            "Guide {guide} refers to vertex {vertex} of {name}, which has {count} vertices; pick the point again.",
            guide=guide,
            vertex=vertex,
            name=name,
            count=len(own.vertices),
        )
    used = np.unique(shape.faces)
    return int(used[np.linalg.norm(shape.vertices[used] - own.vertices[vertex], axis=1).argmin()])
