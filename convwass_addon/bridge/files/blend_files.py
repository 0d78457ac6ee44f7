# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Open .blend files without their scripts or an empty one, and append objects from them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

import bpy

from ...applications.whole_paths import whole_path
from ...errors import InputError
from ...sentence import Sentence
from ..interrupts import delayed_interrupts

NAMES_SHOWN = 20
"""Longest list of names in a message."""


def open_empty() -> None:
    """Open an empty file with Blender's factory settings; an interrupt takes effect after that.

    Blender prints an interrupt that comes while it enables its own add-ons, and goes on without the rest of them.
    """
    with delayed_interrupts():
        bpy.ops.wm.read_factory_settings(use_empty=True)


def open_blend(path: Path) -> None:
    """Open a file unchanged, without running its scripts; an interrupt takes effect after that.

    Blender prints an interrupt that comes while it runs its own Python code for that, and goes on.

    Raises
    ------
    InputError
        Blender cannot read the file.
    """
    file = whole_path(path)
    try:
        with delayed_interrupts():
            bpy.ops.wm.open_mainfile(filepath=str(file), load_ui=False, use_scripts=False)
    except RuntimeError as error:
        raise _unreadable(file) from error


def appended_objects(path: Path, names: Sequence[str] | None) -> dict[str, bpy.types.Object]:
    """Append objects of a file with their dependencies, without linking them to a scene.

    Parameters
    ----------
    path : Path
        The file.
    names : sequence of str or None
        Names of the objects; None for all.

    Returns
    -------
    dict of str to bpy.types.Object
        Keys are the names in the file; the names here may differ.

    Raises
    ------
    InputError
        Blender cannot read the file, or an object does not exist.
    """
    file = whole_path(path)
    try:
        with bpy.data.libraries.load(str(file), link=False) as (available, wanted):
            asked = available.objects if names is None else names
            missing = [name for name in asked if name not in available.objects]
            # Remove duplicates: Blender crashes on repeated names.
            chosen = [] if missing else list(dict.fromkeys(asked))
            wanted.objects = list(chosen)
            listed = listed_names(available.objects)
    except OSError as error:
        raise _unreadable(file) from error
    if missing:
        raise InputError(
            "{file} has no object {name!r}; it contains {listed}.", file=file.name, name=missing[0], listed=listed
        )
    return dict(zip(chosen, wanted.objects, strict=True))


def appended_instances(path: Path, names: Sequence[str]) -> dict[str, bpy.types.Object]:
    """Append collections of a file, each instanced by a new Empty that no scene holds yet.

    Parameters
    ----------
    path : Path
        The file.
    names : sequence of str
        Names of collections and objects; objects are left out.

    Returns
    -------
    dict of str to bpy.types.Object
        The Empties, by the names of the collections in the file.

    Raises
    ------
    InputError
        Blender cannot read the file, or a name is neither that of an object nor of a collection.
    """
    file = whole_path(path)
    try:
        with bpy.data.libraries.load(str(file), link=False) as (available, wanted):
            known = {*available.objects, *available.collections}
            found = set(available.collections) - set(available.objects)
            missing = [name for name in names if name not in known]
            chosen = [] if missing else [name for name in dict.fromkeys(names) if name in found]
            wanted.collections = list(chosen)
    except OSError as error:
        raise _unreadable(file) from error
    if missing:
        raise InputError(
            "{file} has no object or collection {name!r}; it contains {listed}.",
            file=file.name,
            name=missing[0],
            listed=listed_names(known),
        )
    shown = {}
    for name, collection in zip(chosen, wanted.collections, strict=True):
        shown[name] = bpy.data.objects.new(name, None)
        shown[name].instance_type, shown[name].instance_collection = "COLLECTION", collection
    return shown


def several_meshes(file: Path, count: int, available: str | Sentence) -> InputError:
    """Return the error for a file with another number of meshes than one, given their names."""
    return InputError(
        "{file} contains {count} meshes; name one as {file}:NAME, of {available}.",
        file=file.name,
        count=count,
        available=available,
    )


def listed_names(names: Iterable[str]) -> str | Sentence:
    """Join names for a message, shortened to a few."""
    known = sorted(names)
    if not known:
        return Sentence("no objects")
    more = len(known) - NAMES_SHOWN
    shown = ", ".join(known[:NAMES_SHOWN])
    return Sentence("{names} and {more} more", {"names": shown, "more": more}) if more > 0 else shown


def _unreadable(file: Path) -> InputError:
    """Return the error for a file that Blender cannot read."""
    try:
        file.open("rb").close()
    except OSError as error:
        return InputError("{file} cannot be opened: {reason}.", file=str(file), reason=error.strerror)
    return InputError("{file} could not be read; it is damaged, or not a Blender file.", file=file.name)
