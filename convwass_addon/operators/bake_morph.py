# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Bake a morph of the selected meshes, in the background where there is a window."""

from __future__ import annotations

import math
import time
from functools import partial

import bpy
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import StringProperty

from ..applications.background import BackgroundJob
from ..applications.frame_cache import FrameCache
from ..applications.morph import MorphStep
from ..bridge.disk_output import packed_bytes
from ..bridge.job import MorphJob
from ..bridge.replace import replace_bake
from ..bridge.stand_ins import stand_ins
from ..bridge.stored import frame_objects
from ..errors import Cancelled, ConvwassError
from ..preferences import preferences
from ..properties import MorphProperties
from .chosen_inputs import chosen_inputs
from .manage_morph import is_free_to_bake, select_only

_TIMER_SECONDS = 0.05
# The window answers at least this often while many objects wait to be made.
_BUSY_SECONDS = 0.1
# From when on the time that is left is told: before that, the first frames say little.
_SOONEST, _LEAST_FRACTION = 2.0, 0.15
# Meshes that are larger than this in all are worth a warning.
_LARGE_MEGABYTES = 250.0
# What is made of a morph for which output and layout.
_OUTPUT_OPERATORS = {
    ("PLAYER", "PATH"): "make_player",
    ("PLAYER", "GRID"): "make_blend_pad",
    ("PLAYER", "TRIANGLE"): "make_blend_pad",
    ("VOLUME", ""): "make_volume",
    ("CACHE", ""): "make_cache",
}


