# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Bake images for a mesh with shape keys to other shapes."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_rpt as rpt_

from ..bridge.active import active_object
from ..bridge.one_mesh.records import has_key_record
from ..errors import InputError
from ..properties.one_mesh import TextureProperties
from ..sentence import Sentence
from .background import BackgroundOperator, is_idle
from .reporting import tell


class CONVWASS_OT_bake_textures(BackgroundOperator, TextureProperties, bpy.types.Operator):
    """Bake images of the looks of all shapes for the active mesh with shape keys, and a material that mixes them"""

    bl_idname = "convwass.bake_textures"
    bl_label = "Bake Textures"
    bl_options = {"REGISTER", "UNDO"}
    _title = Sentence("Baking textures")
    _in_turn = True

    @classmethod
    def poll(cls, context):
        if context.mode != "OBJECT" or not has_key_record(active_object(context)):
            cls.poll_message_set("Select a mesh with shape keys to other shapes, in Object Mode")
            return False
        return is_idle(cls, context)

    def _begin(self, context):
        from ..bridge.one_mesh.texture_job import TextureJob

        if not hasattr(bpy.types.Scene, "cycles"):
            raise InputError("Enable the add-on Cycles Render Engine in the preferences; it bakes the images.")
        return TextureJob(context.object, self.texture_settings())

    def _finish(self, context, job):
        made = job.finish()
        text = rpt_("{:s}: {:d} images on the UV map {:s}").format(made.material.name, len(made.images), made.uv_map)
        tell(self, text, (), made.notices)
        return {"FINISHED"}


classes = (CONVWASS_OT_bake_textures,)
