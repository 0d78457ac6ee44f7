# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel of a mesh with shape keys to other shapes."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_iface as iface_

from ..bridge.active import active_object
from ..bridge.one_mesh.baked_keys import baked_keys, shared_slider
from ..bridge.one_mesh.records import has_key_record, key_records
from ..errors import ConvwassError
from ..operators.attached_parts import CONVWASS_OT_attach_parts, CONVWASS_OT_make_key_pad
from ..operators.morph_export import CONVWASS_OT_export_morph
from ..operators.morph_manage import (
    CONVWASS_OT_delete_morph,
    CONVWASS_OT_rebake_morph,
    CONVWASS_OT_select_morph_inputs,
)
from ..operators.texture_bake import CONVWASS_OT_bake_textures
from ..properties.one_mesh import TextureProperties
from ..translations import translated
from .baked import draw_changes
from .sidebar import Sidebar, draw_wrapped, fill_operator, with_labels_beside


class CONVWASS_PT_one_mesh(Sidebar, bpy.types.Panel):
    """Sliders of a mesh with shape keys to other shapes"""

    bl_label = "Shape Keys"
    bl_idname = "CONVWASS_PT_one_mesh"

    @classmethod
    def poll(cls, context):
        return has_key_record(active_object(context))

    def draw(self, context):
        layout, obj = self.layout, context.object
        try:
            records = key_records(obj)
        except ConvwassError as error:
            draw_wrapped(layout, context, translated(error.sentence), "ERROR")
            return
        column = layout.column(align=True)
        shared = shared_slider(obj)
        # A slider that another object drives cannot be moved.
        sliders = [(obj, record["name"]) for record in records] if shared is None else [shared]
        for owner, name in sliders:
            if name in owner:
                path = f'["{bpy.utils.escape_identifier(name)}"]'
                column.prop(owner, path, text=name, translate=False, slider=True)
        for record in records:
            if record.get("poor"):
                text = iface_("{:s}: {:d} vertices are folded or do not arrive").format(record["name"], record["poor"])
                draw_wrapped(layout, context, text, "ERROR")
        column = layout.column(align=True)
        column.operator(CONVWASS_OT_attach_parts.bl_idname, icon="LINKED")
        if len(records) in (2, 3):
            column.operator(CONVWASS_OT_make_key_pad.bl_idname, icon="EMPTY_AXIS")
        column.operator(CONVWASS_OT_export_morph.bl_idname, icon="EXPORT")
        bake = baked_keys(obj)
        # Objects of earlier versions do not store how they were made.
        if bake is not None:
            _draw_bake(layout, context, bake)


class CONVWASS_PT_textures(Sidebar, bpy.types.Panel):
    """Images of the looks of the shapes, for the one mesh"""

    bl_label = "Textures"
    bl_idname = "CONVWASS_PT_textures"
    bl_parent_id = "CONVWASS_PT_one_mesh"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout, settings = with_labels_beside(self.layout), context.scene.convwass_textures
        for name in ("texture_looks", "texture_size", "texture_samples", "texture_uvs", "texture_folder"):
            layout.prop(settings, name)
        operator = layout.operator(CONVWASS_OT_bake_textures.bl_idname, icon="TEXTURE")
        fill_operator(operator, settings, TextureProperties)


def _draw_bake(layout: bpy.types.UILayout, context: bpy.types.Context, bake: bpy.types.Object) -> None:
    """Draw the buttons that bake an object again or delete it."""
    draw_changes(layout, context, bake)
    column = layout.column(align=True)
    column.operator(CONVWASS_OT_rebake_morph.bl_idname, icon="FILE_REFRESH")
    column.operator(CONVWASS_OT_select_morph_inputs.bl_idname, icon="RESTRICT_SELECT_OFF")
    column.operator(CONVWASS_OT_delete_morph.bl_idname, icon="TRASH")


classes = (CONVWASS_PT_one_mesh, CONVWASS_PT_textures)
