# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of morphs, stored in the scene, with the list of shapes."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, field

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

from ..bridge.shape_sources import is_part
from .morphs import MorphProperties
from .registration import registration

VERDICTS = (
    ("UNCHECKED", "Not Checked", "The shape has not been checked yet"),
    ("SOUND", "Sound", "The shape is closed and its faces point outward"),
    ("FLIPPED", "Flipped Faces", "Some faces point inward; they are corrected for the morph"),
    ("HOLES", "Holes", "The surface is open; the volume that it nearly encloses is used"),
    ("NO_VOLUME", "No Volume", "The shape encloses no volume and needs a thickness"),
    ("UNUSABLE", "Unusable", "The shape cannot be read"),
)
"""Results of a check of an input, as items of an enum; from the third on they are shown as a warning."""


# Seconds for which the objects with children are taken to stay the same. When a list of objects opens, Blender asks for
# every object of the file, which takes less than that; asking each for its children would search the file each time.
_KEPT = 0.1


@dataclass
class _Parents:
    """The session ids of all objects with children."""

    uids: set[int] = field(default_factory=set)
    until: float = 0.0

    def __contains__(self, obj: bpy.types.Object) -> bool:
        if time.monotonic() >= self.until:
            parents = (child.parent for child in bpy.data.objects)
            self.uids = {parent.session_uid for parent in parents if parent is not None}
            self.until = time.monotonic() + _KEPT
        return obj.session_uid in self.uids


_PARENTS = _Parents()


def _is_shape(_item: CONVWASS_PG_input, obj: bpy.types.Object) -> bool:
    return is_part(obj) or obj in _PARENTS


class CONVWASS_PG_input(bpy.types.PropertyGroup):
    """A shape on the list of inputs."""

    object: PointerProperty(
        name="Shape",
        description="Object to morph: a mesh, text, curve, drawing or image",
        type=bpy.types.Object,
        poll=_is_shape,
    )
    weight: FloatProperty(
        name="Weight",
        description="Share of this shape in a single blend, relative to the others",
        default=1.0,
        min=0.0,
        soft_max=1.0,
    )
    enabled: BoolProperty(name="Enabled", description="Whether this shape is used in the morph", default=True)
    verdict: EnumProperty(name="Check", description="Result of the last check", items=VERDICTS)
    finding: StringProperty(name="Finding", description="Result of the last check, in a sentence")

    @property
    def warns(self) -> bool:
        """Whether the last check found a problem."""
        return self.verdict not in ("UNCHECKED", "SOUND")


class CONVWASS_PG_morph(MorphProperties, bpy.types.PropertyGroup):
    """Morph settings of a scene."""

    inputs: CollectionProperty(
        name="Inputs",
        description="Shapes to morph, in this order; if empty, the selected shapes",
        type=CONVWASS_PG_input,
    )
    active_input: IntProperty(
        name="Active Input", description="The input that the buttons next to the list act on", min=0
    )

    def take_inputs(self, objects: Sequence[bpy.types.Object], weights: Sequence[float] | None = None) -> None:
        """Replace the list by these shapes, or clear it if selecting them gives the same result."""
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
        """The enabled inputs."""
        return [item for item in self.inputs if item.enabled]


register, unregister = registration(
    (CONVWASS_PG_input, CONVWASS_PG_morph), ((bpy.types.Scene, "convwass_morph", CONVWASS_PG_morph),)
)
