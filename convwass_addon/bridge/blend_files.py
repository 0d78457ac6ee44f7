# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of Blender: opened without their scripts, and objects out of them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

import bpy

from ..applications.whole_paths import whole_path
from ..errors import InputError
from ..sentence import Sentence

NAMES_SHOWN = 20
"""How many names of what there is a message lists."""


def open_blend(path: Path) -> None:
    """Open a file as it is, without running what scripts it may hold.

    Raises
    ------
    InputError
        Blender cannot read it.
    """
    file = whole_path(path)
    try:
        bpy.ops.wm.open_mainfile(filepath=str(file), load_ui=False, use_scripts=False)
    except RuntimeError as error:
        raise _unreadable(file) from error


def appended_objects(path: Path, names: Sequence[str] | None) -> dict[str, bpy.types.Object]:
    """Append objects of a file with all that they need; no scene holds them yet.

    Parameters
    ----------
    path : Path
        The file.
    names : sequence of str or None
        Which; all where there are none.

    Returns
    -------
    dict of str to bpy.types.Object
        By their names in the file, each once; here they may have others.

    Raises
    ------
    InputError
        Blender cannot read the file, or it has no object of such a name.
    """
    file = whole_path(path)
    try:
        with bpy.data.libraries.load(str(file), link=False) as (available, wanted):
            missing = [name for name in names or () if name not in available.objects]
            # Each one once: Blender crashes on a name that comes twice.
            chosen = [] if missing else list(dict.fromkeys(names or available.objects))
            wanted.objects = list(chosen)
            listed = listed_names(available.objects)
    except OSError as error:
        raise _unreadable(file) from error
    if missing:
        raise InputError(
            "{file} has no object {name!r}; it holds {listed}.", file=file.name, name=missing[0], listed=listed
        )
    return dict(zip(chosen, wanted.objects, strict=True))


def appended_instances(path: Path, names: Sequence[str]) -> dict[str, bpy.types.Object]:
    """Append collections of a file, each instanced by a new Empty that no scene holds yet.

    Parameters
    ----------
    path : Path
        The file.
    names : sequence of str
        Those that are names of objects, or of nothing, are left out.

    Returns
    -------
    dict of str to bpy.types.Object
        The Empties, by the names of the collections in the file.

    Raises
    ------
    InputError
        Blender cannot read the file.
    """
    file = whole_path(path)
    try:
        with bpy.data.libraries.load(str(file), link=False) as (available, wanted):
            found = set(available.collections) - set(available.objects)
            chosen = [name for name in dict.fromkeys(names) if name in found]
            wanted.collections = list(chosen)
    except OSError as error:
        raise _unreadable(file) from error
    shown = {}
    for name, collection in zip(chosen, wanted.collections, strict=True):
        shown[name] = bpy.data.objects.new(name, None)
        shown[name].instance_type, shown[name].instance_collection = "COLLECTION", collection
    return shown


def listed_names(names: Iterable[str]) -> str | Sentence:
    """Say which names there are, not without end."""
    known = sorted(names)
    if not known:
        return Sentence("no objects")
    more = len(known) - NAMES_SHOWN
    shown = ", ".join(known[:NAMES_SHOWN])
    return Sentence("{names} and {more} more", {"names": shown, "more": more}) if more > 0 else shown


def _unreadable(file: Path) -> InputError:
    return InputError("{file} could not be read; it is damaged, or not a file of Blender.", file=file.name)
