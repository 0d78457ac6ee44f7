# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Import a table of highlights as a material."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import StringProperty

from ..bridge.files.output_paths import absolute_path
from ..bridge.reflectance.frame_span import Frames
from ..errors import InputError
from ..properties.light import sun_of
from .background import is_idle
from .reporting import reporting_errors, tell
from .windows import busy_cursor


class CONVWASS_OT_import_lobes(bpy.types.Operator):
    """Make a material from a table of highlights: an .exr or .npz file of this add-on, or a .binary file of the MERL database, which takes a few seconds. If the table has several steps, the blend is keyed over the frames of the scene"""  # noqa: E501

    bl_idname = "convwass.import_lobes"
    bl_label = "Import Highlights"
    bl_options = {"REGISTER", "UNDO"}

    filepath: StringProperty(
        name="File",
        description="Table of highlights",
        subtype="FILE_PATH",
        options={"SKIP_SAVE", "PATH_SUPPORTS_BLEND_RELATIVE"},
    )
    filter_glob: StringProperty(name="File Filter", default="*.exr;*.npz;*.binary", options={"HIDDEN"})

    @classmethod
    def poll(cls, context):
        return is_idle(cls, context)

    def invoke(self, context, event):
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    @reporting_errors
    def execute(self, context):
        from ..bridge.reflectance.lobe_files import read_lobe_file
        from ..bridge.reflectance.lobe_materials import lobe_material

        scene = context.scene
        if not self.filepath:
            raise InputError("Choose a file to read.")
        path = absolute_path(self.filepath)
        with busy_cursor(context):
            tables = read_lobe_file(path)
        frames = Frames(scene.frame_start, max(scene.frame_end, scene.frame_start + 1))
        dark = [(0.0, 0.0, 0.0)] * len(tables)
        animated = frames if len(tables) > 1 else None
        made = lobe_material(path.stem, tables, dark, sun_of(context), animated, file=str(path))
        tell(self, rpt_("Made {:s}").format(made.name))
        return {"FINISHED"}


classes = (CONVWASS_OT_import_lobes,)
