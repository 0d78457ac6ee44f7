# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Move a baked morph out of the .blend file, to volumes or to an Alembic or USD file."""

from __future__ import annotations

from collections.abc import Callable

import bpy
from bpy.app.translations import pgettext_rpt as rpt_

from ..bridge.morphs.disk_output import DiskOutput, filled_folder, free_folder
from ..bridge.morphs.morph_request import MorphRequest
from ..bridge.morphs.removal import remove_frames
from ..bridge.morphs.stand_ins import remove_stand_ins
from ..bridge.morphs.stored import stored_settings
from ..bridge.mouse_progress import progress_at_mouse
from ..errors import ConvwassError
from ..progress import drained, watched
from ..properties.from_schema import property_of
from .morph_manage import OnActiveMorph, active_morph, select_only
from .reporting import refuse_if_known


class _OutputMorph(OnActiveMorph):
    bl_options = {"REGISTER", "UNDO"}

    folder: property_of(MorphRequest, "folder")

    def execute(self, context):
        morph = active_morph(context)
        try:
            with progress_at_mouse() as show:
                output = self._written(morph, show)
        except (ConvwassError, OSError, MemoryError) as error:
            return refuse_if_known(self, error)
        remove_stand_ins(morph)
        remove_frames(morph)
        select_only(context, [output.shown])
        message = rpt_("{:s}: {:d} files, {:.1f} MB in {:s}")
        folder = output.files[0].parent
        self.report({"INFO"}, message.format(output.shown.name, len(output.files), output.megabytes, str(folder)))
        return {"FINISHED"}

    def _written(self, morph: bpy.types.Collection, show: Callable[[float], None]) -> DiskOutput:
        """Write the files, and report the fraction that is done."""
        raise NotImplementedError


class CONVWASS_OT_make_volume(_OutputMorph, bpy.types.Operator):
    """Move the active morph to VDB files, shown by a Volume object and by a mesh with adjustable level and smoothing"""

    bl_idname = "convwass.make_volume"
    bl_label = "Make Volume"

    def _written(self, morph, show):
        from ..bridge.flat.choosing import refuse_volumes
        from ..bridge.morphs.volume_output import as_volume

        refuse_volumes("flat" in stored_settings(morph))
        with filled_folder(free_folder(self.folder, morph)) as folder:
            return drained(watched(as_volume(morph, folder), lambda report: show(report.fraction)))


class CONVWASS_OT_make_cache(_OutputMorph, bpy.types.Operator):
    """Move the active morph to an Alembic or USD file, shown by one object with a Mesh Sequence Cache modifier"""

    bl_idname = "convwass.make_cache"
    bl_label = "Make Cache"

    kind: property_of(MorphRequest, "cache_format")

    def _written(self, morph, _show):
        from ..bridge.flat.frames_as_meshes import require_no_drawings, turn_into_meshes
        from ..bridge.morphs.cache_output import as_cache, require_animation

        require_no_drawings(morph)
        require_animation(morph)
        with filled_folder(free_folder(self.folder, morph)) as folder:
            turn_into_meshes(morph)
            return as_cache(morph, folder, self.kind)


classes = (CONVWASS_OT_make_volume, CONVWASS_OT_make_cache)
