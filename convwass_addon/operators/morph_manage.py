# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Do something with a morph that has been baked: bake it again, or delete it."""

from __future__ import annotations

import json
from collections.abc import Sequence

import bpy
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import EnumProperty, StringProperty

from ..bridge.active import active_object, selected_objects
from ..bridge.morphs.changes import changed_inputs
from ..bridge.morphs.morph_guides import guides_of_entries
from ..bridge.morphs.removal import remove_bake
from ..bridge.morphs.stand_ins import shown_morph
from ..bridge.morphs.stored import FRAMES_KEY, MORPH_KEY, refusing_damage, stored_inputs, stored_morph, stored_settings
from ..bridge.operator_errors import reason
from ..errors import ConvwassError, InputError
from ..properties.morphs import stored_arguments
from .background import is_idle
from .reporting import refuse


def active_morph(context: bpy.types.Context) -> bpy.types.Collection | None:
    """Return the morph that the active object shows or belongs to, or that is the active collection."""
    active = active_object(context)
    candidates = [
        shown_morph(active),
        *(active.users_collection if active else ()),
        context.collection,
    ]
    # Frames that are hidden are in a collection of their own.
    candidates = [one.get(FRAMES_KEY, one) if one else None for one in candidates]
    return next((collection for collection in candidates if collection and MORPH_KEY in collection), None)


def select_only(context: bpy.types.Context, objects: Sequence[bpy.types.Object]) -> None:
    """Select these objects alone, and make the last one active; those that the view layer lacks are left out."""
    for obj in selected_objects(context):
        obj.select_set(False)
    for obj in objects:
        if obj.name in context.view_layer.objects:
            obj.select_set(True)
            context.view_layer.objects.active = obj


def is_free_to_bake(operator: type[bpy.types.Operator], context: bpy.types.Context) -> bool:
    """Tell for an operator's poll whether a bake may begin now, or leave a message that says why not."""
    if context.mode != "OBJECT":
        operator.poll_message_set("Go to Object Mode first")
        return False
    return is_idle(operator, context)


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
            with refusing_damage(morph.name):
                settings = context.scene.convwass_morph
                settings.take_stored(stored)
                settings.take_inputs(inputs, stored.get("weights"))
                context.scene.convwass_guides.take(guides_of_entries(stored.get("guides", [])))
        except ConvwassError as error:
            return refuse(self, error)
        for obj in inputs:
            obj.hide_set(False)
            obj.hide_render = False
        select_only(context, inputs)
        return {"FINISHED"}


class CONVWASS_OT_rebake_morph(bpy.types.Operator):
    """Bake morphs again from the settings that are stored with them; players keep their keys"""

    bl_idname = "convwass.rebake_morph"
    bl_label = "Bake Again"
    bl_options = {"REGISTER", "UNDO"}

    which: EnumProperty(
        name="Which",
        description="Which morphs of the file to bake again",
        items=(
            ("ACTIVE", "Active", "The morph of the active object"),
            ("STALE", "Stale", "All whose shapes have changed since they were baked"),
            ("ALL", "All", "All morphs"),
        ),
        options={"SKIP_SAVE"},
    )
    morphs: StringProperty(
        name="Morphs",
        description="Names of the morphs' collections instead, one per line",
        options={"SKIP_SAVE"},
    )

    @classmethod
    def poll(cls, context):
        if not is_free_to_bake(cls, context):
            return False
        if not any(MORPH_KEY in collection for collection in bpy.data.collections):
            cls.poll_message_set("Bake a morph first")
            return False
        return True

    def invoke(self, context, event):
        # One after the other in the background: each bake begins the next one.
        return self._bake(context, "INVOKE_DEFAULT", lambda names: [(names[0], "\n".join(names[1:]))])

    def execute(self, context):
        return self._bake(context, "EXEC_DEFAULT", lambda names: [(name, "") for name in names])

    def _bake(self, context, how, planned):
        names = self._wanted(context)
        if not names:
            self.report({"INFO"}, rpt_("No morph needs to be baked again"))
            return {"CANCELLED"}
        try:
            for name, following in planned(names):
                with refusing_damage(name):
                    bpy.ops.convwass.bake_morph(how, following=following, **_arguments(bpy.data.collections[name]))
        except ConvwassError as error:
            return refuse(self, error)
        except RuntimeError as error:
            self.report({"ERROR"}, str(reason(error)))
            return {"CANCELLED"}
        return {"FINISHED"}

    def _wanted(self, context: bpy.types.Context) -> list[str]:
        """Return the names of the morphs to bake."""
        there = [collection for collection in bpy.data.collections if MORPH_KEY in collection]
        if self.morphs:
            names = self.morphs.split("\n")
            return [collection.name for collection in there if collection.name in names]
        if self.which == "ACTIVE":
            active = active_morph(context)
            return [] if active is None else [active.name]
        return [collection.name for collection in there if self.which == "ALL" or changed_inputs(collection)]


def _arguments(morph: bpy.types.Collection) -> dict[str, object]:
    """Return what Bake Morph has to be told to make a morph again; raises InputError where its shapes are gone.

    What is damaged raises what Python does, for `refusing_damage`.
    """
    stored, inputs = stored_morph(morph), stored_inputs(morph)
    if stored.settings.get("at"):
        raise InputError(
            "{name} holds frames between others, from --at; make those by the command line.", name=morph.name
        )
    known = {name: value for name, value in stored_arguments(stored.settings).items() if value is not None}
    weights = stored.records[0]["weights"] if known.get("layout") == "BLEND" and stored.records else []
    return {
        **known,
        "inputs": "\n".join(obj.name for obj in inputs),
        "weights": ",".join(str(weight) for weight in weights),
        "guides": json.dumps(stored.settings.get("guides", [])),
        "start": "CUSTOM",
        "frame_start": stored.first_frame,
        "hide_inputs": all(obj.hide_render for obj in inputs),
        "replaces": morph.name,
    }


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


classes = (CONVWASS_OT_select_morph_inputs, CONVWASS_OT_rebake_morph, CONVWASS_OT_delete_morph)
