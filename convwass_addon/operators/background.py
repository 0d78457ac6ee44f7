# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators that run in the background if there is a window, and immediately otherwise."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from contextlib import closing
from dataclasses import dataclass
from typing import Any, Protocol

import bpy
from bpy.app.translations import pgettext_rpt as rpt_

from ..applications.background import BackgroundJob, InlineJob
from ..bridge.handles import Handle
from ..bridge.mouse_progress import progress_at_mouse
from ..errors import Cancelled
from ..progress import UNINTERRUPTED, Control, Progress, Request, Work
from ..sentence import Sentence
from ..translations import translated
from .reporting import refuse, reporting_errors
from .windows import clear_status, clear_windows, redraw_sidebars, redraw_window, write_status

_TIMER_SECONDS = 0.05
# The longest time, in seconds, that results are written before the window can respond again.
_BUSY_SECONDS = 0.1
# Seconds that the window waits for a cancelled job.
_PATIENCE = 0.5
# The remaining time is shown after this many seconds and this share of the work; earlier estimates are unreliable.
_SOONEST, _LEAST_FRACTION = 2.0, 0.15


class Job(Protocol):
    """Work that is computed on a thread and written on the main thread."""

    def steps(self, control: Control) -> Work[None]:
        """Do the work."""

    def write(self, report: Progress[Any]) -> None:
        """Write the payload of a report, or answer its request; by default, the file is only changed at the end."""

    def discard(self) -> None:
        """Remove everything that was written."""


@dataclass(frozen=True, eq=False)
class _Running:
    """A running operator, with everything needed to end it from outside."""

    background: BackgroundJob[None] | InlineJob[None]
    job: Job
    timer: bpy.types.Timer


_RUNNING: set[_Running] = set()


class BackgroundOperator:
    """Base of operators with long work; subclasses implement the hooks at the end."""

    _title: Sentence
    """The name of the work."""

    _in_turn = False
    """Whether the work accesses Blender's data and must run on the main thread, in small pieces."""

    _job: Job
    _background: BackgroundJob[None] | InlineJob[None]
    _is_started = False
    """Whether the work has started, which follows a dialog or a file browser if the operator has one."""

    _running: _Running
    _in_background: bool
    _began: float
    _ending: bool
    _scene: Handle

    @reporting_errors
    def execute(self, context):
        self._scene = Handle.of("scenes", context.scene)
        self._job = self._begin(context)
        self._in_background = False
        try:
            with progress_at_mouse() as show, closing(self.work()(UNINTERRUPTED)) as work:
                for report in work:
                    self._job.write(report)
                    show(report.fraction)
                answer = self._finish(context, self._job)
        except BaseException as error:
            return self._fail(error)
        self._go_on()
        return answer

    def invoke(self, context, event):
        if bpy.app.background:
            return self.execute(context)
        started = self._start(context)
        if started == {"RUNNING_MODAL"}:
            context.window_manager.modal_handler_add(self)
        return started

    def work(self) -> Callable[[Control], Work[None]]:
        """Return the function that does the work, given a control."""
        return self._steps(self._job)

    @reporting_errors
    def _start(self, context: bpy.types.Context) -> set[str]:
        """Start the work on its thread; the operator has, or is about to get, a modal handler."""
        self._scene = Handle.of("scenes", context.scene)
        self._job = self._begin(context)
        self._in_background = True
        self._background = (InlineJob if self._in_turn else BackgroundJob)(self.work())
        timer = context.window_manager.event_timer_add(_TIMER_SECONDS, window=context.window)
        self._running = _Running(self._background, self._job, timer)
        _RUNNING.add(self._running)
        self._is_started = True
        context.window_manager.convwass_progress.stopping = False
        self._began, self._ending = time.monotonic(), False
        self._show(context, 0.0, Sentence("Starting"))
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        asked = context.window_manager.convwass_progress.stopping or (event.type == "ESC" and event.value == "PRESS")
        stopping = asked or self._ending
        if stopping:
            # Steps that do not check the control, such as a factorization, may take a while; the window stays
            # responsive.
            if not self._background.cancel(0.0 if self._ending else _PATIENCE):
                self._ending = True
                self._show(context, context.window_manager.convwass_progress.fraction, Sentence("Stopping"))
                return {"PASS_THROUGH"}
        elif event.type != "TIMER":
            return {"PASS_THROUGH"}
        try:
            written = self._write(context, math.inf if stopping else _BUSY_SECONDS)
        except BaseException as error:
            # On any error, leave nothing running unnoticed.
            self._background.cancel()
            self._stop(context)
            answer = self._fail(error)
        else:
            if not written:
                return {"PASS_THROUGH"}
            waiting = None if stopping else self._waits_for(context, self._job)
            if waiting is not None:
                self._show(context, 1.0, waiting)
                return {"PASS_THROUGH"}
            answer = self._end(context, stopping)
        # However the job has ended, Esc stops those that were to follow it, too.
        if not stopping:
            self._go_on()
        return answer

    def cancel(self, context):
        if not self._is_started:
            return
        self._background.cancel()
        self._stop(context)
        self._job.discard()

    def _write(self, context: bpy.types.Context, seconds: float) -> bool:
        """Write finished reports for at most `seconds`; return whether the work has ended."""
        done, until, report = self._background.done, time.monotonic() + seconds, None
        for report in self._background.poll():
            # A cancelled job does not wait for answers.
            if not (self._background.cancelled and isinstance(report.payload, Request)):
                self._job.write(report)
            if time.monotonic() > until:
                done = False
                break
        if report is not None:
            self._show(context, report.fraction, report.message)
        return done

    def _end(self, context: bpy.types.Context, stopping: bool) -> set[str]:
        """Finish or discard the job after its thread has ended."""
        self._stop(context)
        error = self._background.error
        if error is None and stopping and self._waits_for(context, self._job) is not None:
            error = Cancelled("Cancelled.")
        try:
            if error is None:
                return self._finish(context, self._job)
            if isinstance(error, Cancelled) and self._keep(context, self._job):
                return {"FINISHED"}
        except Exception as failure:
            error = failure
        if isinstance(error, Cancelled):
            self._job.discard()
            self.report({"INFO"}, self._nothing_kept(self._job))
            return {"CANCELLED"}
        return self._fail(error)

    def _fail(self, error: BaseException) -> set[str]:
        """Discard the job and report its error."""
        self._job.discard()
        return refuse(self, error)

    def _show(self, context: bpy.types.Context, fraction: float, sentence: Sentence) -> None:
        message = translated(sentence)
        progress = context.window_manager.convwass_progress
        left = time_left(time.monotonic() - self._began, fraction)
        if left is not None:
            message = rpt_("{:s}, about {:d} s left").format(message, left)
        progress.running, progress.fraction, progress.message = True, fraction, message
        write_status(context, f"{translated(self._title)}: {message}    Esc: {rpt_('stop')}")
        redraw_sidebars(context)

    def _own_scene(self, context: bpy.types.Context) -> bpy.types.Scene:
        """Return the scene in which the work began, or the current one if it was deleted."""
        return self._scene.find() or context.scene

    def _stop(self, context: bpy.types.Context) -> None:
        _RUNNING.discard(self._running)
        context.window_manager.event_timer_remove(self._running.timer)
        context.window_manager.convwass_progress.running = False
        clear_status(context)
        redraw_window(context)

    # Hooks for operators.

    def _begin(self, context: bpy.types.Context) -> Job:
        """Read the inputs. Invalid input must be refused here or before the first report."""
        raise NotImplementedError

    def _steps(self, job: Job) -> Callable[[Control], Work[None]]:
        """Return the function that does the work. It must not access Blender's data unless `_in_turn` is true."""
        return job.steps

    def _finish(self, context: bpy.types.Context, job: Job) -> set[str]:
        """Write the result to the file and report it."""
        raise NotImplementedError

    def _nothing_kept(self, job: Job) -> str:
        """Return the message for a stopped job without results, in the user's language."""
        return rpt_("Stopped; nothing was changed")

    def _keep(self, context: bpy.types.Context, job: Job) -> bool:
        """Keep the finished part of a stopped job; return whether there is any."""
        return False

    def _go_on(self) -> None:
        """Start what was to follow the job, if anything; not called if the user has stopped it."""

    def _waits_for(self, context: bpy.types.Context, job: Job) -> Sentence | None:
        """Return what the user must do before the result can be written, or None."""
        return None


