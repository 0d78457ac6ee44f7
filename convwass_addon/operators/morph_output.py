# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Move a baked morph out of the .blend file, to volumes or to an Alembic or USD file."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import bpy
from bpy.app.translations import pgettext_rpt as rpt_

from ..bridge.active import active_object
from ..bridge.morphs.disk.disk_output import DiskOutput, filled_folder, free_folder
from ..bridge.morphs.morph_request import MorphRequest
from ..bridge.morphs.removal import remove_frames
from ..bridge.morphs.stand_ins import remove_stand_ins, require_no_pad
from ..bridge.morphs.stored import stored_settings
from ..bridge.mouse_progress import progress_at_mouse
from ..progress import Result, Work, drained, watched
from ..properties.from_schema import property_of
from ..sentence import Sentence
from .morph_manage import OnActiveMorph, active_morph, select_only
from .reporting import reporting_errors, tell


class _OutputMorph(OnActiveMorph):
    bl_options = {"REGISTER", "UNDO"}

    folder: property_of(MorphRequest, "folder")

    @reporting_errors
    def execute(self, context):
        from ..bridge.morphs.players.seen_frames import seen_frames

        morph = active_morph(context)
        require_no_pad(morph)
        self._check(morph)
        with progress_at_mouse() as show:
            watch = partial(watched, watch=lambda report: show(report.fraction))
            seen = drained(watch(seen_frames(morph, active_object(context))))
            try:
                output = self._written(seen.morph, watch)
            except BaseException:
                seen.discard()
                raise
        seen.keep()
        remove_stand_ins(seen.morph)
        remove_frames(seen.morph)
        select_only(context, [output.shown])
        message = rpt_("{:s}: {:d} files, {:.1f} MB in {:s}")
        folder = output.files[0].parent
        text = message.format(output.shown.name, len(output.files), output.megabytes, str(folder))
        kept = [] if seen.player is None else [Sentence("{name} is kept, but hidden", {"name": seen.player.name})]
        tell(self, text, kept)
        return {"FINISHED"}

    def _check(self, morph: bpy.types.Collection) -> None:
        """Raise InputError if the morph cannot be written."""
        free_folder(self.folder, morph)

    def _written(self, morph: bpy.types.Collection, watch: Callable[[Work[Result]], Work[Result]]) -> DiskOutput:
        """Write the files, and report the fraction that is done."""
        raise NotImplementedError


class CONVWASS_OT_make_volume(_OutputMorph, bpy.types.Operator):
    """Move the active morph to VDB files, shown by a Volume object and by a mesh with adjustable level and smoothing; what a retimed player shows is written, and the player is kept"""  # noqa: E501

    bl_idname = "convwass.make_volume"
    bl_label = "Make Volume"

    def _check(self, morph):
        from ..bridge.flat.choosing import refuse_volumes

        refuse_volumes("flat" in stored_settings(morph))
        super()._check(morph)

    def _written(self, morph, watch):
        from ..bridge.morphs.disk.volume_output import as_volume

        with filled_folder(free_folder(self.folder, morph)) as folder:
            return drained(watch(as_volume(morph, folder)))


class CONVWASS_OT_make_cache(_OutputMorph, bpy.types.Operator):
    """Move the active morph to an Alembic or USD file, shown by one object with a Mesh Sequence Cache modifier; what a retimed player shows is written, and the player is kept"""  # noqa: E501

    bl_idname = "convwass.make_cache"
    bl_label = "Make Cache"

    kind: property_of(MorphRequest, "cache_format")

    def _check(self, morph):
        from ..bridge.flat.frames_as_meshes import require_no_drawings
        from ..bridge.morphs.disk.cache_output import require_animation

        require_no_drawings(morph)
        require_animation(morph)
        super()._check(morph)

    def _written(self, morph, _watch):
        from ..bridge.flat.frames_as_meshes import turn_into_meshes
        from ..bridge.morphs.disk.cache_output import as_cache

        with filled_folder(free_folder(self.folder, morph)) as folder:
            turn_into_meshes(morph)
            return as_cache(morph, folder, self.kind)


classes = (CONVWASS_OT_make_volume, CONVWASS_OT_make_cache)
