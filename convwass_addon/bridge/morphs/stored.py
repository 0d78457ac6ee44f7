# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Store the description of a bake with its collection, and read it back."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace

import bpy
import numpy as np
from numpy.typing import NDArray

from ...applications.morphs.diagnostics import Diagnostic, diagnostic_figures
from ...errors import InputError
from ..animation_time import times_per_second
from ..keyframes import keyed_frames, shown_from
from ..object_names import ObjectName, objects_named, scene_copies
from ..stored_json import is_list_of, parsed_table

SCHEMA = 1

MORPH_KEY = "convwass_morph"
"""Custom property of a morph's collection or of an object with shape keys: JSON of a `StoredMorph` with the schema."""

WEIGHTS_KEY = "convwass_weights"
"""Custom property of a frame object: one weight per input."""

INDEX_KEY = "convwass_index"
"""Custom property of a frame object: its index in frame order, from 0."""

FRAME_KEY = "convwass_frame"
"""Custom property of a frame object on a path: its scene frame, counted from the start of the morph."""

ALONE_KEY = "convwass_alone"
"""Custom property of a single object that shows all frames of its morph."""

DIAGNOSTICS_KEY = "convwass_health"
"""Custom property of a morph's collection: JSON of the diagnostics, as kinds and values."""

FRAMES_KEY = "convwass_frames_of"
"""Custom property of the collection for the hidden frame objects of a morph: the morph's collection."""

SAMPLED_FROM = "sampled_from"
"""Setting of a morph whose frames are what a player showed: name of the morph that it played."""

FIRST_FRAMES = (-1_048_574, 1_048_574)
"""Lowest and highest frame in Blender."""

# Cells along the longest side of what is made from a morph without a resolution.
_FALLBACK_RESOLUTION = 100


@dataclass(frozen=True)
class StoredMorph:
    """The stored description of a bake.

    Attributes
    ----------
    inputs : list of str
        Names of the morphed objects.
    settings : dict
        Settings of the bake: numbers, strings, booleans, None and lists of these, and the guides as a list of dicts.
    first_frame : int
        Scene frame at which the morph starts.
    records : list of dict
        The solver's figures for each finished frame, without arrays and histories.
    libraries : list of str
        The library of each object, as in :class:`.ObjectName`; empty in morphs of earlier versions.
    per_second : float or None
        Frames per second to which the velocities of the frames refer, whatever the scene plays later; None in morphs of
        earlier versions.
    """

    inputs: list[str]
    settings: dict[str, object]
    first_frame: int
    records: list[dict[str, object]]
    libraries: list[str] = field(default_factory=list)
    per_second: float | None = None

    def rate_in(self, scene: bpy.types.Scene) -> float:
        """Return `per_second`, or the current rate of a scene if that is unknown."""
        return self.per_second or times_per_second(scene)

    @property
    def resolution(self) -> int:
        """Cells along the longest side in the bake, or a usual number for morphs without one."""
        return int(self.settings.get("resolution") or _FALLBACK_RESOLUTION)

    @property
    def names(self) -> list[ObjectName]:
        """The names of the morphed objects with their libraries."""
        libraries = self.libraries or [None] * len(self.inputs)
        return [ObjectName(*both) for both in zip(self.inputs, libraries, strict=True)]

    @property
    def objects(self) -> list[bpy.types.Object | None]:
        """The morphed objects; None for those that no longer exist under their name."""
        return objects_named(self.names)


def store(block: bpy.types.Collection | bpy.types.Object, morph: StoredMorph) -> None:
    """Store the description of a bake with its collection, or with its object with shape keys."""
    block[MORPH_KEY] = json.dumps({"schema": SCHEMA, **vars(morph)}, allow_nan=False)


def stored_morph(block: bpy.types.Collection | bpy.types.Object) -> StoredMorph:
    """Read and check a description written by `store`.

    In a full copy of a scene, the inputs are the copies.

    Raises
    ------
    InputError
        The collection is not a morph, or its description is damaged or from a newer version.
    """
    text = block.get(MORPH_KEY)
    if text is None:
        raise InputError(
            "The collection {name} is not a morph; choose one that was made by Bake Morph.", name=block.name
        )
    with refusing_damage(block.name):
        return _in_scenes(_checked(parsed_table(text, SCHEMA)), block)


