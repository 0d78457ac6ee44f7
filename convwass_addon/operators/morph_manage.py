# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators on a baked morph: select its inputs, bake it again, delete it."""

from __future__ import annotations

import json
from collections.abc import Sequence

import bpy
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import EnumProperty, StringProperty

from ..bridge.active import active_object, selected_objects
from ..bridge.linked_data import is_linked, overriding
from ..bridge.morphs.bake_order import in_order, outdated
from ..bridge.morphs.disk.disk_output import read_morph
from ..bridge.morphs.inputs.morph_guides import guides_of_entries
from ..bridge.morphs.morph_request import MorphRequest
from ..bridge.morphs.removal import delete_morph
from ..bridge.morphs.stand_ins import shown_morph
from ..bridge.morphs.stored import (
    FRAMES_KEY,
    MORPH_KEY,
    refusing_damage,
    sampled_from,
    starting_frame,
    stored_inputs,
    stored_morph,
    stored_settings,
)
from ..bridge.morphs.stored_parts import stored_parts
from ..bridge.one_mesh.baked_keys import baked_keys
from ..bridge.operator_errors import reason
from ..bridge.visibility import is_in
from ..errors import ConvwassError, InputError
from ..properties.morphs import stored_arguments
from ..sentence import first_names
from ..translations import translated
from .background import is_idle
from .reporting import reporting_errors, tell


def active_morph(context: bpy.types.Context) -> bpy.types.Collection | None:
    """Return the morph of the active object, or the active collection if that is a morph.

    An active object with shape keys is a bake of its own, so that nothing acts on the morph in its place.
    """
    active = active_object(context)
    if baked_keys(active) is not None:
        return None
    candidates = [
        shown_morph(active),
        read_morph(active),
        *(active.users_collection if active else ()),
        context.collection,
    ]
    # Frames that are hidden are in a collection of their own.
    candidates = [overriding(one.get(FRAMES_KEY, one), one) if one else None for one in candidates]
    return next((collection for collection in candidates if collection and MORPH_KEY in collection), None)


def active_bake(context: bpy.types.Context) -> bpy.types.Collection | bpy.types.Object | None:
    """Return what stores the bake of the active object: its morph, or an object with shape keys; or None."""
    return baked_keys(active_object(context)) or active_morph(context)


def baked_blocks() -> list[bpy.types.Collection | bpy.types.Object]:
    """Return everything in the file that can be baked again: morphs, and objects with shape keys."""
    return [block for block in (*bpy.data.collections, *bpy.data.objects) if MORPH_KEY in block and is_own(block)]


def is_own(bake: bpy.types.Collection | bpy.types.Object) -> bool:
    """Return whether a bake can be replaced: it is not linked, and if it is an object, it is in a scene."""
    # An object that was deleted remains in the file while something refers to it.
    return not is_linked(bake) and (isinstance(bake, bpy.types.Collection) or bool(bake.users_scene))


def select_only(context: bpy.types.Context, objects: Sequence[bpy.types.Object]) -> None:
    """Select only these objects and make the last one active; objects outside the view layer are skipped."""
    for obj in selected_objects(context):
        obj.select_set(False)
    for obj in objects:
        if is_in(context.view_layer, obj):
            obj.select_set(True)
            context.view_layer.objects.active = obj


def is_free_to_bake(operator: type[bpy.types.Operator], context: bpy.types.Context) -> bool:
    """Return whether a bake can start now; otherwise set the operator's poll message."""
    if context.mode != "OBJECT":
        operator.poll_message_set("Go to Object Mode first")
        return False
    return is_idle(operator, context)


def is_refused_as_linked(operator: type[bpy.types.Operator], morph: bpy.types.ID) -> bool:
    """Return whether a morph cannot be changed because it is linked; then set the operator's poll message."""
    if not is_linked(morph):
        return False
    operator.poll_message_set("The morph is linked from another file; open that file to change it")
    return True


