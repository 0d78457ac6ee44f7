# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Bake a morph for a player or a pad that mixes its frames: their fields are sampled before the bake ends."""

from __future__ import annotations

import bpy

from ...applications.morphs.bake_plan import MorphPreview
from ...applications.morphs.computation import USUAL_COMPUTATION, Computation
from ...applications.morphs.morph_problem import MorphFrame
from ...progress import UNINTERRUPTED, Control, Progress, Request, Work, within
from ...sentence import Sentence
from ..files.openvdb_module import openvdb_module
from ..scene_context import in_scene
from .disk.disk_output import read_files
from .fields.field_job import FieldJob
from .fields.field_sampling import SampledFields
from .job import MorphJob
from .morph_request import MorphRequest
from .players.player_inputs import can_mix
from .stand_ins import stand_ins

# Share of the progress bar for the frames.
_FRAMES_SHARE = 0.8


class MixedMorphJob(MorphJob):
    """A :class:`.job.MorphJob` that also samples the fields of its frames, while it can be stopped."""

    _fields: FieldJob | None = None

    def steps(self, control: Control = UNINTERRUPTED, computation: Computation = USUAL_COMPUTATION) -> Work[None]:
        """Compute the frames, and sample them once they are in the scene."""
        yield from within(super().steps(control, computation), 0.0, _FRAMES_SHARE)
        request: Request[FieldJob] = Request()
        yield Progress(_FRAMES_SHARE, Sentence("Reading the meshes"), request)
        yield from within(request.value.steps(control), _FRAMES_SHARE, 1.0)

    def write(self, report: Progress[MorphFrame | MorphPreview | Request[FieldJob]]) -> None:
        """Add a finished frame or a preview to the scene, or read all frames."""
        if isinstance(report.payload, Request):
            with in_scene(self._bake.scene):
                self._fields = FieldJob(self._bake.collection, "INTERPOLATED")
            report.payload.answer(self._fields)
        else:
            super().write(report)

    @property
    def sampled(self) -> SampledFields | None:
        """The fields of the frames; None if these have changed since, or there was no time to sample them."""
        return self._fields.sampled if self._fields is not None and self._fields.is_current else None


def will_mix(replaced: bpy.types.Collection | None, request: MorphRequest) -> bool:
    """Return whether a player or a pad will mix the frames of a bake, which may replace those of a morph."""
    shown_by = [] if replaced is None else [obj for obj in stand_ins(replaced) if obj.users_collection]
    if shown_by:
        return any(can_mix(obj) for obj in shown_by)
    if openvdb_module() is None or (replaced is not None and read_files(replaced) is not None):
        return False
    return request.output == "PLAYER" and request.between == "INTERPOLATED"
