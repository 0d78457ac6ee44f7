# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators for a mesh with shape keys to other shapes: attach clothes and eyes, create a pad."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import BoolProperty

from ..bridge.active import active_object, selected_objects
from ..bridge.one_mesh.records import has_key_record
from ..sentence import Sentence, first_names
from .background import is_idle
from .mesh_writing import MeshWritingOperator
from .morph_manage import select_only
from .reporting import reporting_errors, tell


class CONVWASS_OT_attach_parts(MeshWritingOperator, bpy.types.Operator):
    """Add shape keys to the other selected meshes, such as clothes, hair and eyes, that follow the active mesh and its sliders"""  # noqa: E501

    bl_idname = "convwass.attach_parts"
    bl_label = "Attach Parts"
    bl_options = {"REGISTER", "UNDO"}
    _title = Sentence("Attaching parts")

    rigid: BoolProperty(
        name="Rigid",
        description="Only move, rotate and scale connected components, for eyes, teeth and buttons",
        default=False,
        options={"SKIP_SAVE"},
    )

    @classmethod
    def poll(cls, context):
        if context.mode != "OBJECT":
            cls.poll_message_set("Go to Object Mode first")
            return False
        active = active_object(context)
        if not has_key_record(active) or not any(obj != active for obj in selected_objects(context)):
            cls.poll_message_set("Select parts, and the mesh with shape keys to other shapes last")
            return False
        return is_idle(cls, context)

    def _begin(self, context):
        from ..bridge.one_mesh.attached_parts import AttachJob

        body = context.object
        parts = [obj for obj in selected_objects(context) if obj != body]
        return AttachJob(body, parts, rigid=self.rigid)

    def _finish(self, context, job):
        notices = job.finish()
        text = rpt_("{:s}: attached to {:s}").format(first_names(job.part_names), job.body_name)
        tell(self, text, notices)
        return {"FINISHED"}


class CONVWASS_OT_make_key_pad(bpy.types.Operator):
    """Create a pad whose handle drives the sliders of the active mesh, in place of their keyframes and drivers; for two or three other shapes"""  # noqa: E501

    bl_idname = "convwass.make_key_pad"
    bl_label = "Make Pad"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        if context.mode != "OBJECT" or not has_key_record(active_object(context)):
            cls.poll_message_set("Select a mesh with shape keys to other shapes, in Object Mode")
            return False
        return True

    @reporting_errors
    def execute(self, context):
        from ..bridge.one_mesh.key_pad import foreign_drivers, make_key_pad

        replaced = foreign_drivers(context.object)
        handle = make_key_pad(context.object)
        select_only(context, [handle])
        if replaced:
            self.report({"WARNING"}, rpt_("The pad replaces the drivers of {:s}").format(first_names(replaced)))
        tell(self, rpt_("Drag {:s}").format(handle.name))
        return {"FINISHED"}


classes = (CONVWASS_OT_attach_parts, CONVWASS_OT_make_key_pad)