class CONVWASS_OT_stop(bpy.types.Operator):
    """Stop the running job, like Esc in the viewport; finished frames of a new morph are kept"""

    bl_idname = "convwass.stop"
    bl_label = "Stop"
    bl_options = {"INTERNAL"}

    @classmethod
    def poll(cls, context):
        if not context.window_manager.convwass_progress.running:
            cls.poll_message_set("Nothing is running")
            return False
        return True

    def execute(self, context):
        context.window_manager.convwass_progress.stopping = True
        return {"FINISHED"}


def stop_running(context: bpy.types.Context) -> None:
    """Cancel all running jobs and remove their partial results, before the operators are unregistered.

    Blender drops the modal handlers of an unregistered class without calling them.
    """
    while _RUNNING:
        running = _RUNNING.pop()
        running.background.cancel()
        context.window_manager.event_timer_remove(running.timer)
        progress = context.window_manager.convwass_progress
        progress.running = progress.stopping = False
        clear_windows(context)
        running.job.discard()


def is_idle(operator: type[bpy.types.Operator], context: bpy.types.Context) -> bool:
    """Return whether no job is running; otherwise set the operator's poll message."""
    if context.window_manager.convwass_progress.running:
        operator.poll_message_set("A job is running; press Esc in the viewport to stop it")
        return False
    return True


def time_left(passed: float, fraction: float) -> int | None:
    """Estimate the remaining seconds, rounded to steps that do not flicker; None if it is too early."""
    if passed < _SOONEST or fraction < _LEAST_FRACTION:
        return None
    left = passed * (1.0 - fraction) / fraction
    step = 1 if left < 10 else 5 if left < 60 else 30
    return step * math.ceil(left / step)


classes = (CONVWASS_OT_stop,)
