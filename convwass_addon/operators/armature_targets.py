# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The chosen rig, body and joints, and the poll methods of their operators."""

from __future__ import annotations

import bpy
from bpy.props import StringProperty

from ..bridge.armatures.pins import KINDS
from ..bridge.armatures.rig_graphs import RigGraph
from ..errors import InputError
from ..properties.armatures import chosen_rig
from .background import is_idle
from .chosen_inputs import split_names


class OnRig:
    """Base of operators on the chosen rig, or the active armature."""

    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        rig = chosen_rig(context)
        if rig is None or rig.type not in KINDS:
            cls.poll_message_set("Choose an armature, or make one active")
            return False
        if not rig.users_scene:
            cls.poll_message_set("The armature has been deleted; choose another one")
            return False
        return is_idle(cls, context)


class OnBody(OnRig):
    """Base of operators on the rig and the body."""

    @classmethod
    def poll(cls, context):
        if not super().poll(context):
            return False
        body = context.scene.convwass_armature.body
        if body is None:
            cls.poll_message_set("Choose a body, the mesh to fit the armature into")
            return False
        if not body.users_scene:
            cls.poll_message_set("The body has been deleted; choose another one")
            return False
        if body == chosen_rig(context):
            cls.poll_message_set("Body and armature are the same object; choose another body")
            return False
        return True


def joints_property() -> object:
    """Return the property that names joints in scripts."""
    return StringProperty(
        name="Joints",
        description="Names of joints, such as Arm.L.head or Arm.L.tail, or vertex numbers; one per line or separated "
        "by commas. Empty: the joints selected in Edit Mode",
        options={"SKIP_SAVE"},
    )


def chosen_joints(obj: bpy.types.Object, rig: RigGraph, text: str) -> list[int]:
    """Return the joints named or, in Edit Mode, selected.

    Raises
    ------
    InputError
        There are no such joints.
    """
    if text.strip():
        return list(dict.fromkeys(rig.joint(name) for name in split_names(text)))
    chosen = rig.selected.nonzero()[0].tolist()
    if not chosen:
        raise InputError(
            "No joint of {object} is selected; go to Edit Mode and select heads or tails of bones.", object=obj.name
        )
    return chosen
