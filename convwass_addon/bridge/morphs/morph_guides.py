# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The guides of a morph: vertices of its shapes that belong together, by the names of objects."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import bpy
import numpy as np

from ...errors import InputError
from ...geometry.mesh import TriangleMesh
from ..surface_marks import bone_marks, empty_marks, group_marks
from ..surfaces import surface_mesh
from ..vertex_groups import group_names

if TYPE_CHECKING:
    from ...applications.motions.guides import Guide

LARGEST_GROUP = 0.05
"""Share of the vertices that a vertex group may have to be a mark and not weights of a bone."""


@dataclass(frozen=True)
class NamedGuide:
    """Vertices that belong together.

    Attributes
    ----------
    name : str
        What the user calls them, such as nose.
    points : mapping of str to int
        For some of the shapes, by the names of their objects, a vertex of the object's own mesh.
    """

    name: str
    points: Mapping[str, int]

    def as_dict(self) -> dict[str, object]:
        """Return it ready for JSON."""
        return {"name": self.name, "points": dict(self.points)}


def parsed_guide(name: str, points: str) -> NamedGuide:
    """Read one guide, of which the points are JSON; raises InputError where they are not."""
    try:
        entry = {"name": name, "points": json.loads(points)}
    except ValueError as error:
        raise _unreadable(error) from error
    return guides_of_entries([entry])[0]


def parsed_guides(text: str) -> list[NamedGuide]:
    """Read guides from JSON.

    Parameters
    ----------
    text : str
        ``[{"name": "nose", "points": {"Man": 12, "Woman": 345}}, ...]``; empty for none.

    Raises
    ------
    InputError
        Anything else.
    """
    if not text.strip():
        return []
    try:
        entries = json.loads(text)
    except ValueError as error:
        raise _unreadable(error) from error
    return guides_of_entries(entries)


def guides_of_entries(entries: object) -> list[NamedGuide]:
    """Return guides from what :meth:`NamedGuide.as_dict` returns of each, which may come from a file.

    Raises
    ------
    InputError
        Anything else.
    """
    try:
        return [NamedGuide(str(entry.get("name", "")), _points(entry["points"])) for entry in entries]
    except (ValueError, TypeError, KeyError, AttributeError) as error:
        raise _unreadable(error) from error


def guides_among(guides: Sequence[NamedGuide], names: Sequence[str]) -> list[NamedGuide]:
    """Return what guides say about some objects; those that join fewer than two of them are left out."""
    kept = (
        NamedGuide(guide.name, {name: vertex for name, vertex in guide.points.items() if name in names})
        for guide in guides
    )
    return [guide for guide in kept if len(guide.points) > 1]


def check_guide_names(guides: Sequence[NamedGuide], names: Sequence[str]) -> None:
    """Refuse guides that somebody wrote about objects that take no part; raises InputError."""
    for guide in guides:
        for name in guide.points:
            if name not in names:
                raise InputError(
                    "The guides name {name}, which is none of the shapes; those are {names}.",
                    name=name,
                    names=", ".join(names),
                )


def _unreadable(error: Exception) -> InputError:
    return InputError(
        "The guides cannot be read ({reason}). They look like {example}.",
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
    """Return a guide for every small vertex group that several objects have under the same name."""
    marks = {obj.name: group_marks(obj, group_names(obj), depsgraph, largest) for obj in objects}
    return _shared(marks)


def guides_from_empties(
    objects: Sequence[bpy.types.Object], depsgraph: bpy.types.Depsgraph, empties: Sequence[bpy.types.Object]
) -> list[NamedGuide]:
    """Return a guide for Empties of the same name on several objects; see :func:`.surface_marks.empty_marks`."""
    return _shared({obj.name: own for obj, own in empty_marks(objects, depsgraph, empties).items()})


def guides_from_bones(objects: Sequence[bpy.types.Object], depsgraph: bpy.types.Depsgraph) -> list[NamedGuide]:
    """Return a guide for the ends of bones of the same name in several rigs; see :func:`.surface_marks.bone_marks`."""
    return _shared({obj.name: bone_marks(obj, depsgraph) for obj in objects})


def guides_asked_for(
    word: str | None, objects: Sequence[bpy.types.Object], depsgraph: bpy.types.Depsgraph
) -> list[NamedGuide]:
    """Return the guides that the command line asks for.

    Parameters
    ----------
    word : str or None
        "groups", "empties", "bones", or the path of a JSON file; None for no guides.
    objects : sequence of bpy.types.Object
        The inputs of the morph.
    depsgraph : bpy.types.Depsgraph
        Of the scene.

    Raises
    ------
    InputError
        A file that cannot be read or is about other objects, or nothing of the same name.
    """
    if word is None:
        return []
    meshes = [obj for obj in objects if obj.type == "MESH"]
    if word == "empties":
        found = guides_from_empties(meshes, depsgraph, list(bpy.context.scene.objects))
    elif word in ("groups", "bones"):
        found = {"groups": guides_from_groups, "bones": guides_from_bones}[word](meshes, depsgraph)
    else:
        try:
            found = parsed_guides(Path(word).read_text(encoding="utf-8"))
        except (OSError, UnicodeDecodeError) as error:
            raise InputError("The guides in {path} cannot be read ({reason}).", path=word, reason=str(error)) from error
        check_guide_names(found, [obj.name for obj in objects])
        if not found:
            raise InputError("There are no guides in {path}.", path=word)
    if not found:
        raise InputError("There are no {word} of the same name on several shapes; --guides finds nothing.", word=word)
    return found


def _shared(marks: Mapping[str, Mapping[str, int | None]]) -> list[NamedGuide]:
    """Return a guide for every name that several objects have a vertex for."""
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
    """Return guides by the numbers of the shapes and their vertices.

    Parameters
    ----------
    guides : sequence of NamedGuide
        Those about objects that take no part are left out.
    objects : sequence of bpy.types.Object
        The inputs of the morph.
    shapes : sequence of TriangleMesh
        The inputs as modifiers leave them, in world space: their vertices may be others than those of the objects' own
        meshes, and the nearest ones are taken.
    depsgraph : bpy.types.Depsgraph
        Of the scene.

    Raises
    ------
    InputError
        A vertex that does not exist (any more).
    """
    numbers = {obj.name: number for number, obj in enumerate(objects)}
    own_meshes: dict[str, TriangleMesh] = {}
    found = []
    for index, guide in enumerate(guides, start=1):
        taken: dict[int, int] = {}
        for name, vertex in guide.points.items():
            if name in numbers:
                number = numbers[name]
                if name not in own_meshes:
                    own_meshes[name] = surface_mesh(objects[number], depsgraph)
                taken[number] = _vertex_of(guide.name or str(index), name, vertex, own_meshes[name], shapes[number])
        if len(taken) > 1:
            found.append(taken)
    return found


def _vertex_of(guide: str, name: str, vertex: int, own: TriangleMesh, shape: TriangleMesh) -> int:
    if not 0 <= vertex < len(own.vertices):
        raise InputError(
            "Guide {guide} is at vertex {vertex} of {name}, which has {count} vertices; pick the point again.",
            guide=guide,
            vertex=vertex,
            name=name,
            count=len(own.vertices),
        )
    used = np.unique(shape.faces)
    return int(used[np.linalg.norm(shape.vertices[used] - own.vertices[vertex], axis=1).argmin()])
