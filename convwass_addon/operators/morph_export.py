# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Export a baked morph, or a mesh with shape keys."""

from __future__ import annotations

from pathlib import Path

import bpy
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import StringProperty

from ..bridge.active import active_object
from ..bridge.files.output_paths import absolute_path, file_stem
from ..bridge.one_mesh.records import has_key_record
from ..errors import InputError
from ..progress import drained
from ..sentence import Sentence
from .morph_manage import active_morph
from .reporting import reporting_errors, tell


class CONVWASS_OT_export_morph(bpy.types.Operator):
    """Export the active morph, as its player shows it, or mesh with shape keys; the file extension sets the format"""

    bl_idname = "convwass.export_morph"
    bl_label = "Export"

    filepath: StringProperty(
        name="File Path",
        description="The file to write: .glb (glTF), .usdc, .abc (Alembic), .json (vertex animation texture); with "
        "shape keys also .fbx, and without .obj, .ply and .stl, one file per frame",
        subtype="FILE_PATH",
        options={"SKIP_SAVE", "PATH_SUPPORTS_BLEND_RELATIVE"},
    )
    filter_glob: StringProperty(
        name="File Filter",
        default="*.glb;*.fbx;*.usd;*.usda;*.usdc;*.usdz;*.abc;*.json;*.obj;*.ply;*.stl",
        options={"HIDDEN"},
    )

    @classmethod
    def poll(cls, context):
        if not has_key_record(active_object(context)) and active_morph(context) is None:
            cls.poll_message_set("Select an object of a baked morph or a mesh with its shape keys")
            return False
        return True

    def invoke(self, context, event):
        if not self.filepath:
            name = f"{file_stem(_subject(context).name)}.glb"
            self.filepath = f"//{name}" if bpy.data.filepath else name
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    @reporting_errors
    def execute(self, context):
        files = self._written(context)
        megabytes = sum(file.stat().st_size for file in files) / 1e6
        message, subject = rpt_("{:s}: {:d} files, {:.1f} MB in {:s}"), _subject(context)
        text = message.format(subject.name, len(files), megabytes, str(files[0].parent))
        tell(self, text, warnings=_warnings(subject, files[0]))
        return {"FINISHED"}

    def _written(self, context: bpy.types.Context) -> list[Path]:
        from ..bridge.flat.frames_as_meshes import require_no_drawings
        from ..bridge.morphs.disk.exports import export_frames, format_of
        from ..bridge.morphs.players.seen_frames import seen_frames
        from ..bridge.one_mesh.key_files import export_shape_keys

        if not self.filepath:
            raise InputError("Choose a file to write.")
        path, subject = absolute_path(self.filepath), _subject(context)
        if isinstance(subject, bpy.types.Object):
            return export_shape_keys(subject, path)
        file_format = format_of(path)
        require_no_drawings(subject)
        seen = drained(seen_frames(subject, active_object(context)))
        try:
            return export_frames(seen.morph, path, file_format)
        finally:
            seen.discard()


def _subject(context: bpy.types.Context) -> bpy.types.Object | bpy.types.Collection:
    """Return the active mesh with shape keys, or else the active morph."""
    active = active_object(context)
    return active if has_key_record(active) else active_morph(context)


def _warnings(subject: bpy.types.Object | bpy.types.Collection, file: Path) -> list[Sentence]:
    """Return what a file lacks of a mesh with shape keys."""
    from ..bridge.one_mesh.key_files import left_out_notices

    return left_out_notices(subject, file) if isinstance(subject, bpy.types.Object) else []


classes = (CONVWASS_OT_export_morph,)
