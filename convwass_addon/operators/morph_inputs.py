# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Edit and check the list of shapes to morph."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_rpt as rpt_, pgettext_tip as tip_
from bpy.props import IntProperty

from ..bridge.active import selected_objects
from ..bridge.shape_sources import shape_roots
from ..errors import InputError
from ..preferences import preferences
from ..properties.morph_inputs import CONVWASS_PG_input
from ..solver_presets import apply_preset, is_untouched
from ..translations import translated
from .lists import ACTIVE, ClearsList, MovesItem, RemovesItem, SidebarList
from .shape_checks import ChecksShapes, mark_as_deleted


class _EditInputs:
    bl_options = {"REGISTER", "UNDO"}


class _OnList(_EditInputs):
    @classmethod
    def poll(cls, context):
        if not context.scene.convwass_morph.inputs:
            cls.poll_message_set("The input list is empty")
            return False
        return True

    def _list(self, context: bpy.types.Context) -> SidebarList:
        return SidebarList(context.scene.convwass_morph, "inputs", "active_input")


class CONVWASS_OT_add_morph_inputs(_EditInputs, ChecksShapes, bpy.types.Operator):
    """Add the selected shapes to the list, and check them"""

    bl_idname = "convwass.add_morph_inputs"
    bl_label = "Add Inputs"

    @classmethod
    def poll(cls, context):
        if not shape_roots(selected_objects(context), context.scene.convwass_morph.grouping):
            cls.poll_message_set("Select meshes, texts, curves, drawings or images to add")
            return False
        return True

    def _begin(self, context):
        from ..bridge.morphs.inputs.input_checks import CheckJob

        settings = context.scene.convwass_morph
        if not settings.inputs and is_untouched(settings):
            self._begin_with(preferences(context).default_preset)
        known = {item.object for item in settings.inputs}
        roots = shape_roots(selected_objects(context), settings.grouping)
        shapes = settings.sorted_shapes([obj for obj in roots if obj not in known])
        for obj in shapes:
            settings.inputs.add().object = obj
        settings.active_input = len(settings.inputs) - 1
        if not shapes:
            self.report({"INFO"}, rpt_("All selected shapes are already on the list"))
        return CheckJob(shapes, settings.grouping)

    def _finish(self, context, job):
        self._store(context, job)
        return {"FINISHED"}

    def _keep(self, context, job):
        # The shapes stay on the list.
        self._store(context, job)
        self.report({"INFO"}, rpt_("Stopped; not all of the new shapes were checked"))
        return True

    def _objects(self, context):
        return selected_objects(context)

    def _begin_with(self, preset: str) -> None:
        """Apply a preset, or report that it is not available; the shapes are added in any case."""
        try:
            apply_preset(preset)
        except InputError as error:
            self.report({"WARNING"}, translated(error.sentence))


class CONVWASS_OT_remove_morph_input(_OnList, RemovesItem, bpy.types.Operator):
    """Remove a shape from the list; the object is kept"""

    bl_idname = "convwass.remove_morph_input"
    bl_label = "Remove Input"


class CONVWASS_OT_move_morph_input(_OnList, MovesItem, bpy.types.Operator):
    """Move a shape up or down the list, which is the order of the morph"""

    bl_idname = "convwass.move_morph_input"
    bl_label = "Move Input"


class CONVWASS_OT_clear_morph_inputs(_OnList, ClearsList, bpy.types.Operator):
    """Clear the list; the selected shapes are morphed instead"""

    bl_idname = "convwass.clear_morph_inputs"
    bl_label = "Clear Inputs"


class CONVWASS_OT_check_morph_inputs(_OnList, ChecksShapes, bpy.types.Operator):
    """Check the shapes on the list again for holes, flipped faces and missing volume"""

    bl_idname = "convwass.check_morph_inputs"
    bl_label = "Check Inputs"

    index: IntProperty(
        name="Index", description="Position on the list, from 0; -1 checks all shapes", default=ACTIVE, min=ACTIVE
    )

    @classmethod
    def description(cls, context, properties):
        inputs = context.scene.convwass_morph.inputs
        if 0 <= properties.index < len(inputs) and inputs[properties.index].finding:
            return f"{inputs[properties.index].finding}.\n\n{tip_('Click to check again')}"
        return tip_(cls.__doc__)

    def _begin(self, context):
        from ..bridge.morphs.inputs.input_checks import CheckJob

        return CheckJob(self._objects(context), context.scene.convwass_morph.grouping)

    def _objects(self, context):
        return [item.object for item in self._chosen(context.scene) if item.object is not None]

    def _finish(self, context, job):
        self._store(context, job)
        chosen = self._chosen(self._own_scene(context))
        for item in chosen:
            if item.object is None:
                mark_as_deleted(item)
        faulty = sum(item.warns for item in chosen)
        if faulty:
            self.report({"WARNING"}, rpt_("Shapes with problems: {:d} of {:d}").format(faulty, len(chosen)))
        else:
            self.report({"INFO"}, rpt_("No problems found"))
        return {"FINISHED"}

    def _chosen(self, scene: bpy.types.Scene) -> list[CONVWASS_PG_input]:
        """Return the items to check."""
        inputs = list(scene.convwass_morph.inputs)
        return inputs if self.index == ACTIVE else inputs[self.index : self.index + 1]


classes = (
    CONVWASS_OT_add_morph_inputs,
    CONVWASS_OT_remove_morph_input,
    CONVWASS_OT_move_morph_input,
    CONVWASS_OT_clear_morph_inputs,
    CONVWASS_OT_check_morph_inputs,
)
