# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Store descriptions of baked densities with their object, and read them back."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass, field

import bpy

from ...errors import InputError
from ..stored_json import is_list_of, parsed_table

SCHEMA = 1

DENSITIES_KEY = "convwass_densities"
"""Custom property of an object: JSON with a `StoredDensity` for every name, and the schema number."""

MOST_CHARACTERS = 4_000_000
"""Longer texts are not parsed."""


@dataclass(frozen=True)
class StoredDensity:
    """The stored description of a baked density.

    Attributes
    ----------
    inputs : list of str
        Names of the vertex groups it was computed from.
    settings : dict
        Settings of the bake: numbers, strings, booleans, None and lists of these.
    records : list of dict
        The solver's figures for each frame, scalars only.
    times : list of float
        Time of each stored frame from 0 to 1, ascending; empty if nothing is played.
    scale : float
        Factor that scales the played attribute to mass 1.
    outputs : dict
        Other outputs by kind: names of groups and color attributes, paths of images.
    """

    inputs: list[str] = field(default_factory=list)
    settings: dict[str, object] = field(default_factory=dict)
    records: list[dict[str, object]] = field(default_factory=list)
    times: list[float] = field(default_factory=list)
    scale: float = 1.0
    outputs: dict[str, list[str]] = field(default_factory=dict)


def store_density(obj: bpy.types.Object, name: str, density: StoredDensity) -> None:
    """Store the description of a density with its object; descriptions of other densities are kept."""
    known = {other: stored_density(obj, other) for other in _readable_names(obj)}
    _write(obj, {**known, name: density})


def forget_density(obj: bpy.types.Object, name: str) -> None:
    """Remove the description of a density."""
    known = {other: stored_density(obj, other) for other in _readable_names(obj) if other != name}
    if known:
        _write(obj, known)
    elif DENSITIES_KEY in obj:
        del obj[DENSITIES_KEY]


def stored_density(obj: bpy.types.Object, name: str) -> StoredDensity:
    """Read and check a description written by `store_density`.

    Raises
    ------
    InputError
        There is no density of this name, or its description is damaged or from a newer version.
    """
    try:
        table = _table(obj)
        if name in table:
            return _checked(table[name])
    except (ValueError, TypeError, KeyError, RecursionError) as error:
        raise InputError(
            "The stored densities of {object} are damaged ({reason}); bake them again.",
            object=obj.name,
            reason=str(error),
        ) from error
    raise InputError("{object} has no baked density {name}; bake it first.", object=obj.name, name=name)


def stored_or_new(obj: bpy.types.Object, name: str) -> StoredDensity:
    """Return the stored description of a density, or an empty one if it is missing or damaged."""
    try:
        return stored_density(obj, name)
    except InputError:
        return StoredDensity()


def outputs_of_others(obj: bpy.types.Object, name: str, kind: str) -> Iterator[tuple[bpy.types.Object, str]]:
    """Yield the outputs of a kind that the other densities in the file have, each with the object it belongs to."""
    for other in bpy.data.objects:
        for own in _readable_names(other) if DENSITIES_KEY in other else ():
            if (other, own) != (obj, name):
                yield from ((other, output) for output in stored_density(other, own).outputs.get(kind, ()))


def _write(obj: bpy.types.Object, densities: dict[str, StoredDensity]) -> None:
    data = {"schema": SCHEMA, "densities": {name: vars(density) for name, density in densities.items()}}
    obj[DENSITIES_KEY] = json.dumps(data, allow_nan=False)


def _readable_names(obj: bpy.types.Object) -> list[str]:
    names = []
    try:
        table = _table(obj)
    except (ValueError, TypeError, KeyError, RecursionError):
        return names
    for name, data in table.items():
        try:
            _checked(data)
        except (ValueError, TypeError, KeyError):
            continue
        names.append(name)
    return names


def _table(obj: bpy.types.Object) -> dict[str, object]:
    text = obj.get(DENSITIES_KEY)
    if text is None:
        return {}
    if not isinstance(text, str):
        raise TypeError("not a text")
    if len(text) > MOST_CHARACTERS:
        raise ValueError(f"{len(text)} characters")
    densities = parsed_table(text, SCHEMA)["densities"]
    if not isinstance(densities, dict):
        raise TypeError("densities are not a table")
    return densities


def _checked(data: object) -> StoredDensity:
    """Return the description; raises an error that says what is wrong with it."""
    if not isinstance(data, dict):
        raise TypeError("not a table")
    density = StoredDensity(**{name: data[name] for name in StoredDensity.__dataclass_fields__})
    if not is_list_of(density.inputs, str):
        raise TypeError("inputs are not a list of names")
    if not (isinstance(density.settings, dict) and all(map(_is_plain, density.settings.values()))):
        raise TypeError("a setting is neither a number, a text nor a list of these")
    if not is_list_of(density.records, dict):
        raise TypeError("records are not a list of tables")
    if not is_list_of(density.times, (int, float)) or density.times != sorted(density.times):
        raise TypeError("times are not an ascending list of numbers")
    if isinstance(density.scale, bool) or not isinstance(density.scale, (int, float)) or not density.scale > 0:
        raise TypeError("scale is not a positive number")
    if not (isinstance(density.outputs, dict) and all(is_list_of(own, str) for own in density.outputs.values())):
        raise TypeError("outputs are not lists of names")
    return density


def _is_plain(value: object) -> bool:
    items = value if isinstance(value, list) else [value]
    return all(item is None or isinstance(item, (str, bool, int, float)) for item in items)
