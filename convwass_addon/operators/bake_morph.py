# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Bake a morph of the selected meshes, in the background where there is a window."""

from __future__ import annotations

from functools import partial

import bpy
from bpy.app.translations import pgettext_rpt as rpt_

from ..applications.background import BackgroundJob
from ..applications.morph import MorphStep
from ..bridge.job import MorphJob
from ..bridge.stored import frame_objects
from ..errors import Cancelled, ConvwassError
from ..properties import MorphProperties

_TIMER_SECONDS = 0.1


class CONVWASS_OT_bake_morph(MorphProperties, bpy.types.Operator):
    """Morph the selected meshes into each other by optimal transport, one mesh object per frame"""

    bl_idname = "convwass.bake_morph"
    bl_label = "Bake Morph"
    bl_options = {"REGISTER", "UNDO"}

    _job: MorphJob
    _background: BackgroundJob[MorphStep]
    _timer: bpy.types.Timer

    @classmethod
    def poll(cls, context):
        if context.mode != "OBJECT":
            cls.poll_message_set("Go to Object Mode first")
            return False
        if sum(obj.type == "MESH" for obj in context.selected_objects) < 2:
            cls.poll_message_set("Select at least two mesh objects")
            return False
        if context.window_manager.convwass_progress.running:
            cls.poll_message_set("A morph is being baked; press Esc in the viewport to stop it")
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
            for step in job.steps():
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
        self._background = BackgroundJob(partial(self._job.steps, previews=True))
        self._timer = context.window_manager.event_timer_add(_TIMER_SECONDS, window=context.window)
        context.window_manager.modal_handler_add(self)
        self._show(context, 0.0, "Starting")
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type == "ESC" and event.value == "PRESS":
            self._background.cancel()
        elif event.type != "TIMER":
            return {"PASS_THROUGH"}
        done = self._background.done
        try:
            for step in self._background.poll():
                self._job.write(step)
                self._show(context, step.fraction, step.message)
        except ConvwassError as error:
            self._background.cancel()
            self._stop(context)
            self._job.discard()
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return self._end(context) if done or event.type == "ESC" else {"PASS_THROUGH"}

    def cancel(self, context):
        self._background.cancel()
        self._stop(context)
        self._job.discard()

    def _begin(self, context: bpy.types.Context) -> MorphJob:
        """Read the inputs; everything that can be refused is refused here or before the first frame."""
        inputs = self.sorted_shapes([obj for obj in context.selected_objects if obj.type == "MESH"])
        options = {name: getattr(self, name) for name in ("layout", "frames", "steps", "order", "reverse")}
        blends, settings = self.blends(len(inputs)), self.solver_settings()
        depsgraph = context.evaluated_depsgraph_get()
        return MorphJob(context.scene, depsgraph, inputs, blends, settings, options, context.scene.frame_start)

    def _end(self, context: bpy.types.Context) -> set[str]:
        """Finish or give up once the thread has ended."""
        self._stop(context)
        error = self._background.error
        try:
            if error is None:
                return self._finish(context, self._job)
            if isinstance(error, Cancelled) and self._job.records:
                collection = self._job.finish(self.hide_inputs)
                self._select(context, frame_objects(collection)[0])
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
        self._select(context, frame_objects(collection)[0])
        slack = [record for record in job.records if not record.get("converged", True)]
        if slack:
            worst = max(record["marginal_error"] for record in slack)
            message = rpt_("{:d} frames are less exact than asked for (marginal error up to {:.1%}); try more blur")
            self.report({"WARNING"}, message.format(len(slack), worst))
        elif job.notices:
            self.report({"WARNING"}, " ".join(job.notices))
        else:
            self.report({"INFO"}, rpt_("{:s}: {:d} meshes").format(collection.name, len(job.records)))
        return {"FINISHED"}

    def _select(self, context: bpy.types.Context, shown: bpy.types.Object) -> None:
        """Make the morph the thing that is selected: the inputs may be hidden now."""
        for obj in context.selected_objects:
            obj.select_set(False)
        context.view_layer.objects.active = shown
        shown.select_set(True)

    def _show(self, context: bpy.types.Context, fraction: float, message: str) -> None:
        progress = context.window_manager.convwass_progress
        progress.running, progress.fraction, progress.message = True, fraction, message
        context.workspace.status_text_set(f"{rpt_('Baking morph')}: {message}    Esc: {rpt_('stop')}")
        for area in context.window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()

    def _stop(self, context: bpy.types.Context) -> None:
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.convwass_progress.running = False
        if context.workspace:
            context.workspace.status_text_set(None)
        for area in context.window.screen.areas if context.window else ():
            area.tag_redraw()


classes = (CONVWASS_OT_bake_morph,)