class OnActiveMorph:
    """Base of operators on a baked morph, which they change unless `changes_morph` is false."""

    bl_options = {"REGISTER", "UNDO"}
    subject = staticmethod(active_morph)
    changes_morph = True

    @classmethod
    def poll(cls, context):
        morph = cls.subject(context)
        if morph is None:
            cls.poll_message_set("Select an object of a baked morph")
            return False
        return not (cls.changes_morph and is_refused_as_linked(cls, morph))


class _OnActiveBake(OnActiveMorph):
    """Base of operators on a baked morph or on an object with shape keys."""

    subject = staticmethod(active_bake)


class CONVWASS_OT_select_morph_inputs(_OnActiveBake, bpy.types.Operator):
    """Show and select the shapes of the active morph, and load its settings"""

    bl_idname = "convwass.select_morph_inputs"
    bl_label = "Select Inputs"
    changes_morph = False

    @reporting_errors
    def execute(self, context):
        morph = active_bake(context)
        inputs, stored = stored_inputs(morph), stored_settings(morph)
        with refusing_damage(morph.name):
            settings = context.scene.convwass_morph
            settings.take_stored(stored)
            settings.take_inputs(inputs, stored.get("weights"))
            context.scene.convwass_guides.take(guides_of_entries(stored.get("guides", [])), inputs)
        parts = stored_parts(morph)
        for obj in parts:
            obj.hide_set(False)
            obj.hide_render = False
        select_only(context, parts)
        missing = [obj.name for obj in parts if not is_in(context.view_layer, obj)]
        if missing:
            self.report({"WARNING"}, rpt_("Not in this view layer, so not selected: {:s}").format(first_names(missing)))
        return {"FINISHED"}


class CONVWASS_OT_rebake_morph(bpy.types.Operator):
    """Bake morphs again with their stored settings; players, pads, volumes and caches keep their keys, materials and modifiers, while changes of the baked meshes are lost"""  # noqa: E501

    bl_idname = "convwass.rebake_morph"
    bl_label = "Bake Again"
    bl_options = {"REGISTER", "UNDO"}

    which: EnumProperty(
        name="Which",
        description="Which morphs of the file to bake again",
        items=(
            ("ACTIVE", "Active", "The morph of the active object"),
            ("STALE", "Stale", "All morphs whose shapes have changed since the bake"),
            ("ALL", "All", "All morphs"),
        ),
        options={"SKIP_SAVE"},
    )
    morphs: StringProperty(
        name="Morphs",
        description="Names of morphs to bake instead, which are collections or objects with shape keys, one per line",
        options={"SKIP_SAVE"},
    )
    session_uids: StringProperty(
        name="Session IDs",
        description="Session IDs of morphs to bake instead, one per line, which tell data of the same name apart",
        options={"SKIP_SAVE"},
    )

    @classmethod
    def poll(cls, context):
        if not is_free_to_bake(cls, context):
            return False
        if baked_blocks():
            return True
        active = active_bake(context)
        if active is None or not is_refused_as_linked(cls, active):
            cls.poll_message_set("Bake a morph first")
        return False

    def invoke(self, context, event):
        return self._bake(context, "INVOKE_DEFAULT")

    def execute(self, context):
        return self._bake(context, "EXEC_DEFAULT")

    def _bake(self, context, how):
        blocks = self._wanted(context)
        if not blocks:
            self.report({"INFO"}, rpt_("No morph needs to be baked again"))
            return {"CANCELLED"}
        problems = []
        for place, block in enumerate(blocks, start=1):
            # In the background, each bake starts the next one.
            following = blocks[place:] if how == "INVOKE_DEFAULT" else []
            problem = _problem_of_baking(block, how, following)
            if problem is not None:
                problems.append(problem)
            elif following:
                break
        if problems:
            self.report({"ERROR"}, " ".join(problems))
        return {"CANCELLED"} if len(problems) == len(blocks) else {"FINISHED"}

    def _wanted(self, context: bpy.types.Context) -> list[bpy.types.Collection | bpy.types.Object]:
        """Return the morphs to bake, those that have made shapes of others before these."""
        there = in_order(baked_blocks())
        if self.session_uids:
            uids = self.session_uids.split("\n")
            return [block for block in there if str(block.session_uid) in uids]
        if self.morphs:
            names = self.morphs.split("\n")
            return [block for block in there if block.name in names]
        if self.which == "ACTIVE":
            active = active_bake(context)
            return [] if active is None else [active]
        solved = [block for block in there if not _is_sampled(block)]
        return solved if self.which == "ALL" else outdated(solved)


