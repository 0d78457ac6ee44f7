# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Pin and unpin joints of an armature."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_rpt as rpt_

from ..bridge.armatures.pins import clear_pins, pin_joints, pinned_ends, unpin_joints
from ..properties.armatures import chosen_rig
from .armature_targets import OnRig, chosen_joints, joints_property
from .reporting import reporting_errors


class _PinsJoints(OnRig):
    """Base of the operators that pin and unpin joints."""

    _pinned: bool

    @reporting_errors
    def execute(self, context):
        from ..bridge.armatures.rigs import require_movable, rig_graph

        rig = chosen_rig(context)
        context.view_layer.update()
        require_movable(rig)
        graph = rig_graph(rig, only_deforming=False)
        joints = chosen_joints(rig, graph, self.joints)
        (pin_joints if self._pinned else unpin_joints)(rig, graph, joints)
        text = rpt_("Pinned: {:s}") if self._pinned else rpt_("No longer pinned: {:s}")
        self.report({"INFO"}, text.format(", ".join(graph.graph.names[joint] for joint in joints)))
        return {"FINISHED"}


class CONVWASS_OT_pin_joints(_PinsJoints, bpy.types.Operator):
    """Pin the selected heads and tails of bones: they are where they should be, and fitting does not move them"""

    bl_idname = "convwass.pin_joints"
    bl_label = "Pin Joints"

    joints: joints_property()

    _pinned = True


class CONVWASS_OT_unpin_joints(_PinsJoints, bpy.types.Operator):
    """Unpin the selected heads and tails of bones, so that fitting moves them"""

    bl_idname = "convwass.unpin_joints"
    bl_label = "Unpin Joints"

    joints: joints_property()

    _pinned = False


class CONVWASS_OT_clear_pins(OnRig, bpy.types.Operator):
    """Unpin all joints of the armature"""

    bl_idname = "convwass.clear_pins"
    bl_label = "Unpin All"

    @classmethod
    def poll(cls, context):
        if not super().poll(context):
            return False
        if not pinned_ends(chosen_rig(context)):
            cls.poll_message_set("No joint is pinned")
            return False
        return True

    @reporting_errors
    def execute(self, context):
        from ..bridge.armatures.rigs import require_movable

        rig = chosen_rig(context)
        require_movable(rig)
        clear_pins(rig)
        return {"FINISHED"}


classes = (CONVWASS_OT_pin_joints, CONVWASS_OT_unpin_joints, CONVWASS_OT_clear_pins)
