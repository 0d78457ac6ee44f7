# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Group objects to shapes: an object, a parent with its children, or a collection. Nothing is evaluated."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import bpy

from ..errors import InputError
from .flat.flat_kinds import is_shape
from .visibility import is_in

OBJECTS, PARENTS, COLLECTIONS = "OBJECTS", "PARENTS", "COLLECTIONS"
"""Ways to group objects to shapes."""

# Types of objects with a surface that need conversion.
_OTHER_SURFACES = ("SURFACE", "META", "CURVES", "POINTCLOUD", "VOLUME")
# Display types of helper objects: cages, cutters, bone shapes.
_HELPERS = ("BOUNDS", "WIRE")
_NUMBER = re.compile(r"\.(\d+)$")


@dataclass(frozen=True)
class ShapeSource:
    """A shape and its objects.

    Attributes
    ----------
    name : str
        Name of the shape.
    root : bpy.types.Object
        Represents the shape in lists and in the data stored with a morph.
    parts : tuple of bpy.types.Object
        Objects with the surfaces of the shape; may not include `root`.
    """

    name: str
    root: bpy.types.Object
    parts: tuple[bpy.types.Object, ...]


def shape_source(obj: bpy.types.Object, grouping: str = OBJECTS) -> ShapeSource:
    """Return the shape of an object.

    Parameters
    ----------
    obj : bpy.types.Object
        Any object.
    grouping : str
        `OBJECTS`: the object alone, or all metaballs that are joined with it; an Empty that instances a collection is a
        shape, too. `PARENTS`: its topmost parent with all children. `COLLECTIONS`: all objects of its collection and
        nested ones; an object only in the scene's own collection is a shape by itself. Parts that are disabled in
        viewports, disabled in renders while visible, displayed as wires or bounds, or excluded from the view layer are
        left out, unless there are no others.
    """
    if grouping == PARENTS:
        root = _topmost(obj)
        return ShapeSource(root.name, root, _kept([root, *sorted(root.children_recursive, key=_name)]) or (root,))
    if grouping == COLLECTIONS and (collection := _collection(obj)) is not None:
        parts = _kept(sorted(_inside(collection), key=_name))
        if parts:
            return ShapeSource(collection.name, _representative(collection, parts), parts)
    own = _with_surface(obj)
    return ShapeSource(own.name, own, (own,))


def require_found(source: ShapeSource) -> None:
    """Raise InputError if Blender shows a placeholder for something of a shape, which was not found in its library."""
    blocks = [
        block for part in source.parts for block in (part, part.data, part.instance_collection) if block is not None
    ]
    missing = next((block for block in blocks if block.is_missing), None)
    if missing is None:
        return
    # Overrides of placeholders are placeholders, too.
    linked = missing.override_library.reference if missing.override_library else missing
    raise InputError(
        "{name} was not found in {file}; relocate that library in the Outliner, or bring the file back.",
        name=missing.name,
        file=bpy.path.abspath(linked.library.filepath),
    )


def shape_roots(objects: Iterable[bpy.types.Object], grouping: str = OBJECTS) -> list[bpy.types.Object]:
    """Return the roots of the shapes of objects, without duplicates and shapes that are parts of others.

    Objects without a surface are ignored.
    """
    sources = [shape_source(obj, grouping) for obj in objects if grouping != OBJECTS or is_part(obj)]
    parts = {source.root: set(source.parts) for source in sources if any(map(is_part, source.parts))}
    return [root for root, own in parts.items() if not any(own < other for other in parts.values())]


def is_plain(source: ShapeSource) -> bool:
    """Return whether a shape is a single object that needs no conversion, flat or solid."""
    return source.parts == (source.root,) and is_shape(source.root)


def is_part(obj: bpy.types.Object) -> bool:
    """Return whether an object has a surface, flat or solid, or instances a collection."""
    return is_shape(obj) or obj.type in _OTHER_SURFACES or shows_collection(obj)


def shows_collection(obj: bpy.types.Object) -> bool:
    """Return whether an object is an Empty that instances a collection."""
    return obj.type == "EMPTY" and obj.instance_type == "COLLECTION" and obj.instance_collection is not None


def _kept(objects: Iterable[bpy.types.Object]) -> tuple[bpy.types.Object, ...]:
    parts = [obj for obj in objects if is_part(obj)]
    shown = [obj for obj in parts if not _is_helper(obj)] or parts
    layer = bpy.context.view_layer
    return tuple(obj for obj in shown if is_in(layer, obj)) or tuple(shown)


def _is_helper(obj: bpy.types.Object) -> bool:
    # Inputs hidden by a bake are hidden in the viewport and disabled in renders, so they still count.
    return obj.hide_viewport or obj.display_type in _HELPERS or (obj.hide_render and obj.visible_get())


def _with_surface(obj: bpy.types.Object) -> bpy.types.Object:
    """Return an object, or of a metaball the one that has the surface of all metaballs joined with it."""
    if obj.type != "META":
        return obj
    there = {other for scene in obj.users_scene for other in scene.objects if other.type == "META"}
    family = [other for other in there if _family(other) == _family(obj)]
    # Blender gives it to the one without a number, or else with the lowest one.
    return min(family, key=_number, default=obj)


def _family(metaball: bpy.types.Object) -> str:
    """Return the name by which metaballs are joined."""
    return _NUMBER.sub("", metaball.name)


def _number(metaball: bpy.types.Object) -> int:
    """Return the number at the end of a metaball's name; -1 without one."""
    found = _NUMBER.search(metaball.name)
    return -1 if found is None else int(found[1])


def _topmost(obj: bpy.types.Object) -> bpy.types.Object:
    while obj.parent is not None:
        obj = obj.parent
    return obj


def _collection(obj: bpy.types.Object) -> bpy.types.Collection | None:
    """Return the collection of an object, other than that of a scene."""
    return next((own for own in obj.users_collection if own in set(bpy.data.collections)), None)


def _representative(collection: bpy.types.Collection, parts: tuple[bpy.types.Object, ...]) -> bpy.types.Object:
    """Return an object whose collection this is, and not a nested one; a part of the shape if possible."""
    # Panels ask this for every selected object. The first part is mostly the answer.
    candidates = itertools.chain(parts, sorted(collection.objects, key=_name))
    return next(obj for obj in candidates if _collection(obj) == collection)


def _inside(collection: bpy.types.Collection) -> Iterator[bpy.types.Object]:
    yield from collection.objects
    for child in collection.children:
        if not (child.hide_viewport or child.hide_render):
            yield from _inside(child)


def _name(obj: bpy.types.Object) -> str:
    return obj.name
