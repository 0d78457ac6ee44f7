# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Edit and check the list of shapes to morph."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy
from bpy.app.translations import pgettext_rpt as rpt_, pgettext_tip as tip_
from bpy.props import IntProperty

from ..bridge.active import selected_objects
from ..bridge.flat.flat_kinds import looks_flat
from ..bridge.objects import MESHED, triangle_mesh
from ..bridge.shape_sources import is_plain, shape_roots, shape_source
from ..errors import ConvwassError, InputError
from ..preferences import preferences
from ..properties.morph_inputs import CONVWASS_PG_input
from ..solver_presets import apply_preset, is_untouched
from ..translations import translated
from .lists import ACTIVE, ClearsList, MovesItem, RemovesItem, SidebarList

if TYPE_CHECKING:
    from ..applications.morphs.shape_check import ShapeFindings


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


class CONVWASS_OT_add_morph_inputs(_EditInputs, bpy.types.Operator):
    """Add the selected shapes to the list, and check them"""

    bl_idname = "convwass.add_morph_inputs"
    bl_label = "Add Inputs"

    @classmethod
    def poll(cls, context):
        if not shape_roots(selected_objects(context), context.scene.convwass_morph.grouping):
            cls.poll_message_set("Select meshes, texts, curves, drawings or images to add")
            return False
        return True

    def execute(self, context):
        settings = context.scene.convwass_morph
        if not settings.inputs and is_untouched(settings):
            self._begin_with(preferences(context).default_preset)
        known = {item.object for item in settings.inputs}
        roots = shape_roots(selected_objects(context), settings.grouping)
        meshes = [obj for obj in roots if obj not in known]
        for obj in settings.sorted_shapes(meshes):
            item = settings.inputs.add()
            item.object = obj
            check(item, context.evaluated_depsgraph_get(), settings.grouping)
        settings.active_input = len(settings.inputs) - 1
        if not meshes:
            self.report({"INFO"}, rpt_("All selected shapes are already on the list"))
        return {"FINISHED"}

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


class CONVWASS_OT_check_morph_inputs(_OnList, bpy.types.Operator):
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

    def execute(self, context):
        inputs = list(context.scene.convwass_morph.inputs)
        if self.index != ACTIVE:
            inputs = inputs[self.index : self.index + 1]
        depsgraph = context.evaluated_depsgraph_get()
        for item in inputs:
            check(item, depsgraph, context.scene.convwass_morph.grouping)
        faulty = sum(item.warns for item in inputs)
        if faulty:
            self.report({"WARNING"}, rpt_("Shapes with problems: {:d} of {:d}").format(faulty, len(inputs)))
        else:
            self.report({"INFO"}, rpt_("No problems found"))
        return {"FINISHED"}


def check(item: CONVWASS_PG_input, depsgraph: bpy.types.Depsgraph, grouping: str) -> None:
    """Check the shape of an input, and store the findings on the item."""
    from ..applications.morphs.shape_check import check_shape
    from ..bridge.flat.flat_objects import flat_objects, is_flat
    from ..bridge.joined_shapes import joined_shape

    if item.object is None or not item.object.users_scene:
        item.verdict, item.finding = "UNUSABLE", rpt_("The object has been deleted")
        return
    try:
        source = shape_source(item.object, grouping)
        if is_plain(source) and item.object.type != "MESH" and is_flat(item.object, depsgraph):
            flat_objects([item.object], depsgraph)
            item.verdict, item.finding = "SOUND", ""
            return
        with joined_shape(source, depsgraph) as joined:
            findings = check_shape(triangle_mesh(joined, depsgraph, MESHED))
    except ConvwassError as error:
        item.verdict, item.finding = "UNUSABLE", translated(error.sentence).rstrip(".")
        return
    if not findings.has_volume and looks_flat(item.object):
        item.verdict = findings.worst
        item.finding = rpt_("It is flat: morph it with other flat shapes, or set Thickness")
        return
    item.verdict, item.finding = findings.worst, "; ".join(_sentences(findings))


def _sentences(findings: ShapeFindings) -> list[str]:
    """Return the messages about a shape, the most important first."""
    if not findings.has_volume:
        return [rpt_("It encloses no volume: set Thickness, or add a Solidify modifier")]
    found = []
    if findings.open_edges:
        found.append(
            rpt_("Holes with {:d} open edges; the volume that they nearly enclose is filled").format(
                findings.open_edges
            )
        )
    if findings.flipped_faces:
        found.append(rpt_("{:d} flipped triangles; they are corrected for the morph").format(findings.flipped_faces))
    return found


classes = (
    CONVWASS_OT_add_morph_inputs,
    CONVWASS_OT_remove_morph_input,
    CONVWASS_OT_move_morph_input,
    CONVWASS_OT_clear_morph_inputs,
    CONVWASS_OT_check_morph_inputs,
)
