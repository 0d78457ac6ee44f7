# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What is left of operators that wait when the add-on is taken away."""

from __future__ import annotations

from contextlib import contextmanager, nullcontext
from types import SimpleNamespace

import bpy
import pytest

from convwass_addon.operators import density_pick, picking, windows as windows_module
from convwass_addon.operators.density_paint import CONVWASS_OT_drop_density
from tests.operators.densities import ball
from tests.operators.running import Pressed, window_context

pytestmark = pytest.mark.usefixtures("empty_scene")


@pytest.fixture
def windows():
    """A context of one window, and the cursors and texts that it is given."""
    context, given = window_context(), []
    context.window.cursor_modal_set = given.append
    context.window.cursor_modal_restore = lambda: given.append("own")
    context.workspace.status_text_set = given.append
    context.window_manager.windows = [context.window]
    context.temp_override = lambda window: nullcontext()
    return SimpleNamespace(context=context, given=given)


def wait_for_a_click(context):
    """Press an operator that asks for a click on a surface; return it."""
    context.object = ball()
    pressed = Pressed(CONVWASS_OT_drop_density)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(density_pick, "bpy", SimpleNamespace(app=SimpleNamespace(background=False)))
        assert pressed.invoke(context, None) == {"RUNNING_MODAL"}
    return pressed


def test_windows_get_their_cursor_and_status_bar_back(windows):
    wait_for_a_click(windows.context)
    assert windows.given == ["Click on the surface    Esc: cancel", "EYEDROPPER"]
    picking.stop_waiting(windows.context)
    assert windows.given[2:] == ["own", None]
    picking.stop_waiting(windows.context)
    assert len(windows.given) == 4


def test_finished_waiting_leaves_windows_unchanged(windows):
    waiting = wait_for_a_click(windows.context)
    waiting.cancel(windows.context)
    windows.given.clear()
    picking.stop_waiting(windows.context)
    assert windows.given == []


def test_a_status_text_does_not_stay_where_the_user_has_been(monkeypatch):
    """Blender always sets the status text of the context's workspace; every workspace keeps its own."""
    texts = {}
    context = window_context()

    def workspace(uid):
        return SimpleNamespace(
            session_uid=uid, status_text_set=lambda text: texts.update({context.workspace.session_uid: text})
        )

    @contextmanager
    def override(workspace):
        before, context.workspace = context.workspace, workspace
        yield
        context.workspace = before

    layout, modeling = workspace(1), workspace(2)
    context.temp_override = override
    monkeypatch.setattr(windows_module.Handle, "find", lambda handle: {1: layout, 2: modeling}[handle.uid])
    context.workspace = layout
    windows_module.write_status(context, "Baking: 1")
    windows_module.write_status(context, "Baking: 2")
    assert texts == {1: "Baking: 2"}
    context.workspace = modeling
    windows_module.write_status(context, "Baking: 3")
    assert texts == {1: None, 2: "Baking: 3"}
    context.workspace = layout
    windows_module.clear_status(context)
    assert texts == {1: None, 2: None}
    texts.clear()
    windows_module.clear_status(context)
    assert texts == {1: None}, "the other workspace has been forgotten"


def test_the_windows_of_blender_are_cleared(windows, registered_addon):
    """With its own context; a text or cursor cannot be asked for."""
    wait_for_a_click(windows.context)
    windows.given.clear()
    assert bpy.context.window_manager.windows
    registered_addon.unregister()
    registered_addon.register()
    picking.stop_waiting(windows.context)
    assert windows.given == [], "nothing waits any more"


def test_jobs_do_not_continue_after_enabling_again(registered_addon):
    progress = bpy.context.window_manager.convwass_progress
    progress.running = progress.stopping = True
    registered_addon.unregister()
    registered_addon.register()
    progress = bpy.context.window_manager.convwass_progress
    assert not progress.running
    assert not progress.stopping
