# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Names of objects that are stored as text, with the library of linked objects, since these may share their name."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain, count

import bpy

from .visibility import objects_in_scenes

_NUMBER = re.compile(r"\.[0-9]{3,}$")


@dataclass(frozen=True)
class ObjectName:
    """The name of an object.

    Attributes
    ----------
    name : str
        The name, which is unique among the objects of a file.
    library : str or None
        The .blend file that the object is linked from, as Blender stores paths; empty for an object of this file, and
        None if that is unknown.
    """

    name: str
    library: str | None

    @classmethod
    def of(cls, obj: bpy.types.Object) -> ObjectName:
        """Return the name of an object."""
        return cls(obj.name, library_of(obj))

    def is_of(self, obj: bpy.types.Object) -> bool:
        """Return whether an object has this name; any library fits if it is unknown."""
        return obj.name == self.name and (self.library is None or _whole(self.library) == _whole(library_of(obj)))


def without_number(name: str) -> str:
    """Return a name without the number that Blender appends to names that are taken."""
    return _NUMBER.sub("", name)


def numbered_names(name: str, longest: int) -> Iterator[str]:
    """Yield a name, and then the same one with numbers as Blender appends them, cut to some bytes in UTF-8."""
    for number in chain([""], (f".{number:03d}" for number in count(1))):
        yield name.encode()[: longest - len(number)].decode(errors="ignore") + number


def library_of(obj: bpy.types.Object) -> str:
    """Return the .blend file that an object is linked from, as Blender stores paths; empty if it is local."""
    return "" if obj.library is None else obj.library.filepath


def unique_name(obj: bpy.types.Object) -> str:
    """Return a name that only this object of the file has: its name, with its library if another object has that."""
    return obj.name if bpy.data.objects.get(obj.name) == obj else obj.name_full


def object_of(name: str, objects: Iterable[bpy.types.Object]) -> bpy.types.Object | None:
    """Return the object with a `unique_name`, or else the only one with that name, or None."""
    objects = list(objects)
    alike = [obj for obj in objects if obj.name == name]
    own = next((obj for obj in objects if obj.name_full == name), None)
    own = own or next((obj for obj in alike if unique_name(obj) == name), None)
    return alike[0] if own is None and len(alike) == 1 else own


def objects_named(names: Sequence[ObjectName]) -> list[bpy.types.Object | None]:
    """Find objects by their names; None for those that are in no scene.

    If a library was moved or an object was made local, the only other object of the name is taken.
    """
    there: dict[str, list[bpy.types.Object]] = {name.name: [] for name in names}
    named = [obj for obj in bpy.data.objects if obj.name in there]
    # Deleted objects may still exist if something refers to them.
    in_scenes = objects_in_scenes() if named else set()
    for obj in named:
        if obj in in_scenes:
            there[obj.name].append(obj)
    found = {name: next(filter(name.is_of, there[name.name]), None) for name in names}
    taken = set(found.values())
    for name in [name for name, obj in found.items() if obj is None]:
        others = [obj for obj in there[name.name] if obj not in taken]
        found[name] = others[0] if len(others) == 1 else None
    return [found[name] for name in names]


def scene_copies(names: Sequence[ObjectName], scenes: Sequence[bpy.types.Scene]) -> dict[ObjectName, bpy.types.Object]:
    """Return the copies that objects of other scenes have in scenes that are full copies of these.

    Blender gives copies the names of the originals with other numbers, and keeps their order.

    Parameters
    ----------
    names : sequence of ObjectName
        The objects.
    scenes : sequence of bpy.types.Scene
        Where to look for copies.

    Returns
    -------
    dict of ObjectName to bpy.types.Object
        Empty if one of the objects is in these scenes, or if not all that still exist have a copy.
    """
    if not scenes:
        return {}
    originals = {name: obj for name, obj in zip(names, objects_named(names), strict=True) if obj is not None}
    if any(scene in obj.users_scene for obj in originals.values() for scene in scenes):
        return {}
    alike = {scene: _alike(originals.values(), scene) for scene in bpy.data.scenes}
    found = {name: _copy_of(obj, alike[obj.users_scene[0]], alike[scenes[0]]) for name, obj in originals.items()}
    return {} if None in found.values() else found


def _copy_of(
    obj: bpy.types.Object,
    originals: Mapping[tuple[str, str], list[bpy.types.Object]],
    copies: Mapping[tuple[str, str], list[bpy.types.Object]],
) -> bpy.types.Object | None:
    """Return the object of a scene that has the place of an object of another scene among those of its name."""
    own, others = originals[_stem(obj)], copies[_stem(obj)]
    return others[own.index(obj)] if len(own) == len(others) else None


def _alike(
    objects: Iterable[bpy.types.Object], scene: bpy.types.Scene
) -> dict[tuple[str, str], list[bpy.types.Object]]:
    """Return the objects of a scene that have the type and name of any of some objects, by these."""
    alike: dict[tuple[str, str], list[bpy.types.Object]] = {_stem(obj): [] for obj in objects}
    types = {kind for kind, _ in alike}
    for own in scene.objects:
        if own.type in types and (stem := _stem(own)) in alike:
            alike[stem].append(own)
    return alike


def _stem(obj: bpy.types.Object) -> tuple[str, str]:
    """Return the type and the name of an object, apart from the number in the name."""
    return obj.type, without_number(obj.name)


def _whole(library: str) -> str:
    return bpy.path.abspath(library)
