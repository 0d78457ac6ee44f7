# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Records stored on an object with shape keys to other shapes."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace

import bpy

from ...applications.morphs.morph_settings import MorphSettings
from ...errors import InputError
from ..morphs.changes import SIGNATURES_KEY
from ..morphs.morph_request import MorphRequest
from ..morphs.stored import MORPH_KEY, StoredMorph
from ..object_names import library_of
from ..shape_sources import OBJECTS
from .baked_keys import SWAP_KEY

RECORD_KEY = "convwass_shape_keys"
"""Custom property of the object: JSON of the records of all paths."""

SHAPES_KEY = "convwass_shapes"
"""Custom property of the object: the other shapes by the names of their sliders."""

BAKE_KEYS = (RECORD_KEY, SHAPES_KEY, SWAP_KEY, MORPH_KEY, SIGNATURES_KEY)
"""All custom properties that a bake stores, apart from what it has hidden."""


def has_key_record(obj: bpy.types.Object | None) -> bool:
    """Return whether an object has shape keys to other shapes."""
    return obj is not None and RECORD_KEY in obj and obj.type == "MESH" and obj.data.shape_keys is not None


def key_records(obj: bpy.types.Object) -> list[dict[str, object]]:
    """Return the stored records of every path of an object.

    Raises
    ------
    InputError
        There are none, or they are damaged.
    """
    try:
        records = json.loads(obj[RECORD_KEY])
        if all(isinstance(record["name"], str) and len(record["times"]) > 0 for record in records):
            return records
    except (KeyError, TypeError, ValueError, RecursionError):
        pass
    raise InputError("{name} has no shape keys of this add-on; make them again.", name=obj.name)


def key_names(name: str, count: int) -> list[str]:
    """Return the names of the shape keys of a path."""
    return [name] if count == 1 else [f"{name} {number}" for number in range(1, count + 1)]


def recorded_keys(record: dict[str, object]) -> list[str]:
    """Return the names of the shape keys of the path that a record describes."""
    return key_names(record["name"], len(record["times"]))


def slider_names(obj: bpy.types.Object) -> list[str]:
    """Return the names of the sliders of an object; none if it has no shape keys to other shapes."""
    try:
        names = [record["name"] for record in key_records(obj)]
    except InputError:
        names = []
    swap = obj.get(SWAP_KEY)
    return list(dict.fromkeys([*names, *([swap["slider"]] if swap and swap.get("object") == obj else [])]))


def described_bake(
    inputs: Sequence[bpy.types.Object], request: MorphRequest, settings: MorphSettings, first_frame: int
) -> StoredMorph:
    """Return the description with which shape keys can be baked again; stored by :func:`.stored.store`."""
    # The vertices of a mesh are those of a single object.
    options = replace(request, layout="PATH", output="SHAPE_KEYS", grouping=OBJECTS).as_dict()
    libraries = [library_of(obj) for obj in inputs]
    return StoredMorph([obj.name for obj in inputs], {**settings.as_dict(), **options}, first_frame, [], libraries)


def store_records(obj: bpy.types.Object, records: Sequence[dict[str, object]]) -> None:
    """Store the records of the paths on the object."""
    obj[RECORD_KEY] = json.dumps(list(records))


def objects_of(keyed: bpy.types.Object) -> list[bpy.types.Object]:
    """Return an object with shape keys, and the one that replaces it, if there is one."""
    others = (obj for obj in bpy.data.objects if obj != keyed and SWAP_KEY in obj)
    return [keyed, *(obj for obj in others if obj[SWAP_KEY].get("object") == keyed)]
