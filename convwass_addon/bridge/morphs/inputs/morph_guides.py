# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The guides of a morph: corresponding vertices of its shapes, by names of objects (`object_names.unique_name`)."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, TypeVar

import bpy

from ....errors import InputError
from ....geometry.meshes.mesh import TriangleMesh
from ....sentence import Sentence
from ...object_names import object_of, unique_name
from ...surface_marks import bone_marks, empty_marks, group_marks, nearest_vertex
from ...surfaces import surface_mesh
from ...vertex_groups import group_names
from ...vertex_places import Place, has_vertex, vertex_now

if TYPE_CHECKING:
    from ....applications.motions.guides import Guide

Value = TypeVar("Value")

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
    places : mapping of str to Place
        Where these vertices were, as far as that is known.
    """

    name: str
    points: Mapping[str, int]
    places: Mapping[str, Place] = field(default_factory=dict)

    def as_dict(self) -> dict[str, object]:
        """Return the guide as a dict for JSON."""
        entry = {"name": self.name, "points": dict(self.points)}
        places = {name: vars(place) for name, place in self.places.items()}
        return {**entry, "places": places} if places else entry


def parsed_guide(name: str, points: str) -> NamedGuide:
    """Parse one guide with points as JSON; raises InputError if they are invalid."""
    return guides_of_entries([{"name": name, "points": _parsed(points)}])[0]


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
    return guides_of_entries(_parsed(text)) if text.strip() else []


def _parsed(text: str) -> object:
    try:
        return json.loads(text)
    except ValueError as error:
        raise _unreadable(str(error)) from error


def guides_of_entries(entries: object) -> list[NamedGuide]:
    """Return guides from the results of :meth:`NamedGuide.as_dict`, which may come from a file.

    Raises
    ------
    InputError
        An entry is invalid.
    """
    if not isinstance(entries, list | tuple):
        raise _unreadable(Sentence("they are not a list"))
    try:
        return [_of_entry(entry) for entry in entries]
    except (OverflowError, ValueError) as error:
        raise _unreadable(str(error)) from error
    except (TypeError, KeyError, AttributeError) as error:
        raise _unreadable(Sentence("an entry is not a guide with points")) from error


def guides_among(guides: Sequence[NamedGuide], objects: Sequence[bpy.types.Object]) -> list[NamedGuide]:
    """Restrict guides to some objects; guides with fewer than two points left are dropped."""
    kept = (
        NamedGuide(guide.name, *(_of_objects(own, objects) for own in (guide.points, guide.places))) for guide in guides
    )
    return [guide for guide in kept if len(guide.points) > 1]


def _of_objects(values: Mapping[str, Value], objects: Sequence[bpy.types.Object]) -> dict[str, Value]:
    return {name: value for name, value in values.items() if object_of(name, objects)}


def guides_now(guides: Sequence[NamedGuide], objects: Sequence[bpy.types.Object]) -> list[NamedGuide]:
    """Return guides with the vertices that are now at their places, and with the places of these.

    Points that are not found, and those on other objects, are unchanged.
    """
    return [_guide_now(guide, objects) for guide in guides]


def _guide_now(guide: NamedGuide, objects: Sequence[bpy.types.Object]) -> NamedGuide:
    points, places = dict(guide.points), dict(guide.places)
    for name, before in guide.points.items():
        obj = object_of(name, objects)
        vertex = None if obj is None else vertex_now(obj, before, places.get(name))
        if vertex is not None:
            points[name], places[name] = vertex, Place.of(obj, vertex)
    return replace(guide, points=points, places=places)


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


def _unreadable(reason: str | Sentence) -> InputError:
    return InputError(
        "The guides cannot be read ({reason}). Expected format: {example}.",
        reason=reason,
        example='[{"name": "nose", "points": {"Man": 12, "Woman": 345}}]',
    )


def _of_entry(entry: dict[str, object]) -> NamedGuide:
    points, places = _points(entry["points"]), dict(entry.get("places", {}))
    known = {name: Place.of_entry(place) for name, place in places.items() if name in points}
    return NamedGuide(str(entry.get("name", "")), points, known)


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
        A vertex does not exist, and none is near its place.
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
                label = guide.name or str(index)
                found_now = _vertex_at(label, obj, vertex, guide.places.get(name))
                taken[number] = vertex_of_shape(label, name, found_now, own_meshes[number], shapes[number])
        if len(taken) > 1:
            found.append(taken)
    return found


def _vertex_at(guide: str, obj: bpy.types.Object, vertex: int, place: Place | None) -> int:
    """Return the vertex of a guide on an object; raises InputError if there is none at its place any more."""
    now = vertex_now(obj, vertex, place)
    if now is None and has_vertex(obj, vertex):
        raise InputError(
            "Guide {guide} was on a part of {name} that was deleted; pick the point again.", guide=guide, name=obj.name
        )
    # A number that does not exist is reported with the number of vertices.
    return vertex if now is None else now


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
    return nearest_vertex(shape, own.vertices[vertex])