def copied_inputs(
    block: bpy.types.Collection | bpy.types.Object, names: Sequence[ObjectName]
) -> dict[ObjectName, bpy.types.Object]:
    """Return the copies that objects of a morph have where its scene is a full copy; see :func:`.scene_copies`."""
    # Most files have one scene, and descriptions are read whenever a panel is drawn.
    return {} if len(bpy.data.scenes) == 1 else scene_copies(names, _scenes_of(block))


def _scenes_of(block: bpy.types.Collection | bpy.types.Object) -> list[bpy.types.Scene]:
    """Return the scenes that contain a morph."""
    if isinstance(block, bpy.types.Object):
        return list(block.users_scene)
    return [scene for scene in bpy.data.scenes if block in scene.collection.children_recursive]


def _in_scenes(morph: StoredMorph, block: bpy.types.Collection | bpy.types.Object) -> StoredMorph:
    """Return the description of a morph for its scenes, which may be full copies of the one in which it was baked."""
    copies = copied_inputs(block, morph.names)
    if not copies:
        return morph
    names = [ObjectName.of(copies[name]) if name in copies else name for name in morph.names]
    renamed = {before.name: after.name for before, after in zip(morph.names, names, strict=True)}
    guides = [_renamed(guide, renamed) for guide in _items(morph.settings.get("guides", []))]
    settings = {**morph.settings, "guides": guides} if guides else morph.settings
    libraries = [name.library or "" for name in names]
    return replace(morph, inputs=[name.name for name in names], libraries=libraries, settings=settings)


def _renamed(guide: dict[str, object], names: Mapping[str, str]) -> dict[str, object]:
    """Return a guide with other names of objects; damaged parts are reported where they are used."""
    tables = {key: value for key, value in guide.items() if isinstance(value, dict)}
    return guide | {key: {names.get(name, name): own for name, own in one.items()} for key, one in tables.items()}


@contextmanager
def refusing_damage(name: str) -> Iterator[None]:
    """Convert Python's errors on damaged data of a morph to InputError.

    Raises
    ------
    InputError
        Data is missing or invalid.
    """
    try:
        yield
    except InputError:
        raise
    except (LookupError, TypeError, ValueError, OverflowError, RecursionError) as error:
        raise InputError(
            "The settings stored on {name} are damaged ({reason}); bake the morph again from its inputs.",
            name=name,
            reason=str(error),
        ) from error


def stored_settings(block: bpy.types.Collection | bpy.types.Object) -> dict[str, object]:
    """Return the settings that a morph was baked with.

    Raises
    ------
    InputError
        As for `stored_morph`.
    """
    return stored_morph(block).settings


def sampled_from(block: bpy.types.Collection | bpy.types.Object) -> str | None:
    """Return the name of the morph whose player showed the frames of a morph; None if they were solved.

    Raises
    ------
    InputError
        As for `stored_morph`.
    """
    return stored_settings(block).get(SAMPLED_FROM)


def is_solid(collection: bpy.types.Collection) -> bool:
    """Tell whether the blends of a morph enclose volume: not those of flat shapes; raises as `stored_morph`."""
    return "flat" not in stored_settings(collection)


def interpolates(collection: bpy.types.Collection, between: str) -> bool:
    """Return whether a player or a pad mixes blends, given what it shows in between: flat ones are never mixed."""
    return between == "INTERPOLATED" and is_solid(collection)


def stored_inputs(block: bpy.types.Collection | bpy.types.Object) -> list[bpy.types.Object]:
    """Return the objects that a morph was baked from, or that represent its shapes; they may be hidden.

    Raises
    ------
    InputError
        As for `stored_morph`, or an object no longer exists.
    """
    stored = stored_morph(block)
    objects = stored.objects
    missing = dict.fromkeys(name for name, obj in zip(stored.inputs, objects, strict=True) if obj is None)
    if missing:
        raise InputError(
            "{name} was baked from {missing}, which no longer exists under that name; rename it back, or select the "
            "shapes and bake a new morph.",
            name=block.name,
            missing=", ".join(missing),
        )
    return objects


