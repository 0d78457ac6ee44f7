# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Live Morph: a shape that follows a handle until Esc; it can be kept as a mesh, or baked."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy
from bpy.app.translations import pgettext_rpt as rpt_

from ..bridge.live.running import running_live
from ..bridge.morphs.inputs.morph_guides import guides_among
from ..bridge.shape_sources import is_plain, shape_sources
from ..errors import InputError
from ..properties.live import LiveProperties
from ..properties.morphs import MorphProperties
from ..translations import translated
from .chosen_inputs import chosen_inputs
from .live_drag import HandleDrag
from .morph_manage import is_free_to_bake
from .reporting import refuse, reporting_errors
from .windows import clear_status, clear_windows, redraw_sidebars, redraw_window, write_status

if TYPE_CHECKING:
    from ..bridge.live.live_session import LiveSession

_TIMER_SECONDS = 0.015
# Maximum seconds that Keep Shape waits for a complete solve.
_PATIENCE = 6.0
_TIMERS: list[bpy.types.Timer] = []


class CONVWASS_OT_live_morph(LiveProperties, MorphProperties, bpy.types.Operator):
    """Blend two to four selected shapes live: drag the handle and the shape follows; Esc ends it and removes it"""

    bl_idname = "convwass.live_morph"
    bl_label = "Live Morph"
    bl_options = {"REGISTER"}

    @classmethod
    def poll(cls, context):
        if running_live() is not None:
            cls.poll_message_set("A live morph is running; press Esc in the viewport to end it")
            return False
        return is_free_to_bake(cls, context)

    def execute(self, context):
        self.report({"ERROR"}, rpt_("A live morph needs a window; bake a morph instead"))
        return {"CANCELLED"}

    def invoke(self, context, event):
        if bpy.app.background:
            return self.execute(context)
        started = self.begin(context)
        if started == {"RUNNING_MODAL"}:
            context.window_manager.modal_handler_add(self)
        return started

    @reporting_errors
    def begin(self, context: bpy.types.Context) -> set[str]:
        """Start the live morph; the operator then gets a modal handler."""
        self._session = begun_session(context, self)
        self._drag, self._text = HandleDrag(self._session.scene.pad), ""
        self._timer = context.window_manager.event_timer_add(_TIMER_SECONDS, window=context.window)
        _TIMERS.append(self._timer)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        session = running_live()
        if session is None or session is not self._session:
            # It was baked, or ended by another operator.
            return self._ended(context, {"FINISHED"})
        if event.type == "ESC" and event.value == "PRESS":
            return self._ended(context, {"CANCELLED"})
        if event.type != "TIMER":
            return {"RUNNING_MODAL"} if self._drag.takes(context, event) else {"PASS_THROUGH"}
        try:
            goes_on = session.tick()
        except BaseException as error:
            # After any error, nothing may keep running in the background.
            self._ended(context, {"CANCELLED"})
            return refuse(self, error)
        if not goes_on:
            self.report({"INFO"}, rpt_("The live morph has ended, since its objects were removed"))
            return self._ended(context, {"CANCELLED"})
        if session.has_failed:
            self.report({"ERROR"}, translated(session.message))
            return self._ended(context, {"CANCELLED"})
        self._show_state(context, session)
        return {"PASS_THROUGH"}

    def cancel(self, context):
        self._ended(context, {"CANCELLED"})

    def _show_state(self, context: bpy.types.Context, session: LiveSession) -> None:
        text = f"{rpt_('Live Morph')}: {translated(session.message)}    Esc: {rpt_('end')}"
        if text == self._text:
            return
        self._text = text
        write_status(context, text)
        redraw_sidebars(context)

    def _ended(self, context: bpy.types.Context, result: set[str]) -> set[str]:
        if self._timer in _TIMERS:
            _TIMERS.remove(self._timer)
            context.window_manager.event_timer_remove(self._timer)
        self._session.end()
        clear_status(context)
        redraw_window(context)
        return result


