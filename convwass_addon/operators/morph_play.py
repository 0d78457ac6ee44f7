# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Show a morph with a single object: a player with an animatable value, or a pad with a draggable Empty."""

from __future__ import annotations

import bpy

from ..bridge.morphs.blend_pad import make_blend_pad, require_sheet
from ..bridge.morphs.morph_request import MorphRequest
from ..bridge.morphs.player import make_player, require_path
from ..bridge.morphs.stand_ins import remove_stand_ins, shows_frames, stand_ins
from ..bridge.morphs.stored import frame_objects
from ..errors import ConvwassError
from ..properties.from_schema import property_of
from .morph_manage import OnActiveMorph, active_morph, select_only
from .reporting import refuse


class _OnPlayedMorph(OnActiveMorph):
    @classmethod
    def poll(cls, context):
        if context.mode != "OBJECT":
            cls.poll_message_set("Go to Object Mode first")
            return False
        return super().poll(context)

    def execute(self, context):
        morph = active_morph(context)
        try:
            shown = self._change(morph)
        except ConvwassError as error:
            return refuse(self, error)
        select_only(context, [] if shown is None else [shown])
        return {"FINISHED"}


class CONVWASS_OT_make_player(_OnPlayedMorph, bpy.types.Operator):
    """Show the active morph with one object, whose value Morph can be animated: 0 is the first shape, 1 the second"""

    bl_idname = "convwass.make_player"
    bl_label = "Make Player"

    playback: bpy.props.EnumProperty(
        name="Playback",
        description="What the player shows before the first and after the last shape",
        items=(
            ("ONCE", "Once", "Hold the first or last shape"),
            ("LOOP", "Loop", "Start again at the other end"),
            ("PING_PONG", "Ping-Pong", "Go back and forth"),
        ),
    )
    easing: bpy.props.EnumProperty(
        name="Easing",
        description="How the value goes from shape to shape; edit its curve for more",
        items=(
            ("LINEAR", "Linear", "Constant speed, as baked"),
            ("SMOOTH", "Smooth", "Slow down at every shape"),
        ),
    )

    between: property_of(MorphRequest, "between")

    def _change(self, morph):
        from ..bridge.flat.frames_as_meshes import require_no_drawings, turn_into_meshes

        require_no_drawings(morph)
        require_path(morph)
        turn_into_meshes(morph)
        return make_player(morph, playback=self.playback, easing=self.easing, between=self.between)


class CONVWASS_OT_make_blend_pad(_OnPlayedMorph, bpy.types.Operator):
    """Show the active sheet with one object: the blend at an Empty that is dragged or animated on a pad"""

    bl_idname = "convwass.make_blend_pad"
    bl_label = "Make Blend Pad"

    between: property_of(MorphRequest, "between")

    def _change(self, morph):
        from ..bridge.flat.frames_as_meshes import require_no_drawings, turn_into_meshes

        require_no_drawings(morph)
        require_sheet(morph)
        turn_into_meshes(morph)
        return make_blend_pad(morph, between=self.between).handle


class CONVWASS_OT_remove_player(_OnPlayedMorph, bpy.types.Operator):
    """Remove the player or blend pad of the active morph, and show its baked objects again"""

    bl_idname = "convwass.remove_player"
    bl_label = "Back to Baked Objects"

    @classmethod
    def poll(cls, context):
        if not super().poll(context):
            return False
        morph = active_morph(context)
        # The player itself may have been deleted while the objects are still hidden.
        if shows_frames(morph) and not stand_ins(morph):
            cls.poll_message_set("The active morph has neither a player nor a blend pad")
            return False
        return True

    def _change(self, morph):
        remove_stand_ins(morph)
        return next(iter(frame_objects(morph)), None)


classes = (CONVWASS_OT_make_player, CONVWASS_OT_make_blend_pad, CONVWASS_OT_remove_player)
