# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Give the color attribute of an object the palette of another object."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_rpt as rpt_

from ..bridge.active import active_object
from ..bridge.handles import Handle
from ..bridge.mesh_checks import writable_mesh
from ..errors import InputError
from ..properties.recolor import RecolorProperties, attribute_name_property
from ..sentence import Sentence
from .background import BackgroundOperator, is_idle
from .recolor_image import RecolorJob
from .reporting import tell


class CONVWASS_OT_recolor_attribute(RecolorProperties, BackgroundOperator, bpy.types.Operator):
    """Transfer the palette of another object's active color attribute to that of the active object; colors are weighted by the area they cover"""  # noqa: E501

    bl_idname = "convwass.recolor_attribute"
    bl_label = "Recolor Attribute"
    bl_options = {"REGISTER", "UNDO"}
    _title = Sentence("Recoloring")

    result: attribute_name_property()

    @classmethod
    def poll(cls, context):
        obj, giver = active_object(context), context.scene.convwass_recolor.palette_object
        if obj is None or obj.type != "MESH" or obj.data.color_attributes.active_color is None:
            cls.poll_message_set("Select a mesh with a color attribute")
            return False
        if giver is None or giver.type != "MESH" or giver.data.color_attributes.active_color is None:
            cls.poll_message_set("Choose an object whose color attribute provides the palette")
            return False
        return is_idle(cls, context)

    def _begin(self, context):
        from ..bridge.palettes.color_pictures import read_colors_as_picture

        if not self.result:
            raise InputError("Name the color attribute of the result.")
        obj, giver = context.object, context.scene.convwass_recolor.palette_object
        writable_mesh(obj)
        self._name, self._giver = obj.data.color_attributes.active_color_name, giver.name
        pictures = [read_colors_as_picture(own) for own in (obj, giver)]
        return RecolorJob(Handle.of("objects", obj), pictures[0], pictures[1:], [1.0], self.recolor_settings())

    def _waits_for(self, context, job):
        obj = job.target()
        return Sentence("Done; leave Edit Mode to apply the result") if obj.data.is_editmode else None

    def _finish(self, context, job):
        from ..bridge.palettes.color_pictures import write_picture_colors

        obj = job.target()
        write_picture_colors(obj, self._name, self.result, job.pixels)
        tell(self, rpt_("{:s} of {:s} has the colors of {:s}").format(self.result, obj.name, self._giver))
        return {"FINISHED"}


classes = (CONVWASS_OT_recolor_attribute,)
