# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Show a morph with a single object: a player with an animatable value, or a pad with a draggable Empty."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy
from bpy.app.translations import pgettext_rpt as rpt_

from ..bridge.files.openvdb_module import openvdb_module
from ..bridge.keyframes import is_tweaked
from ..bridge.morphs.morph_request import MorphRequest
from ..bridge.morphs.players.blend_pad import build_blend_pad, require_sheet
from ..bridge.morphs.players.pad_inputs import handle_velocity
from ..bridge.morphs.players.pad_velocity import key_handle_velocity
from ..bridge.morphs.players.player import build_player, require_playable
from ..bridge.morphs.players.player_inputs import is_player, speed
from ..bridge.morphs.players.retiming import Retiming, key_speed, keyed_span, retime
from ..bridge.morphs.stand_ins import remove_stand_ins, shows_frames, stand_ins
from ..bridge.morphs.stored import frame_objects, interpolates
from ..properties.from_schema import property_of, values_of, with_properties
from ..sentence import Sentence
from .background import BackgroundOperator, is_idle
from .morph_manage import OnActiveMorph, active_morph, select_only
from .reporting import reporting_errors

if TYPE_CHECKING:
    from ..bridge.morphs.fields.field_sampling import SampledFields

# Settings of a timing that only some styles have.
_OF_STYLE = {"HOLD": ("hold",), "SLOW_MOTION": ("slowness",)}


def _fitting_between(operator: bpy.types.Operator, morph: bpy.types.Collection) -> str:
    """Return what this Blender can show between two blends, with a warning if it cannot interpolate."""
    if interpolates(morph, operator.between) and openvdb_module() is None:
        text = rpt_("The nearest blend is shown; interpolation requires OpenVDB for Python, which this Blender lacks")
        operator.report({"WARNING"}, text)
        return "NEAREST"
    return operator.between


class _InObjectMode(OnActiveMorph):
    @classmethod
    def poll(cls, context):
        if context.mode != "OBJECT":
            cls.poll_message_set("Go to Object Mode first")
            return False
        return super().poll(context)


class _ShowingMorph(BackgroundOperator, _InObjectMode):
    """Base of operators that show the active morph with other objects, and sample the fields of its blends for that."""

    @classmethod
    def poll(cls, context):
        return super().poll(context) and is_idle(cls, context)

    def _begin(self, context):
        from ..bridge.flat.frames_as_meshes import require_no_drawings
        from ..bridge.morphs.fields.field_job import FieldJob

        morph = active_morph(context)
        require_no_drawings(morph)
        self._check(morph)
        return FieldJob(morph, _fitting_between(self, morph))

    def _finish(self, context, job):
        from ..bridge.flat.frames_as_meshes import turn_into_meshes

        morph = job.morph()
        self._check(morph)
        turn_into_meshes(morph)
        select_only(context, [self._shown(morph, job.sampled)])
        return {"FINISHED"}

    def _check(self, morph: bpy.types.Collection) -> None:
        """Raise InputError if the morph cannot be shown in this way."""
        raise NotImplementedError

    def _shown(self, morph: bpy.types.Collection, sampled: SampledFields | None) -> bpy.types.Object:
        """Create what shows the morph, and return the object to select."""
        raise NotImplementedError


class CONVWASS_OT_make_player(_ShowingMorph, bpy.types.Operator):
    """Show the active morph with one object, whose value Morph can be animated: 0 is the first shape, 1 the second"""

    bl_idname = "convwass.make_player"
    bl_label = "Make Player"
    bl_options = {"REGISTER", "UNDO"}
    _title = Sentence("Making the player")

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

    def _check(self, morph):
        require_playable(morph, self.between)

    def _shown(self, morph, sampled):
        player = build_player(morph, playback=self.playback, easing=self.easing, sampled=sampled)
        if self.playback == "PING_PONG":
            # The baked velocities are those of the way there.
            key_speed(player)
        return player


class _OnPlayer(_InObjectMode):
    """An operator on the active player."""

    changes_morph = False

    @classmethod
    def poll(cls, context):
        if not super().poll(context):
            return False
        if not is_player(context.object):
            cls.poll_message_set("Select a player")
            return False
        return True


def _has_own_keys(operator: type[bpy.types.Operator], obj: bpy.types.Object) -> bool:
    """Return whether keys can be set on an object; otherwise set the operator's poll message."""
    action = obj.animation_data and obj.animation_data.action
    if not all(block is None or block.is_editable for block in (obj, action)):
        operator.poll_message_set("The keys are linked from another file; open that file to change them")
        return False
    if is_tweaked(obj):
        # Its keys are at the times of a strip, not of the scene.
        operator.poll_message_set("Leave tweak mode in the NLA editor first")
        return False
    return True


class _OnKeyedPlayer(_OnPlayer):
    """An operator that sets keys of the active player."""

    @classmethod
    def poll(cls, context):
        return super().poll(context) and _has_own_keys(cls, context.object)


