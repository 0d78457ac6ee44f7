# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A morph from objects of the scene to objects of the scene: reads, hands arrays over, writes what comes back."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor

import bpy

from ...applications.morphs.bake_plan import MorphPreview
from ...applications.morphs.between_frames import between_frames
from ...applications.morphs.computation import Computation
from ...applications.morphs.frame_cache import FrameCache
from ...applications.morphs.layouts import Blend
from ...applications.morphs.morph import morph
from ...applications.morphs.morph_problem import MorphFrame
from ...applications.morphs.morph_settings import MorphSettings
from ...applications.morphs.part_labels import part_notices
from ...errors import InputError
from ...progress import UNINTERRUPTED, Control, Progress, Work
from ...sentence import Sentence
from ..shape_sources import OBJECTS, shape_source
from .animated_inputs import animation_notices
from .bake import MorphBake
from .carrying import Carrying
from .shape_reading import read_shapes


class MorphJob:
    """One bake. Everything but :meth:`steps` belongs on the main thread.

    Parameters
    ----------
    scene : bpy.types.Scene
        Where the morph goes.
    depsgraph : bpy.types.Depsgraph
        For the inputs as modifiers leave them.
    inputs : sequence of bpy.types.Object
        The shapes, in order.
    blends : sequence of Blend
        What to make of them.
    settings : MorphSettings
        How.
    options : dict
        What else to store with the morph, so that it can be repeated: the layout and its numbers. `grouping`, as
        for :func:`.shape_sources.shape_source`, `alignment` and `scaling`, as for :func:`.alignment.aligned`, and
        `guides` are heeded here.
    first_frame : int
        Scene frame of the first shape in a path.

    Raises
    ------
    InputError
        Inputs that have no faces, no size, or are no meshes; no part that all of them have, where parts are asked for.
    """

    def __init__(
        self,
        scene: bpy.types.Scene,
        depsgraph: bpy.types.Depsgraph,
        inputs: Sequence[bpy.types.Object],
        blends: Sequence[Blend],
        settings: MorphSettings,
        options: dict[str, object],
        first_frame: int,
    ) -> None:
        if len(inputs) < 2:
            raise InputError("A morph needs at least two shapes; select or name one more.")
        self._records: dict[Blend, dict[str, object]] = {}
        sources = [shape_source(obj, options.get("grouping", OBJECTS)) for obj in inputs]
        self._animated = animation_notices([part for one in sources for part in one.parts], scene.frame_current)
        read = read_shapes(inputs, depsgraph, settings, options)
        self._names, self._shapes, self._labels, self._guides = read.names, read.meshes, read.labels, read.guides
        self._blends = blends
        self._settings = settings
        self._looked_at = _looked_at(blends, scene.frame_current - first_frame)
        self._bake = MorphBake.begin(scene, inputs, blends, {**settings.as_dict(), **options}, first_frame, read.moves)
        self._carrying = Carrying(scene, self._bake.inputs, self._bake.frozen, blends) if settings.carry else None

    def steps(self, control: Control = UNINTERRUPTED, how: Computation | None = None) -> Work[None]:
        """Return the work of computing; it touches nothing of Blender. See :func:`.morph.morph`."""
        how = how or Computation()
        work = morph(
            self._shapes,
            self._names,
            self._blends,
            self._settings,
            control,
            labels=self._labels,
            guides=self._guides,
            workers=how.workers,
            executor=how.executor,
            cache=how.cache,
            wanted=how.wanted,
            previews=how.previews,
            looked_at=self._looked_at,
        )
        return work if self._carrying is None else self._carrying.looked_up(work)

    def steps_between(
        self,
        path: Sequence[Blend],
        numbers: Sequence[float],
        cache: FrameCache,
        control: Control = UNINTERRUPTED,
        *,
        workers: int | None = None,
        executor: Executor | None = None,
    ) -> Work[None]:
        """Return the same for a job whose blends lie between the frames of a path.

        See :func:`.between_frames.between_frames`.
        """
        work = between_frames(
            self._shapes,
            self._names,
            path,
            numbers,
            self._settings,
            cache,
            control,
            labels=self._labels,
            guides=self._guides,
            workers=workers,
            executor=executor,
        )
        return work if self._carrying is None else self._carrying.looked_up(work)

    @property
    def records(self) -> list[dict[str, object]]:
        """What the solver says about every finished frame, in the order of the frames."""
        return list(self._records.values())

    @property
    def notices(self) -> list[Sentence]:
        """What the user should know about the inputs and their parts, once frames are finished."""
        found = dict.fromkeys(notice for record in self.records for notice in part_notices(record))
        dropped = self._carrying.dropped if self._carrying else []
        unshown = [note.sentence for note in dropped if note.severity != "INFO"]
        return [*self._animated, *(notice.sentence for notice in found), *unshown]

    def write(self, report: Progress[MorphFrame | MorphPreview]) -> None:
        """Put a finished frame into the scene, or a preview until there is one."""
        found = report.payload
        if isinstance(found, MorphPreview):
            self._bake.preview(found.frame)
        elif found is not None:
            obj = self._bake.add(found)
            if self._carrying is not None:
                self._carrying.write(obj.data, found)
            self._records[found.blend] = found.record

    def finish(self, hide_inputs: bool) -> bpy.types.Collection:
        """Make what has been written a morph; see :meth:`.bake.MorphBake.finish`."""
        try:
            return self._bake.finish(hide_inputs, self._carrying.dropped if self._carrying else ())
        finally:
            self._drop_unused()

    def keep_previews(self) -> bool:
        """Make the previews the frames, where nothing else is there; see :meth:`.bake.MorphBake.keep_previews`."""
        return self._bake.keep_previews()

    @property
    def span(self) -> tuple[float, float] | None:
        """When it plays; see :attr:`.bake.MorphBake.span`."""
        return self._bake.span

    def discard(self) -> None:
        """Remove everything that has been written."""
        self._bake.discard()
        self._drop_unused()

    def _drop_unused(self) -> None:
        """Remove materials that were made for the frames and are not used."""
        if self._carrying is not None:
            self._carrying.drop_unused()


def _looked_at(blends: Sequence[Blend], frame: int) -> int:
    """Return the number of the blend that a frame after the first one of a path shows; on a sheet the first one."""
    if blends[0].frame is None:
        return 0
    return min(range(len(blends)), key=lambda number: abs(blends[number].frame - frame))