def _problem_of_baking(
    block: bpy.types.Collection | bpy.types.Object,
    how: str,
    following: Sequence[bpy.types.Collection | bpy.types.Object],
) -> str | None:
    """Bake a morph again, and others after it; return what has prevented that, in the user's language, or None."""
    try:
        with refusing_damage(block.name):
            bpy.ops.convwass.bake_morph(how, following=_uids(following), **_arguments(block))
    except ConvwassError as error:
        return translated(error.sentence)
    except RuntimeError as error:
        return str(reason(error))
    return None


def _uids(blocks: Sequence[bpy.types.Collection | bpy.types.Object]) -> str:
    """Return the session ids of some bakes, one per line."""
    return "\n".join(str(block.session_uid) for block in blocks)


def _require_own(bake: bpy.types.Collection | bpy.types.Object) -> None:
    """Raise InputError if a bake cannot be replaced."""
    if is_linked(bake):
        raise InputError("{name} is linked from another file; open that file to bake it again.", name=bake.name)
    if not is_own(bake):
        raise InputError(
            "{name}, which stores how both meshes were baked, was deleted; undo that, or press Select Inputs and bake "
            "them anew.",
            name=bake.name,
        )


def _is_sampled(block: bpy.types.Collection | bpy.types.Object) -> bool:
    """Return whether the frames of a morph are what a player showed."""
    try:
        return sampled_from(block) is not None
    except InputError:
        # A damaged description is reported where it is used.
        return False


def _arguments(morph: bpy.types.Collection | bpy.types.Object) -> dict[str, object]:
    """Return the arguments of Bake Morph to bake a morph again; raises InputError if it or its shapes are not there.

    Damaged data raises Python's own errors, which `refusing_damage` converts.
    """
    _require_own(morph)
    stored, parts = stored_morph(morph), stored_parts(morph)
    if stored.settings.get("at"):
        raise InputError(
            "{name} contains fractional frames made with --at; recompute them on the command line.", name=morph.name
        )
    source = sampled_from(morph)
    if source is not None:
        raise InputError(
            "{name} contains what a player of {source} showed; bake {source} again, then bake or write the frames of "
            "its player again.",
            name=morph.name,
            source=source,
        )
    known = {name: value for name, value in stored_arguments(stored.settings).items() if value is not None}
    if MorphRequest(layout=known.get("layout", "PATH"), output=known.get("output", "OBJECTS")).output_problem:
        # Earlier versions made objects then.
        known["output"] = "OBJECTS"
    weights = stored.records[0]["weights"] if known.get("layout") == "BLEND" and stored.records else []
    return {
        **known,
        "weights": ",".join(str(weight) for weight in weights),
        "guides": json.dumps(stored.settings.get("guides", [])),
        "start": "CUSTOM",
        "frame_start": starting_frame(morph) if isinstance(morph, bpy.types.Collection) else stored.first_frame,
        "hide_inputs": all(obj.hide_render for obj in parts),
        "replaces": morph.name,
    }


class CONVWASS_OT_delete_morph(_OnActiveBake, bpy.types.Operator):
    """Delete the active morph and its meshes, and show the shapes that it has hidden"""

    bl_idname = "convwass.delete_morph"
    bl_label = "Delete Morph"

    def execute(self, context):
        from ..bridge.one_mesh.replaced_keys import delete_keys

        bake = active_bake(context)
        text = rpt_("{:s}: deleted").format(bake.name)
        if isinstance(bake, bpy.types.Object):
            tell(self, text, *delete_keys(bake))
        else:
            tell(self, text, warnings=delete_morph(bake))
        return {"FINISHED"}


classes = (CONVWASS_OT_select_morph_inputs, CONVWASS_OT_rebake_morph, CONVWASS_OT_delete_morph)