@with_properties(Retiming)
class CONVWASS_OT_retime_player(_OnKeyedPlayer, bpy.types.Operator):
    """Replace the keys of the player's value: ease, hold, bounce, slow motion"""

    bl_idname = "convwass.retime_player"
    bl_label = "Retime"
    bl_options = {"REGISTER", "UNDO"}

    def draw(self, context):
        self.layout.use_property_split = True
        for name in ("style", "frames", *_OF_STYLE.get(self.style, ())):
            self.layout.prop(self, name)

    @reporting_errors
    def execute(self, context):
        span = retime(context.object, Retiming(**values_of(self, Retiming)))
        self.report({"INFO"}, rpt_("Plays in frames {:d} to {:d}").format(span[0], span[-1]))
        return {"FINISHED"}


class CONVWASS_OT_update_player_speed(_OnKeyedPlayer, bpy.types.Operator):
    """Key the speed of the player from its current value curve, for motion blur; needed after editing the curve"""

    bl_idname = "convwass.update_player_speed"
    bl_label = "Update Motion Blur"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        if not super().poll(context):
            return False
        if speed(context.object) is None:
            cls.poll_message_set("The player shows baked blends only, with their own velocity")
            return False
        return True

    def execute(self, context):
        key_speed(context.object)
        return {"FINISHED"}


class CONVWASS_OT_update_pad_velocity(OnActiveMorph, bpy.types.Operator):
    """Key the velocity of the pad's handle from its movement, for motion blur; needed after that was edited"""

    bl_idname = "convwass.update_pad_velocity"
    bl_label = "Update Motion Blur"
    bl_options = {"REGISTER", "UNDO"}
    changes_morph = False

    @classmethod
    def poll(cls, context):
        if not super().poll(context):
            return False
        velocity = handle_velocity(active_morph(context), context.object)
        if velocity is None:
            cls.poll_message_set("Select a pad that interpolates between blends")
            return False
        return _has_own_keys(cls, velocity.modifier.id_data)

    @reporting_errors
    def execute(self, context):
        key_handle_velocity(handle_velocity(active_morph(context), context.object))
        return {"FINISHED"}


class CONVWASS_OT_bake_player(BackgroundOperator, _OnPlayer, bpy.types.Operator):
    """Make a mesh of every frame that the player shows, at any frame rate; Make Volume and Make Cache write them"""

    bl_idname = "convwass.bake_player"
    bl_label = "Bake Frames"
    bl_options = {"REGISTER", "UNDO"}
    _title = Sentence("Baking frames")
    _in_turn = True

    rate: bpy.props.FloatProperty(
        name="Frame Rate",
        description="Frames per second of the new morph, which shows each of its frames for one scene frame",
        default=24.0,
        min=0.1,
        soft_max=120.0,
    )

    _chosen_in_dialog = False

    @classmethod
    def poll(cls, context):
        return super().poll(context) and is_idle(cls, context)

    def invoke(self, context, event):
        render = context.scene.render
        self.rate = render.fps / render.fps_base
        self._chosen_in_dialog = True
        return context.window_manager.invoke_props_dialog(self)

    def execute(self, context):
        if not self._chosen_in_dialog:
            return super().execute(context)
        # The dialog calls execute, where other operators are invoked. So does Blender when settings are adjusted later,
        # which must be done when execute returns.
        self._chosen_in_dialog = False
        return super().invoke(context, None)

    def _begin(self, context):
        from ..bridge.morphs.players.dense_bake import DenseBake, sample_times

        render = context.scene.render
        first, last = keyed_span(context.object)
        return DenseBake(context.object, sample_times(first, last, render.fps / render.fps_base, self.rate), first)

    def _finish(self, context, job):
        morph = job.finish()
        select_only(context, frame_objects(morph)[:1])
        self.report({"INFO"}, rpt_("{:s}: {:d} meshes").format(morph.name, len(frame_objects(morph))))
        return {"FINISHED"}


class CONVWASS_OT_make_blend_pad(_ShowingMorph, bpy.types.Operator):
    """Show the active sheet with one object: the blend at an Empty that is dragged or animated on a pad"""

    bl_idname = "convwass.make_blend_pad"
    bl_label = "Make Blend Pad"
    bl_options = {"REGISTER", "UNDO"}
    _title = Sentence("Making the blend pad")

    between: property_of(MorphRequest, "between")

    def _check(self, morph):
        require_sheet(morph)

    def _shown(self, morph, sampled):
        return build_blend_pad(morph, sampled=sampled).handle


class CONVWASS_OT_remove_player(_InObjectMode, bpy.types.Operator):
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

    def execute(self, context):
        morph = active_morph(context)
        remove_stand_ins(morph)
        select_only(context, frame_objects(morph)[:1])
        return {"FINISHED"}


classes = (
    CONVWASS_OT_make_player,
    CONVWASS_OT_retime_player,
    CONVWASS_OT_update_player_speed,
    CONVWASS_OT_bake_player,
    CONVWASS_OT_make_blend_pad,
    CONVWASS_OT_update_pad_velocity,
    CONVWASS_OT_remove_player,
)
