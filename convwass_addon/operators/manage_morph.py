# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Do something with a morph that has been baked: bake it again, or delete it."""

from __future__ import annotations

import bpy

from ..bridge.bake import remove_bake
from ..bridge.stored import MORPH_KEY, stored_inputs, stored_settings
from ..errors import ConvwassError


def active_morph(context: bpy.types.Context) -> bpy.types.Collection | None:
    """Return the morph that the active object or the active collection belongs to."""
    candidates = [*(context.object.users_collection if context.object else ()), context.collection]
    return next((collection for collection in candidates if collection and MORPH_KEY in collection), None)


class OnActiveMorph:
    """An operator on a morph that has been baked."""

    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        if active_morph(context) is None:
            cls.poll_message_set("Select an object of a baked morph")
            return False
        return True


class CONVWASS_OT_select_morph_inputs(OnActiveMorph, bpy.types.Operator):
    """Show and select the shapes that the active morph was baked from, and take over its settings"""

    bl_idname = "convwass.select_morph_inputs"
    bl_label = "Select Inputs"

    def execute(self, context):
        morph = active_morph(context)
        try:
            inputs, stored = stored_inputs(morph), stored_settings(morph)
        except ConvwassError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        for obj in context.selected_objects:
            obj.select_set(False)
        for obj in inputs:
            obj.hide_set(False)
            obj.hide_render = False
            obj.select_set(True)
        context.view_layer.objects.active = inputs[-1]
        context.scene.convwass_morph.take_stored(stored)
        return {"FINISHED"}


class CONVWASS_OT_delete_morph(OnActiveMorph, bpy.types.Operator):
    """Delete the active morph and its meshes, and show the shapes it was baked from"""

    bl_idname = "convwass.delete_morph"
    bl_label = "Delete Morph"

    def execute(self, context):
        morph = active_morph(context)
        try:
            inputs = stored_inputs(morph)
        except ConvwassError:
            # Inputs that are gone need not be shown, and the morph can be deleted all the same.
            inputs = []
        remove_bake(morph)
        for obj in inputs:
            obj.hide_set(False)
            obj.hide_render = False
        return {"FINISHED"}


classes = (CONVWASS_OT_select_morph_inputs, CONVWASS_OT_delete_morph)
