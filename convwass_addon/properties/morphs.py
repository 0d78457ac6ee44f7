# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of morphs, as the panel shows them and the operator takes them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import bpy
from bpy.props import BoolProperty

from ..applications.flat.flat_settings import FlatSettings
from ..applications.morphs.morph_settings import MorphSettings
from ..bridge.morphs.morph_request import MorphRequest
from .from_schema import arguments_of, values_of, with_properties
from .morph_solver import OF_FLAT, SolverProperties


@with_properties(MorphRequest)
class MorphProperties(SolverProperties):
    """What a morph is asked for: mixed into the scene's settings and into the operator, so both are one."""

    hide_inputs: BoolProperty(
        name="Hide Inputs", description="Hide the original objects when the morph is done", default=True
    )

    fit_range: BoolProperty(
        name="Fit Frame Range",
        description="Let the scene start and end with the morph; otherwise its frame range stays as it is",
        default=False,
    )

    def request(self, weights: Sequence[float] | None = None) -> MorphRequest:
        """Return what is stored with a morph besides the settings of its solver; of a single blend its `weights`."""
        return MorphRequest(**values_of(self, MorphRequest), words=self.words, weights=weights)

    def first_frame(self, scene: bpy.types.Scene) -> int:
        """Return the scene frame in which the morph begins."""
        if self.start == "CUSTOM":
            return self.frame_start
        return scene.frame_current if self.start == "CURRENT" else scene.frame_start

    def sorted_shapes(self, objects: list[bpy.types.Object]) -> list[bpy.types.Object]:
        """Return the objects in the order asked for."""
        along_x = self.order == "LEFT_TO_RIGHT"
        return sorted(
            objects,
            key=lambda obj: (obj.matrix_world.translation.x if along_x else 0.0, obj.name),
            reverse=self.reverse,
        )

    def take_stored(self, stored: Mapping[str, object]) -> None:
        """Take over what a baked morph was asked for."""
        for name, value in stored_arguments(stored).items():
            setattr(self, name, value)


def stored_arguments(stored: Mapping[str, object]) -> dict[str, object]:
    """Return what a baked morph was asked for as values of :class:`MorphProperties`; ValueError for unknown choices.

    What an earlier version did not store is left out; before there were motions, everything was transported.
    """
    stored = {"motion": "transport", **stored}
    found = arguments_of(stored, MorphSettings) | arguments_of(stored, MorphRequest)
    found |= arguments_of(stored, FlatSettings, only=OF_FLAT)
    # Both have one, and only that of the shapes at hand is stored.
    found.pop("resolution" if stored.get("flat") else "flat_resolution", None)
    return found