def frame_objects(collection: bpy.types.Collection) -> list[bpy.types.Object]:
    """Return the frame objects of a morph in order, without duplicates that its user has made of them."""
    frames = sorted(_framelike(collection), key=_place)
    originals: dict[object, bpy.types.Object] = {}
    for obj in sorted(frames, key=_likeliness):
        index = obj.get(INDEX_KEY)
        # Damaged frames may lack an index.
        originals.setdefault(index if isinstance(index, (int, float)) else obj, obj)
    kept = set(originals.values())
    return [obj for obj in frames if obj in kept and _weight_count(obj) == _weight_count(frames[0])]


def some_frame_objects(collection: bpy.types.Collection) -> list[bpy.types.Object]:
    """Return the frame objects of a morph, of which there is at least one; raises InputError if there is none."""
    frames = frame_objects(collection)
    if not frames:
        raise InputError("The collection {name} contains no frames of a morph; bake one first.", name=collection.name)
    return frames


def release_duplicates(collection: bpy.types.Collection) -> None:
    """Turn duplicates of the frame objects of a morph into ordinary objects."""
    for obj in set(_framelike(collection)).difference(frame_objects(collection)):
        for key in (INDEX_KEY, FRAME_KEY, WEIGHTS_KEY):
            obj.pop(key, None)


def frame_weights(frames: Sequence[bpy.types.Object]) -> NDArray[np.float64]:
    """Return the weights of frame objects, (f, k)."""
    return np.array([list(obj[WEIGHTS_KEY]) for obj in frames])


def frame_number(obj: bpy.types.Object) -> int:
    """Return the scene frame of a frame object on a path, counted from the start of the morph.

    Earlier versions did not store it; it is then taken to be the index of the frame object.
    """
    return int(obj.get(FRAME_KEY, obj[INDEX_KEY]))


def starting_frame(collection: bpy.types.Collection) -> int:
    """Return the scene frame at which a morph starts: another one than in the bake if all keys were moved since.

    Raises
    ------
    InputError
        As for `stored_morph`.
    """
    # The first frame object is shown from the beginning of time.
    shown = [(shown_from(obj), frame_number(obj)) for obj in frame_objects(collection)[1:]]
    starts = {None if time is None else time - number for time, number in shown}
    start = starts.pop() if len(starts) == 1 else None
    is_frame = start is not None and start == round(start) and FIRST_FRAMES[0] <= start <= FIRST_FRAMES[1]
    return round(start) if is_frame else stored_morph(collection).first_frame


def frame_times(collection: bpy.types.Collection) -> NDArray[np.float64]:
    """Return when the frames of a path begin to be shown, (n,): as they were baked, or where all keys are now.

    The first one is shown from the beginning of time; it begins at the pace of those after it.

    Raises
    ------
    InputError
        As for `stored_morph`.
    """
    frames = frame_objects(collection)
    numbers = np.array([frame_number(obj) for obj in frames], dtype=np.float64)
    keyed = [shown_from(obj) for obj in frames[1:]]
    if None in keyed or len(keyed) < 2 or (np.diff(keyed) <= 0.0).any() or numbers[2] <= numbers[1]:
        return starting_frame(collection) + numbers
    pace = (keyed[1] - keyed[0]) / (numbers[2] - numbers[1])
    return np.array([keyed[0] - pace * (numbers[1] - numbers[0]), *keyed])


def hidden_frames(collection: bpy.types.Collection) -> bpy.types.Collection | None:
    """Return the subcollection with the hidden frame objects of a morph, or None."""
    return next((child for child in collection.children if FRAMES_KEY in child), None)


def shown_frames(collection: bpy.types.Collection) -> range:
    """Return the scene frames of a morph from its first to its last shape; empty if it is static.

    The range of the scene is not used, since it may belong to another morph.

    Parameters
    ----------
    collection : bpy.types.Collection
        A baked morph.
    """
    keyed = keyed_frames(frame_objects(collection))
    if not keyed:
        return keyed
    try:
        # If the first shape lasts for several frames, its key is at their end.
        return range(min(keyed.start, math.floor(frame_times(collection)[0])), keyed.stop)
    except InputError:
        return keyed


