# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Which shapes a bake takes: those that are named, else those on the scene's list, else those that are selected."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import bpy

from ..bridge.active import selected_objects
from ..bridge.flat.flat_kinds import is_shape
from ..errors import InputError
from ..properties.morphs import MorphProperties

# Types of objects that Blender turns into meshes, and those that have no surface to turn into one.
_CONVERTIBLE = ("META", "SURFACE", "VOLUME")
_WITHOUT_THICKNESS = ("CURVES", "POINTCLOUD")


@dataclass(frozen=True)
class ChosenInputs:
    """Shapes to morph.

    Attributes
    ----------
    objects : list of bpy.types.Object
        In the order of the morph.
    weights : list of float
        For a single blend, one per shape.
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
        Whose scene and selection count.
    settings : MorphProperties
        For the order of shapes that are selected.
    names : str
        Names of objects, one per line or with commas between them; empty for those on the list or selected.
    weights : str
        Numbers with commas between them, one per shape; empty for those on the list, or all alike.

    Raises
    ------
    InputError
        Fewer than two shapes, selected objects that must be converted first, names that are not there, or weights that
        do not fit.
    """
    listed = context.scene.convwass_morph.enabled_inputs
    if names.strip():
        objects = [_named(name) for name in split_names(names)]
        numbers = [1.0] * len(objects)
    elif context.scene.convwass_morph.inputs:
        for item in listed:
            if item.object is None or item.object.name not in context.scene.objects:
                raise InputError("A shape on the list of inputs has been deleted; remove it from the list.")
        objects, numbers = [item.object for item in listed], [item.weight for item in listed]
    else:
        selected = selected_objects(context)
        objects = settings.sorted_shapes([obj for obj in selected if is_shape(obj)])
        refuse_others(selected)
        numbers = [1.0] * len(objects)
    if weights.strip():
        numbers = _numbers(weights)
    if len(objects) < 2:
        raise InputError(
            "Select at least two shapes (meshes, texts, curves, drawings or images), or put them on the list of inputs."
        )
    return ChosenInputs(objects, numbers)


def refuse_others(objects: Sequence[bpy.types.Object]) -> None:
    """Refuse objects that have a shape which cannot be read, and say how to make a mesh of them; raises InputError.

    Cameras, lights and other objects without a shape are passed over.
    """
    for obj in objects:
        if obj.type == "EMPTY" and obj.instance_type == "COLLECTION":
            raise InputError(
                "{name} shows a collection: choose Object > Apply > Make Instances Real, and join the parts.",
                name=obj.name,
            )
        if obj.type in _CONVERTIBLE:
            raise InputError("{name} is no mesh: choose Object > Convert > Mesh.", name=obj.name)
        if obj.type in _WITHOUT_THICKNESS:
            raise InputError(
                "{name} has no surface: give its points or strands a radius with Geometry Nodes (Curve to Mesh, Points "
                "to Volume), and choose Object > Convert > Mesh.",
                name=obj.name,
            )


def split_names(text: str) -> list[str]:
    """Split a list of names: at the ends of lines if there are any, else at commas."""
    names = text.splitlines() if "\n" in text.strip() else text.split(",")
    return [name.strip() for name in names if name.strip()]


def _named(name: str) -> bpy.types.Object:
    obj = bpy.data.objects.get(name)
    if obj is None:
        raise InputError("There is no object named {name}; check the names of the inputs.", name=name)
    return obj


def _numbers(text: str) -> list[float]:
    try:
        return [float(word) for word in text.split(",")]
    except ValueError as error:
        raise InputError("Weights are numbers with commas between them, not {text!r}.", text=text) from error
