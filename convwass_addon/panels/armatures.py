# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel for fitting armatures: rig, body, pinned joints and settings."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_iface as iface_

from ..applications.skeletons.skeleton_settings import SkeletonSettings
from ..bridge.armatures.fit_request import FitRequest
from ..bridge.armatures.pins import KINDS, pinned_ends
from ..operators.armature_fit import CONVWASS_OT_fit_armature
from ..operators.armature_pins import CONVWASS_OT_clear_pins, CONVWASS_OT_pin_joints, CONVWASS_OT_unpin_joints
from ..operators.armature_place import CONVWASS_OT_place_joint
from ..properties.armatures import FitProperties, chosen_rig
from .from_schema import draw_settings
from .sidebar import Sidebar, draw_wrapped, large_button, with_labels_beside

# Longest list of pins that is shown in full.
_LISTED = 30


class CONVWASS_PT_armature(Sidebar, bpy.types.Panel):
    """Fit an armature into a mesh from a few pinned joints"""

    bl_label = "Armature"
    bl_idname = "CONVWASS_PT_armature"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout, own = self.layout, context.scene.convwass_armature
        column = layout.column(align=True)
        column.prop(own, "body")
        column.prop(own, "rig")
        rig = chosen_rig(context)
        if own.rig is None and rig is not None:
            text = iface_("Active armature: {:s}").format(rig.name)
            layout.label(text=text, icon="ARMATURE_DATA", translate=False)
        large_button(layout, CONVWASS_OT_fit_armature, "BONE_DATA", own, FitProperties)
        layout.prop(own, "auto_weights")


class CONVWASS_PT_armature_pins(Sidebar, bpy.types.Panel):
    """Joints that keep their positions"""

    bl_label = "Pins"
    bl_idname = "CONVWASS_PT_armature_pins"
    bl_parent_id = "CONVWASS_PT_armature"

    def draw(self, context):
        layout, own, rig = self.layout, context.scene.convwass_armature, chosen_rig(context)
        layout.operator(CONVWASS_OT_place_joint.bl_idname, icon="EYEDROPPER").depth = own.depth
        row = layout.row(align=True)
        row.operator(CONVWASS_OT_pin_joints.bl_idname, icon="PINNED")
        row.operator(CONVWASS_OT_unpin_joints.bl_idname, icon="UNPINNED")
        ends = pinned_ends(rig) if rig is not None and rig.type in KINDS else []
        if ends:
            _draw_pins(layout, ends)
        elif rig is not None:
            text = iface_("Pin the ends of limbs: select them in Edit Mode")
            draw_wrapped(layout, context, text, "INFO")
        layout.prop(own, "depth")
        layout.prop(own, "show_joints")


def _draw_pins(layout: bpy.types.UILayout, ends: list[str]) -> None:
    column = layout.column(align=True)
    for end in ends[:_LISTED]:
        row = column.row(align=True)
        row.label(text=end, icon="PINNED", translate=False)
        row.operator(CONVWASS_OT_unpin_joints.bl_idname, text="", icon="X", emboss=False).joints = end
    if len(ends) > _LISTED:
        text = iface_("and {:d} more").format(len(ends) - _LISTED)
        column.label(text=text, icon="BLANK1", translate=False)
    layout.operator(CONVWASS_OT_clear_pins.bl_idname, icon="TRASH")


class CONVWASS_PT_armature_settings(Sidebar, bpy.types.Panel):
    """Settings; the defaults suit most cases"""

    bl_label = "Fit Settings"
    bl_idname = "CONVWASS_PT_armature_settings"
    bl_parent_id = "CONVWASS_PT_armature"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout, own = with_labels_beside(self.layout), context.scene.convwass_armature
        draw_settings(layout, own, FitRequest, "settings")
        draw_settings(layout, own, SkeletonSettings, "settings")


classes = (CONVWASS_PT_armature, CONVWASS_PT_armature_pins, CONVWASS_PT_armature_settings)
