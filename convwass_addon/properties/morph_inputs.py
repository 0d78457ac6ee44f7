# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of morphs in a scene, with the list of shapes."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from ..bridge.flat.flat_kinds import is_shape
from .morphs import MorphProperties

VERDICTS = (
    ("UNCHECKED", "Not Checked", "Nobody has looked at this shape yet"),
    ("SOUND", "Sound", "The shape is closed and its faces look outward"),
    ("FLIPPED", "Flipped Faces", "Some faces look the wrong way; they are turned over for the morph"),
    ("HOLES", "Holes", "The surface is open; what it nearly encloses is taken for its inside"),
    ("NO_VOLUME", "No Volume", "The shape encloses nothing that could be moved, unless it is given thickness"),
    ("UNUSABLE", "Unusable", "The shape cannot be read"),
)
"""What a check found out about an input, as items of an enum; from the third one on there is a warning."""


def _is_shape(_item: CONVWASS_PG_input, obj: bpy.types.Object) -> bool:
    return is_shape(obj)


class CONVWASS_PG_input(bpy.types.PropertyGroup):
    """A shape on the list of inputs."""

    object: PointerProperty(
        name="Shape",
        description="Object that takes part in the morph: a mesh, a text, a curve, a drawing or an image",
        type=bpy.types.Object,
        poll=_is_shape,
    )
    weight: FloatProperty(
        name="Weight",
        description="Share of this shape in a single blend, compared with those of the others",
        default=1.0,
        min=0.0,
        soft_max=1.0,
    )
    enabled: BoolProperty(name="Enabled", description="Whether this shape takes part in the morph", default=True)
    verdict: EnumProperty(name="Check", description="What the last check found out", items=VERDICTS)
    finding: StringProperty(name="Finding", description="What the last check found out, in a sentence")

    @property
    def warns(self) -> bool:
        """Whether the last check found something wrong."""
        return self.verdict not in ("UNCHECKED", "SOUND")


class CONVWASS_PG_morph(MorphProperties, bpy.types.PropertyGroup):
    """Morph settings of a scene."""

    inputs: CollectionProperty(
        name="Inputs",
        description="Shapes to morph, in this order; while there are none, those that are selected are morphed",
        type=CONVWASS_PG_input,
    )
    active_input: IntProperty(name="Active Input", description="The input that buttons beside the list act on", min=0)

    def take_inputs(self, objects: Sequence[bpy.types.Object], weights: Sequence[float] | None = None) -> None:
        """Put shapes on the list, unless selecting them says as much: then empty it."""
        self.inputs.clear()
        self.active_input = 0
        if weights is None and self.sorted_shapes(list(objects)) == list(objects):
            return
        for index, obj in enumerate(objects):
            item = self.inputs.add()
            item.object = obj
            item.weight = 1.0 if weights is None else weights[index]

    @property
    def enabled_inputs(self) -> list[CONVWASS_PG_input]:
        """The inputs on the list that take part."""
        return [item for item in self.inputs if item.enabled]


_classes = (CONVWASS_PG_input, CONVWASS_PG_morph)
_register_classes, _unregister_classes = bpy.utils.register_classes_factory(_classes)


def register() -> None:
    """Add the settings to scenes."""
    _register_classes()
    bpy.types.Scene.convwass_morph = PointerProperty(type=CONVWASS_PG_morph)


def unregister() -> None:
    """Take them away."""
    del bpy.types.Scene.convwass_morph
    _unregister_classes()
