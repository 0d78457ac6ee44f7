# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The inputs of a bake: the named shapes, else the scene's list, else the selected objects."""

from __future__ import annotations

from collections.abc import Container, Sequence
from dataclasses import dataclass

import bpy

from ..bridge.active import selected_objects
from ..bridge.morphs.stored import stored_inputs, stored_settings
from ..bridge.shape_sources import OBJECTS, is_part, require_found, shape_roots, shape_source, shape_sources
from ..errors import InputError
from ..properties.morphs import MorphProperties


@dataclass(frozen=True)
class ChosenInputs:
    """The shapes to morph.

    Attributes
    ----------
    objects : list of bpy.types.Object
        In morph order.
    weights : list of float
        One per shape, for a single blend.
    """

    objects: list[bpy.types.Object]
    weights: list[float]


def chosen_inputs(
    context: bpy.types.Context, settings: MorphProperties, names: str = "", weights: str = ""
) -> ChosenInputs:
    """Find the shapes to morph.

    Parameters
    ----------
    context : bpy.types.Context
        Provides the scene and the selection.
    settings : MorphProperties
        Defines the order of selected shapes.
    names : str
        Names of objects, one per line or separated by commas; empty for the shapes on the list or selected.
    weights : str
        Numbers separated by commas, one per shape; empty for the weights on the list, or equal weights.

    Raises
    ------
    InputError
        There are fewer than two shapes, selected objects must be converted first, named objects do not exist, the
        library of one is missing, or the number of weights is wrong.
    """
    listed = context.scene.convwass_morph.enabled_inputs
    if names.strip():
        objects = [_named(name) for name in _separated(names)]
        numbers = [1.0] * len(objects)
    elif context.scene.convwass_morph.inputs:
        for number, item in enumerate(context.scene.convwass_morph.inputs, start=1):
            if item.enabled:
                _require_shape(item.object, number, context.scene)
        objects, numbers = [item.object for item in listed], [item.weight for item in listed]
    else:
        selected = selected_objects(context)
        objects = settings.sorted_shapes(shape_roots(selected, settings.grouping))
        _refuse_parts_of_one(objects, [obj for obj in selected if is_part(obj)], settings.grouping)
        numbers = [1.0] * len(objects)
    if weights.strip():
        numbers = _numbers(weights)
    if len(objects) < 2:
        raise InputError(
            "Select at least two shapes (meshes, texts, curves, drawings or images), or add them to the input list."
        )
    _require_found(objects, settings.grouping)
    return ChosenInputs(objects, numbers)


def baked_inputs(morph: bpy.types.Collection | bpy.types.Object, weights: str = "") -> ChosenInputs:
    """Return the shapes that a morph was baked from.

    Parameters
    ----------
    morph : bpy.types.Collection or bpy.types.Object
        A baked morph, or an object with shape keys.
    weights : str
        As for `chosen_inputs`; empty for equal weights.

    Raises
    ------
    InputError
        An object no longer exists, its library is missing, or the weights are invalid.
    """
    objects = stored_inputs(morph)
    _require_found(objects, stored_settings(morph).get("grouping", OBJECTS))
    return ChosenInputs(objects, _numbers(weights) if weights.strip() else [1.0] * len(objects))


def _refuse_parts_of_one(
    shapes: Sequence[bpy.types.Object], selected: Sequence[bpy.types.Object], grouping: str
) -> None:
    """Raise InputError if several selected objects are a single shape."""
    if len(shapes) != 1 or len(selected) < 2:
        return
    if grouping == OBJECTS:
        raise InputError(
            "{first} and {second} are one surface, as are all metaballs whose names differ only in the number; rename "
            "one of them.",
            first=selected[0].name,
            second=selected[1].name,
        )
    raise InputError(
        "All selected objects are parts of one shape, {name}; select another one too, or set Shapes to Objects.",
        name=shape_source(shapes[0], grouping).name,
    )


def _require_found(objects: Sequence[bpy.types.Object], grouping: str) -> None:
    for source in shape_sources(objects, grouping):
        require_found(source)


def _require_shape(obj: bpy.types.Object | None, number: int, scene: bpy.types.Scene) -> None:
    """Raise InputError if the shape with a number on the input list is not in a scene."""
    if obj is None:
        raise InputError("Shape {number} on the input list no longer exists; remove it from the list.", number=number)
    if not obj.users_scene:
        raise InputError("{name} on the input list was deleted; remove it from the list.", name=obj.name)
    if scene not in obj.users_scene:
        raise InputError(
            "{name} on the input list is not in this scene but in {other}; link it to this scene, or remove it from "
            "the list.",
            name=obj.name,
            other=obj.users_scene[0].name,
        )


def split_names(text: str, known: Container[str] = ()) -> list[str]:
    """Split a list of names, at line breaks if there are any, else at commas.

    Spaces around a name are removed, unless it is known with them.
    """
    return [name if name in known else name.strip() for name in _separated(text)]


def _separated(text: str) -> list[str]:
    names = text.splitlines() if "\n" in text.strip() else text.split(",")
    return [name for name in names if name.strip()]


def _named(name: str) -> bpy.types.Object:
    """Return the object of a name, without the spaces around it unless these belong to the name."""
    obj = bpy.data.objects.get(name) or bpy.data.objects.get(name.strip())
    if obj is None:
        raise InputError("There is no object named {name}; check the names of the inputs.", name=name.strip())
    return obj


def _numbers(text: str) -> list[float]:
    try:
        return [float(word) for word in text.split(",")]
    except ValueError as error:
        raise InputError("Weights must be numbers separated by commas, not {text!r}.", text=text) from error
