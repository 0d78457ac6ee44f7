# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Morph objects of the scene: read the inputs, run the computation, write the frames."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import bpy

from ...applications.morphs.bake_plan import MorphPreview
from ...applications.morphs.between_frames import between_frames
from ...applications.morphs.computation import USUAL_COMPUTATION, Computation
from ...applications.morphs.layouts import Blend
from ...applications.morphs.morph import morph
from ...applications.morphs.morph_problem import MorphFrame
from ...applications.morphs.morph_settings import MorphSettings
from ...applications.morphs.part_labels import part_notices
from ...errors import InputError
from ...progress import UNINTERRUPTED, Control, Progress, Work
from ...sentence import Sentence
from ..shape_sources import OBJECTS, shape_sources
from .bake import MorphBake
from .inputs.animated_inputs import animation_notices
from .inputs.followed_inputs import FOLLOW, followed_inputs, keep_animated
from .inputs.shape_reading import read_shapes
from .looks.carrying import Carrying
from .looks.look_mixing import FADE


class MorphJob:
    """Bakes a morph in the current scene. All methods except :meth:`steps` must be called on the main thread.

    Parameters
    ----------
    inputs : sequence of bpy.types.Object
        The shapes in order.
    blends : sequence of Blend
        The blends to compute.
    settings : MorphSettings
        Settings of the morph.
    options : dict
        Further settings stored with the morph, so that it can be repeated, such as the layout. `grouping`, as for
        :func:`.shape_sources.shape_source`, `alignment` and `scaling`, as for :func:`.alignment.aligned`, `guides`,
        `faces` and `looks` are used here.
    first_frame : int
        Scene frame of the first shape of a path.

    Raises
    ------
    InputError
        An input has no faces, no size, or is not a mesh; or the requested parts have no match.
    """

    def __init__(
        self,
        inputs: Sequence[bpy.types.Object],
        blends: Sequence[Blend],
        settings: MorphSettings,
        options: dict[str, object],
        first_frame: int,
    ) -> None:
        if len(inputs) < 2:
            raise InputError("A morph needs at least two shapes; select or name another one.")
        self._records: dict[Blend, dict[str, object]] = {}
        sources = shape_sources(inputs, options.get("grouping", OBJECTS))
        self._follows = options.get("follow") == FOLLOW
        self._animated = []
        if not self._follows:
            self._animated = animation_notices([part for one in sources for part in one.parts])
        read = read_shapes(inputs, bpy.context.evaluated_depsgraph_get(), settings, options)
        self._blends = blends
        self._settings = settings
        self._looked_at = _looked_at(blends, bpy.context.scene.frame_current_final - first_frame)
        followed = followed_inputs(sources, blends, read.moves, first_frame) if self._follows else None
        self._inputs = read.inputs if followed is None else replace(read.inputs, animation=followed.animation)
        self._moves = read.moves
        self._bake = MorphBake.begin(inputs, blends, {**settings.as_dict(), **options}, first_frame, read.moves)
        if followed is not None:
            self._bake.show_copies(followed.stations)
        self._carrying = None
        if settings.carry:
            looks, quads = options.get("looks", FADE), options.get("faces") == "QUADS"
            self._carrying = Carrying(self._bake.inputs, self._bake.frozen, blends, looks, quads)

    def steps(self, control: Control = UNINTERRUPTED, computation: Computation = USUAL_COMPUTATION) -> Work[None]:
        """Return the computation, which does not access Blender's data. See :func:`.morph.morph`."""
        work = morph(
            self._inputs,
            self._blends,
            self._settings,
            control,
            computation=replace(computation, looked_at=self._looked_at),
        )
        return work if self._carrying is None else self._carrying.looked_up(work)

    def steps_between(self, path: Sequence[Blend], numbers: Sequence[float], computation: Computation) -> Work[None]:
        """Return the computation of blends between the frames of a path.

        See :func:`.between_frames.between_frames`; the inputs must not be followed.
        """
        work = between_frames(self._inputs, path, numbers, self._settings, computation)
        return work if self._carrying is None else self._carrying.looked_up(work)

    @property
    def records(self) -> list[dict[str, object]]:
        """The solver's record of every finished frame, in frame order."""
        return list(self._records.values())

    @property
    def notices(self) -> list[Sentence]:
        """Messages about the inputs and their parts, once frames are finished."""
        found = dict.fromkeys(notice for record in self.records for notice in part_notices(record))
        dropped = self._carrying.dropped if self._carrying else []
        unshown = [note.sentence for note in dropped if note.severity != "INFO"]
        return [*self._animated, *(notice.sentence for notice in found), *unshown]

    def write(self, report: Progress[MorphFrame | MorphPreview]) -> None:
        """Add a finished frame or a preview to the scene."""
        found = report.payload
        if isinstance(found, MorphPreview):
            self._bake.preview(found.frame)
        elif found is not None:
            obj = self._bake.add(found)
            if self._follows and found.blend in (self._blends[0], self._blends[-1]):
                index = found.blend.source
                keep_animated(obj, self._bake.inputs[index], None if self._moves is None else self._moves[index])
            if self._carrying is not None:
                self._carrying.write(obj.data, found)
            self._records[found.blend] = found.record

    def finish(self, hide_inputs: bool) -> bpy.types.Collection:
        """Finish the bake; see :meth:`.bake.MorphBake.finish`."""
        try:
            return self._bake.finish(hide_inputs, self._carrying.dropped if self._carrying else ())
        finally:
            self._drop_unused()

    def keep_previews(self) -> bool:
        """Keep the previews if nothing else is finished; see :meth:`.bake.MorphBake.keep_previews`."""
        return self._bake.keep_previews()

    @property
    def span(self) -> tuple[float, float] | None:
        """First and last frame; see :attr:`.bake.MorphBake.span`."""
        return self._bake.span

    def discard(self) -> None:
        """Remove everything written so far."""
        self._bake.discard()
        self._drop_unused()

    def _drop_unused(self) -> None:
        """Remove materials made for the frames that are not used."""
        if self._carrying is not None:
            self._carrying.drop_unused()


def _looked_at(blends: Sequence[Blend], frame: float) -> int:
    """Return the index of the blend nearest to a frame counted from the start of a path; 0 for a sheet."""
    if blends[0].frame is None:
        return 0
    return min(range(len(blends)), key=lambda number: abs(blends[number].frame - frame))