def _framelike(collection: bpy.types.Collection) -> list[bpy.types.Object]:
    """Return the frame objects of a morph and their duplicates."""
    hidden = hidden_frames(collection)
    return [obj for obj in (*collection.objects, *(() if hidden is None else hidden.objects)) if _weight_count(obj)]


def _likeliness(obj: bpy.types.Object) -> tuple[bool, str]:
    """Return a key that is smaller for a frame object than for its duplicates, which are often no longer animated."""
    return obj.animation_data is None, obj.name


def _weight_count(obj: bpy.types.Object) -> int:
    """Return the number of weights stored on a frame object, or 0."""
    stored = obj.get(WEIGHTS_KEY)
    return len(stored) if getattr(stored, "typecode", "") in ("f", "d") else 0


def _place(obj: bpy.types.Object) -> float:
    place = obj.get(INDEX_KEY, 0)
    return place if isinstance(place, (int, float)) else 0


def summary(record: dict[str, object]) -> dict[str, object]:
    """Return the scalar figures of a record; lists would bloat the file, and JSON does not support NaN."""
    return {
        name: None if isinstance(value, float) and not math.isfinite(value) else value
        for name, value in {**record, **diagnostic_figures(record)}.items()
        if value is None or isinstance(value, (str, bool, int, float))
    }


def store_diagnostics(collection: bpy.types.Collection, notes: Sequence[Diagnostic]) -> None:
    """Store the diagnostics of a bake with its collection."""
    collection[DIAGNOSTICS_KEY] = json.dumps([[note.kind, note.values] for note in notes], allow_nan=False)


def stored_diagnostics(collection: bpy.types.Collection) -> list[Diagnostic]:
    """Read the diagnostics written by `store_diagnostics`; empty if they are missing or damaged."""
    try:
        notes = [Diagnostic(kind, values) for kind, values in json.loads(collection.get(DIAGNOSTICS_KEY, "[]"))]
        return [note for note in notes if note.text]
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError):
        return []


def _checked(data: dict[str, object]) -> StoredMorph:
    """Return the description; raises an error that says what is wrong with it."""
    inputs, settings, first_frame, records = (data[key] for key in ("inputs", "settings", "first_frame", "records"))
    if not (is_list_of(inputs, str) and inputs and all(inputs)):
        raise TypeError("inputs are not a list of names")
    libraries = data.get("libraries", [])
    if not is_list_of(libraries, str):
        raise TypeError("libraries are not a list of paths")
    if len(libraries) not in (0, len(inputs)):
        raise ValueError(f"there are {len(libraries)} libraries for {len(inputs)} inputs")
    if not isinstance(settings, dict):
        raise TypeError("settings are not a table")
    for name, value in settings.items():
        # Guides are dicts, which are checked where they are used.
        kinds = dict if name == "guides" else (str, bool, int, float, None.__class__)
        if not all(isinstance(item, kinds) for item in _items(value)):
            raise TypeError(f"setting {name} is neither a number, a text nor a list of these")
    if isinstance(first_frame, bool) or not isinstance(first_frame, int):
        raise TypeError("first_frame is not an integer")
    if not FIRST_FRAMES[0] <= first_frame <= FIRST_FRAMES[1]:
        raise ValueError(f"first_frame is {first_frame}")
    if not is_list_of(records, dict):
        raise TypeError("records are not a list of tables")
    return StoredMorph(inputs, settings, first_frame, records, libraries, _rate(data.get("per_second")))


def _rate(value: object) -> float | None:
    """Return frames per second, or None if they are unknown."""
    if value is None:
        return None
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not 0.0 < value < math.inf:
        raise TypeError(f"per_second is {value!r}")
    return float(value)


def _items(value: object) -> list[object]:
    """Return a list unchanged, and any other value as a list of one."""
    return value if isinstance(value, list) else [value]