class CONVWASS_OT_bake_morph(MorphProperties, bpy.types.Operator):
    """Morph shapes into each other by optimal transport: those on the list, or else the selected meshes"""

    bl_idname = "convwass.bake_morph"
    bl_label = "Bake Morph"
    bl_options = {"REGISTER", "UNDO"}

    inputs: StringProperty(
        name="Inputs",
        description="Names of the objects to morph in their order, one per line or with commas between them; empty for "
        "those on the list of inputs, or else the selected ones",
        options={"SKIP_SAVE"},
    )
    weights: StringProperty(
        name="Weights",
        description="Numbers with commas between them, one per shape, for a single blend; empty for those on the list",
        options={"SKIP_SAVE"},
    )

    replaces: StringProperty(
        name="Replaces",
        description="Name of a morph's collection whose frames the new ones take the place of; empty for a new morph",
        options={"SKIP_SAVE"},
    )
    following: StringProperty(
        name="Following",
        description="Names of morphs to bake again when this one is done, one per line",
        options={"SKIP_SAVE"},
    )

    _job: MorphJob
    _computing: dict[str, object]
    _background: BackgroundJob[MorphStep]
    _timer: bpy.types.Timer
    _began: float

    @classmethod
    def poll(cls, context):
        if not is_free_to_bake(cls, context):
            return False
        # Which shapes are meant depends on the arguments.
        if len(bpy.data.objects) < 2:
            cls.poll_message_set("Select at least two mesh objects")
            return False
        return True

    def execute(self, context):
        try:
            job = self._begin(context)
        except ConvwassError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        manager = context.window_manager
        manager.progress_begin(0, 100)
        try:
            for step in job.steps(**self._computing):
                job.write(step)
                manager.progress_update(int(100 * step.fraction))
            return self._finish(context, job)
        except BaseException as error:
            job.discard()
            if not isinstance(error, ConvwassError):
                raise
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        finally:
            manager.progress_end()

    def invoke(self, context, event):
        if bpy.app.background:
            return self.execute(context)
        try:
            self._job = self._begin(context)
        except ConvwassError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        self._background = BackgroundJob(partial(self._job.steps, previews=True, **self._computing))
        self._timer = context.window_manager.event_timer_add(_TIMER_SECONDS, window=context.window)
        context.window_manager.modal_handler_add(self)
        context.window_manager.convwass_progress.stopping = False
        self._began = time.monotonic()
        self._show(context, 0.0, "Starting")
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        stopping = context.window_manager.convwass_progress.stopping or (event.type == "ESC" and event.value == "PRESS")
        if stopping:
            self._background.cancel()
        elif event.type != "TIMER":
            return {"PASS_THROUGH"}
        try:
            written = self._write(context, math.inf if stopping else _BUSY_SECONDS)
        except ConvwassError as error:
            self._background.cancel()
            self._stop(context)
            self._job.discard()
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return self._end(context) if written else {"PASS_THROUGH"}

    def cancel(self, context):
        self._background.cancel()
        self._stop(context)
        self._job.discard()

    def _begin(self, context: bpy.types.Context) -> MorphJob:
        """Read the inputs; everything that can be refused is refused here or before the first frame."""
        self._computing = _computing()
        chosen = chosen_inputs(context, self, self.inputs, self.weights)
        weights = chosen.weights if self.layout == "BLEND" else None
        options = {**self.stored_options(), "weights": weights}
        blends, settings = self.blends(len(chosen.objects), weights), self.solver_settings()
        depsgraph, first_frame = context.evaluated_depsgraph_get(), self.first_frame(context.scene)
        return MorphJob(context.scene, depsgraph, chosen.objects, blends, settings, options, first_frame)

    def _write(self, context: bpy.types.Context, seconds: float) -> bool:
        """Write what has been done, for so long; return whether nothing more will come."""
        done, until, step = self._background.done, time.monotonic() + seconds, None
        for step in self._background.poll():
            self._job.write(step)
            if time.monotonic() > until:
                done = False
                break
        if step is not None:
            self._show(context, step.fraction, step.message)
        return done

    def _end(self, context: bpy.types.Context) -> set[str]:
        """Finish or give up once the thread has ended."""
        self._stop(context)
        error = self._background.error
        try:
            if error is None:
                return self._finish(context, self._job)
            if isinstance(error, Cancelled) and self._job.records and not self.replaces:
                collection = self._job.finish(self.hide_inputs)
                select_only(context, frame_objects(collection)[:1])
                self.report({"WARNING"}, rpt_("Stopped; {:d} finished frames are kept").format(len(self._job.records)))
                return {"FINISHED"}
        except ConvwassError as failure:
            error = failure
        self._job.discard()
        if isinstance(error, Cancelled):
            self.report({"INFO"}, rpt_("Stopped before the first frame was finished"))
        elif isinstance(error, ConvwassError):
            self.report({"ERROR"}, str(error))
        else:
            raise error
        return {"CANCELLED"}

    def _finish(self, context: bpy.types.Context, job: MorphJob) -> set[str]:
        collection = job.finish(self.hide_inputs)
        replaced = bpy.data.collections.get(self.replaces)
        if replaced is not None:
            collection = replace_bake(replaced, collection)
        select_only(context, frame_objects(collection)[:1])
        self._hand_over(collection)
        slack = [record for record in job.records if not record.get("converged", True)]
        if slack:
            worst = max(record["marginal_error"] for record in slack)
            message = rpt_("{:d} frames are less exact than asked for (marginal error up to {:.1%}); try more blur")
            self.report({"WARNING"}, message.format(len(slack), worst))
        elif job.notices:
            self.report({"WARNING"}, " ".join(job.notices))
        elif (megabytes := packed_bytes(frame_objects(collection)) / 1e6) > _LARGE_MEGABYTES:
            message = rpt_("The meshes add about {:.0f} MB to the file; Make Cache or Make Volume keeps them beside it")
            self.report({"WARNING"}, message.format(megabytes))
        else:
            self.report({"INFO"}, rpt_("{:s}: {:d} meshes").format(collection.name, len(job.records)))
        if self.following:
            bpy.ops.convwass.rebake_morph("INVOKE_DEFAULT", morphs=self.following)
        return {"FINISHED"}

    def _hand_over(self, morph: bpy.types.Collection) -> None:
        """Make of the morph, which is selected, what the output asks for; the meshes are kept where that fails."""
        name = _OUTPUT_OPERATORS.get((self.output, self.layout)) or _OUTPUT_OPERATORS.get((self.output, ""))
        if name is None or stand_ins(morph):
            return
        options = {"folder": self.output_folder} if self.output in ("VOLUME", "CACHE") else {}
        if self.output == "CACHE":
            options["kind"] = self.cache_format
        try:
            getattr(bpy.ops.convwass, name)(**options)
        except RuntimeError as error:
            self.report({"WARNING"}, str(error).strip().removeprefix("Error: "))

    def _show(self, context: bpy.types.Context, fraction: float, message: str) -> None:
        progress = context.window_manager.convwass_progress
        left = time_left(time.monotonic() - self._began, fraction)
        if left is not None:
            message = rpt_("{:s}, about {:d} s left").format(message, left)
        progress.running, progress.fraction, progress.message = True, fraction, message
        context.workspace.status_text_set(f"{rpt_('Baking morph')}: {message}    Esc: {rpt_('stop')}")
        # The sidebar alone: drawing the shapes again may take long, and new ones see to that themselves.
        for area in context.window.screen.areas:
            for region in area.regions if area.type == "VIEW_3D" else ():
                if region.type == "UI":
                    region.tag_redraw()

    def _stop(self, context: bpy.types.Context) -> None:
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.convwass_progress.running = False
        if context.workspace:
            context.workspace.status_text_set(None)
        for area in context.window.screen.areas if context.window else ():
            area.tag_redraw()


class CONVWASS_OT_stop_bake(bpy.types.Operator):
    """Stop the bake that is running; frames that are finished are kept, as with Esc in the viewport"""

    bl_idname = "convwass.stop_bake"
    bl_label = "Stop"
    bl_options = {"INTERNAL"}

    @classmethod
    def poll(cls, context):
        if not context.window_manager.convwass_progress.running:
            cls.poll_message_set("No morph is being baked")
            return False
        return True

    def execute(self, context):
        context.window_manager.convwass_progress.stopping = True
        return {"FINISHED"}


def time_left(passed: float, fraction: float) -> int | None:
    """Return how many seconds a bake will take from here on, in steps that do not flicker; None while nobody knows."""
    if passed < _SOONEST or fraction < _LEAST_FRACTION:
        return None
    left = passed * (1.0 - fraction) / fraction
    step = 1 if left < 10 else 5 if left < 60 else 30
    return step * math.ceil(left / step)


def _computing() -> dict[str, object]:
    """Return how the preferences want frames to be computed; raises InputError for a folder that cannot be used."""
    preferred = preferences()
    cache = None if preferred.cache_folder is None else FrameCache(preferred.cache_folder)
    return {"workers": preferred.workers, "cache": cache}


classes = (CONVWASS_OT_bake_morph, CONVWASS_OT_stop_bake)
