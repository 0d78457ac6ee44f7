# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The bar of a running job is shown once, above all other panels, in every sidebar of the add-on."""

from __future__ import annotations

import bpy
import pytest

from convwass_addon.panels import MODULES
from tests.operators.densities import ball

from .drawing import draw, panels

pytestmark = pytest.mark.usefixtures("empty_scene")

BAR = ("progress", "Frame 1 of 2")


@pytest.fixture
def running(empty_scene):
    """A job that is half done, for a test only."""
    progress = bpy.context.window_manager.convwass_progress
    progress.running, progress.fraction, progress.message = True, 0.5, BAR[1]
    yield
    progress.running = False


def drawn_in(space):
    return [draw(panel) for panel in panels() if panel.bl_space_type == space]


@pytest.mark.parametrize("space", ["VIEW_3D", "IMAGE_EDITOR"])
@pytest.mark.parametrize("mode", ["OBJECT", "WEIGHT_PAINT"])
@pytest.mark.usefixtures("running")
def test_there_is_one_bar_with_a_button_below(space, mode):
    ball()
    bpy.ops.object.mode_set(mode=mode)
    bars = [drawn for drawn in drawn_in(space) if BAR in drawn]
    assert bars == [[BAR, ("operator", "convwass.stop")]]


@pytest.mark.parametrize("space", ["VIEW_3D", "IMAGE_EDITOR"])
def test_without_a_job_there_is_no_bar(space):
    ball()
    assert not [entry for drawn in drawn_in(space) for entry in drawn if entry[0] == "progress"]


@pytest.mark.parametrize("space", ["VIEW_3D", "IMAGE_EDITOR"])
def test_it_is_above_all_other_panels_and_does_not_change_the_order_of_tabs(space):
    """Blender draws panels in the order in which they are registered, but those without a header before all tabs."""
    kinds = [cls for module in MODULES for cls in module.classes if issubclass(cls, bpy.types.Panel)]
    first = next(kind for kind in kinds if kind.bl_space_type == space)
    assert first.__name__.endswith("progress")
    assert not [kind for kind in kinds if "HIDE_HEADER" in getattr(kind, "bl_options", ())]
    assert not hasattr(first, "bl_parent_id")
    # Nor does one of the others ask to be drawn before it.
    assert all(getattr(kind, "bl_order", 0) >= 0 for kind in kinds)
