# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of morphs, shared by the panel and the operator."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import bpy
from bpy.props import BoolProperty

from ..applications.flat.flat_settings import FlatSettings
from ..applications.morphs.morph_settings import MorphSettings
from ..bridge.animation_time import time_of_frame
from ..bridge.morphs.morph_request import MorphRequest
from ..bridge.natural_order import natural_key
from .from_schema import arguments_of, values_of, with_properties
from .morph_solver import OF_FLAT, SolverProperties


@with_properties(MorphRequest)
class MorphProperties(SolverProperties):
    """Properties of a morph, mixed into the scene's settings and the operator so that they are the same."""

    hide_inputs: BoolProperty(name="Hide Inputs", description="Hide the original objects after the bake", default=True)

    fit_range: BoolProperty(
        name="Fit Frame Range",
        description="Set the frame range of the scene to that of the morph, and turn the preview range off",
        default=False,
    )

    def request(self, weights: Sequence[float] | None = None) -> MorphRequest:
        """Return the request stored with a morph, in addition to the solver settings; `weights` for a single blend."""
        return MorphRequest(**values_of(self, MorphRequest), words=self.words, weights=weights)

    @property
    def used_layout(self) -> str:
        """The layout; one shape after another for shape keys, whatever layout is set."""
        return "PATH" if self.output == "SHAPE_KEYS" else self.layout

    def first_frame(self, scene: bpy.types.Scene) -> int:
        """Return the frame at which the morph starts: the time of its first key."""
        if self.start == "CUSTOM":
            return self.frame_start
        frame = scene.frame_current if self.start == "CURRENT" else scene.frame_start
        return math.ceil(time_of_frame(scene, frame))

    def sorted_shapes(self, objects: list[bpy.types.Object]) -> list[bpy.types.Object]:
        """Return the objects in the chosen order."""
        along_x = self.order == "LEFT_TO_RIGHT"
        return sorted(
            objects,
            key=lambda obj: (obj.matrix_world.translation.x if along_x else 0.0, natural_key(obj.name)),
            reverse=self.reverse,
        )

    def take_stored(self, stored: Mapping[str, object]) -> None:
        """Load the settings of a baked morph."""
        for name, value in stored_arguments(stored).items():
            setattr(self, name, value)


def stored_arguments(stored: Mapping[str, object]) -> dict[str, object]:
    """Return the stored settings of a morph as property values; raises ValueError for unknown choices.

    Settings unknown to the version that stored them are left out. Before motions existed, everything was transported.
    Before growth could be chosen, volume grew evenly, and there was no floor.
    """
    stored = {"motion": "transport", "growth": "volume", "on_floor": False, **stored}
    found = arguments_of(stored, MorphSettings) | arguments_of(stored, MorphRequest)
    found |= arguments_of(stored, FlatSettings, only=OF_FLAT)
    # Flat and solid shapes both have a resolution, but only one of them is stored.
    found.pop("resolution" if stored.get("flat") else "flat_resolution", None)
    return found