def begun_session(context: bpy.types.Context, own: CONVWASS_OT_live_morph) -> LiveSession:
    """Start a live morph of the chosen shapes; raises InputError or ResourceError if that is impossible."""
    from ..bridge.flat.choosing import asks_for_flat
    from ..bridge.live.live_session import LiveRequest, LiveSession

    objects = chosen_inputs(context, own).objects
    if not 2 <= len(objects) <= 4:
        raise InputError("A live morph requires two, three or four shapes, not {count}.", count=len(objects))
    are_plain = all(map(is_plain, shape_sources(objects, own.grouping)))
    if are_plain and asks_for_flat(objects, context.evaluated_depsgraph_get(), own.thickness):
        raise InputError("Flat shapes cannot be morphed live; bake them, or give them thickness.")
    guides = guides_among(context.scene.convwass_guides.named, objects)
    options = {**own.request().as_dict(), "guides": [guide.as_dict() for guide in guides]}
    return LiveSession(context, objects, LiveRequest(own.solver_settings(), own.live_settings(), options))


class _OnLiveMorph:
    @classmethod
    def poll(cls, context):
        if running_live() is None:
            cls.poll_message_set("No live morph is running")
            return False
        return True


class CONVWASS_OT_keep_live_shape(_OnLiveMorph, bpy.types.Operator):
    """Create a mesh object from the visible blend; the live morph continues"""

    bl_idname = "convwass.keep_live_shape"
    bl_label = "Keep Shape"
    bl_options = {"REGISTER", "UNDO"}

    @reporting_errors
    def execute(self, context):
        obj = running_live().kept_shape(_PATIENCE)
        if obj is None:
            self.report({"ERROR"}, rpt_("There is no blend yet; wait a moment"))
            return {"CANCELLED"}
        self.report({"INFO"}, rpt_("{:s}: {:d} vertices").format(obj.name, len(obj.data.vertices)))
        return {"FINISHED"}


class CONVWASS_OT_bake_live_morph(_OnLiveMorph, bpy.types.Operator):
    """End the live morph, and bake its shapes with the settings of the panel"""

    bl_idname = "convwass.bake_live_morph"
    bl_label = "Bake"
    bl_options = {"INTERNAL"}

    @reporting_errors
    def execute(self, context):
        session = running_live()
        if session.watch.lost:
            raise InputError(
                "{names} was deleted, so the live morph cannot be baked; Keep Shape keeps what it shows.",
                names=", ".join(session.watch.lost),
            )
        names, weights = "\n".join(session.objects), ",".join(f"{weight:.6g}" for weight in session.weights)
        session.end()
        settings = context.scene.convwass_morph
        given = {name: getattr(settings, name) for name in bake_arguments()}
        if settings.layout == "BLEND":
            given["weights"] = weights
        how = "EXEC_DEFAULT" if bpy.app.background else "INVOKE_DEFAULT"
        try:
            return bpy.ops.convwass.bake_morph(how, inputs=names, **given)
        except RuntimeError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}


def bake_arguments() -> list[str]:
    """Return the names of the settings that Bake Morph reads from a scene."""
    from inspect import get_annotations

    return [name for base in MorphProperties.__mro__ for name in get_annotations(base)]


class CONVWASS_OT_end_live_morph(_OnLiveMorph, bpy.types.Operator):
    """End the live morph, like Esc in the viewport, and remove it"""

    bl_idname = "convwass.end_live_morph"
    bl_label = "End"
    bl_options = {"INTERNAL"}

    def execute(self, context):
        running_live().end()
        return {"FINISHED"}


def stop_live(context: bpy.types.Context) -> None:
    """End a live morph before its operators are unregistered, because Blender does not notify them."""
    session = running_live()
    if session is not None:
        session.end()
    for timer in _TIMERS:
        context.window_manager.event_timer_remove(timer)
    if _TIMERS:
        clear_windows(context)
    _TIMERS.clear()


classes = (
    CONVWASS_OT_live_morph,
    CONVWASS_OT_keep_live_shape,
    CONVWASS_OT_bake_live_morph,
    CONVWASS_OT_end_live_morph,
)
