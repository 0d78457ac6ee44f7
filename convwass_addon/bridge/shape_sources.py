# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Group objects to shapes: an object, a parent with its children, or a collection. Nothing is evaluated."""

from __future__ import annotations

import itertools
import re
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import bpy

from ..errors import InputError
from .flat.flat_kinds import is_image, is_shape
from .morphs.results import bake_of, baked_from

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
        viewports, disabled in renders while visible, displayed as wires or bounds, excluded from the view layer, or
        images for reference are left out, unless there are no others. So is what was baked from the shape itself.
    """
    return shape_sources([obj], grouping)[0]


def shape_sources(objects: Iterable[bpy.types.Object], grouping: str = OBJECTS) -> list[ShapeSource]:
    """Return the shape of every object, as `shape_source` does, but look through the file only once."""
    return list(map(_Finder(grouping).source, objects))


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
    """Return the roots of the shapes of objects, as `separate_shapes` returns these."""
    return [source.root for source in separate_shapes(objects, grouping)]


def separate_shapes(objects: Iterable[bpy.types.Object], grouping: str = OBJECTS) -> list[ShapeSource]:
    """Return the shapes of objects, without duplicates and shapes that are parts of others.

    Objects without a surface are ignored.
    """
    sources = shape_sources((obj for obj in objects if grouping != OBJECTS or is_part(obj)), grouping)
    shapes = {source.root: source for source in sources if any(map(is_part, source.parts))}
    # Single objects are not parts of others.
    return list(shapes.values()) if grouping == OBJECTS else _outermost(list(shapes.values()))


def is_plain(source: ShapeSource) -> bool:
    """Return whether a shape is a single object that needs no conversion, flat or solid."""
    return source.parts == (source.root,) and is_shape(source.root)


def is_part(obj: bpy.types.Object) -> bool:
    """Return whether an object has a surface, flat or solid, or instances a collection."""
    return is_shape(obj) or obj.type in _OTHER_SURFACES or shows_collection(obj)


def shows_collection(obj: bpy.types.Object) -> bool:
    """Return whether an object is an Empty that instances a collection."""
    return obj.type == "EMPTY" and obj.instance_type == "COLLECTION" and obj.instance_collection is not None


def instanced_parts(empty: bpy.types.Object) -> tuple[bpy.types.Object, ...]:
    """Return the objects with a surface that an Empty shows of its collection, in their places outside of it.

    What groups leave out is left out, too; so are objects that no view layer has if they are disabled in renders.
    """
    parts = [obj for obj in sorted(set(_inside(empty.instance_collection)), key=_name) if _is_solid(obj)]
    return tuple(obj for obj in parts if not _is_left_out(obj)) or tuple(parts)


class _Finder:
    """Finds the shapes of objects. What it looks up in the file, and every shape, is found once for all of them."""

    def __init__(self, grouping: str) -> None:
        self._grouping = grouping
        self._shapes: dict[bpy.types.ID, ShapeSource | None] = {}

    def source(self, obj: bpy.types.Object) -> ShapeSource:
        """Return the shape of an object."""
        if self._grouping == PARENTS:
            return self._once(self._of_parent, _topmost(obj))
        collection = self._homes.get(obj) if self._grouping == COLLECTIONS else None
        shape = None if collection is None else self._once(self._of_collection, collection)
        return shape or self._alone(obj)

    def _once(self, found: Callable[[bpy.types.ID], ShapeSource | None], group: bpy.types.ID) -> ShapeSource | None:
        """Return the shape of a parent or a collection, which is found when it is needed first."""
        if group not in self._shapes:
            self._shapes[group] = found(group)
        return self._shapes[group]

    def _of_parent(self, root: bpy.types.Object) -> ShapeSource:
        parts = self._kept([root, *sorted(self._below(root), key=_name)])
        return ShapeSource(root.name, root, parts or (root,))

    def _of_collection(self, collection: bpy.types.Collection) -> ShapeSource | None:
        """Return the shape of a collection; None if nothing in it has a surface."""
        parts = self._kept(sorted(_inside(collection), key=_name))
        return ShapeSource(collection.name, self._representative(collection, parts), parts) if parts else None

    def _alone(self, obj: bpy.types.Object) -> ShapeSource:
        """Return the shape of an object that belongs to no others, except for metaballs joined with it."""
        own = self._with_surface.get(obj, obj) if obj.type == "META" else obj
        return ShapeSource(own.name, own, (own,))

    def _kept(self, objects: Iterable[bpy.types.Object]) -> tuple[bpy.types.Object, ...]:
        parts = [obj for obj in _without_results(list(objects)) if is_part(obj)]
        shown = [obj for obj in parts if not _is_helper(obj)] or parts
        return tuple(obj for obj in shown if obj in self._in_layer) or tuple(shown)

    def _below(self, parent: bpy.types.Object) -> Iterator[bpy.types.Object]:
        """Return all children of an object, and theirs."""
        waiting = self._children[parent][::-1]
        while waiting:
            child = waiting.pop()
            yield child
            waiting += reversed(self._children[child])

    def _representative(
        self, collection: bpy.types.Collection, parts: tuple[bpy.types.Object, ...]
    ) -> bpy.types.Object:
        """Return an object whose collection this is, and not a nested one; a part of the shape if possible."""
        candidates = itertools.chain(parts, sorted(collection.objects, key=_name))
        return next(obj for obj in candidates if self._homes.get(obj) == collection)

    @cached_property
    def _in_layer(self) -> set[bpy.types.Object]:
        """Objects of the view layer."""
        return set(bpy.context.view_layer.objects)

    @cached_property
    def _children(self) -> dict[bpy.types.Object, list[bpy.types.Object]]:
        """Children by parent."""
        children = defaultdict(list)
        for obj in bpy.data.objects:
            if (parent := obj.parent) is not None:
                children[parent].append(obj)
        return children

    @cached_property
    def _homes(self) -> dict[bpy.types.Object, bpy.types.Collection]:
        """The first collection that every object is in, other than that of a scene."""
        homes: dict[bpy.types.Object, bpy.types.Collection] = {}
        for collection in bpy.data.collections:
            for obj in collection.objects:
                homes.setdefault(obj, collection)
        return homes

    @cached_property
    def _with_surface(self) -> dict[bpy.types.Object, bpy.types.Object]:
        """For every metaball in a scene, the one that has the surface of all metaballs joined with it."""
        families = defaultdict(list)
        for scene in bpy.data.scenes:
            for obj in scene.objects:
                if obj.type == "META":
                    families[scene, _family(obj)].append(obj)
        found: dict[bpy.types.Object, bpy.types.Object] = {}
        for family in families.values():
            # Blender gives it to the one without a number, or else with the lowest one.
            first = min(family, key=_number)
            for obj in family:
                found[obj] = min(found.get(obj, first), first, key=_number)
        return found


def _outermost(shapes: Sequence[ShapeSource]) -> list[ShapeSource]:
    """Return the shapes that are not parts of others."""
    parts = [set(shape.parts) for shape in shapes]
    containing = defaultdict(list)
    for own in parts:
        for part in own:
            containing[part].append(own)
    # What contains a whole shape contains its first part.
    return [
        shape
        for shape, own in zip(shapes, parts, strict=True)
        if not any(own < other for other in containing[shape.parts[0]])
    ]


def _without_results(group: Sequence[bpy.types.Object]) -> list[bpy.types.Object]:
    """Return the objects of a group without what was baked from it, which users keep beside their shapes."""
    # Panels ask this, and of many objects few have custom properties.
    bakes = {obj: bake for obj in group if obj.keys() and (bake := bake_of(obj)) is not None}
    there = set(group) if bakes else set()
    own = {bake for bake in set(bakes.values()) if not there.isdisjoint(baked_from(bake))}
    return [obj for obj in group if bakes.get(obj) not in own] if own else list(group)


def _is_solid(obj: bpy.types.Object) -> bool:
    """Return whether an object can have a surface."""
    return obj.type in ("MESH", "FONT", "CURVE", *_OTHER_SURFACES) or shows_collection(obj)


def _is_left_out(obj: bpy.types.Object) -> bool:
    """Return whether an object of an instanced collection, which may be in no scene, is not part of a shape."""
    return _is_helper(obj) or (obj.hide_render and not obj.users_scene)


def _is_helper(obj: bpy.types.Object) -> bool:
    # Inputs hidden by a bake are hidden in the viewport and disabled in renders, so they still count.
    is_drawn = obj.display_type not in _HELPERS and not is_image(obj)
    return obj.hide_viewport or not is_drawn or (obj.hide_render and obj.visible_get())


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


def _inside(collection: bpy.types.Collection) -> Iterator[bpy.types.Object]:
    yield from collection.objects
    for child in collection.children:
        if not (child.hide_viewport or child.hide_render):
            yield from _inside(child)


def _name(obj: bpy.types.Object) -> str:
    return obj.name
