# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the dots of joints are drawn, and in which colors."""

from __future__ import annotations

from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from mathutils import Vector

from convwass_addon.bridge import viewport_overlay
from convwass_addon.bridge.armatures import joint_dots
from convwass_addon.bridge.armatures.joint_dots import JointDots, dots_of
from convwass_addon.bridge.armatures.pins import pin_joints
from convwass_addon.bridge.armatures.rigs import rig_graph
from tests.rigs import chain, lines

pytestmark = pytest.mark.usefixtures("registered_addon")


def places(obj, pinned):
    return sorted({tuple(np.round(dot.point, 4)) for dot in dots_of(obj) if dot.is_pinned == pinned})


def test_pinned_and_free_joints_in_every_mode():
    obj = chain(2)
    obj.location = (0, 0, 1)
    bpy.context.view_layer.update()
    pin_joints(obj, rig_graph(obj), [0])
    for mode in ("OBJECT", "EDIT", "POSE"):
        bpy.ops.object.mode_set(mode=mode)
        assert places(obj, True) == [(0, 0, 1)]
        assert places(obj, False) == [(1, 0, 1), (2, 0, 1)]


def test_posed_bones_are_followed_and_hidden_ones_left_out():
    obj = chain(2)
    obj.pose.bones["B"].rotation_mode = "XYZ"
    obj.pose.bones["B"].rotation_euler = (0, 0, np.pi / 2)
    bpy.context.view_layer.update()
    assert (2.0, 0.0, 0.0) not in places(obj, False)
    bpy.ops.object.mode_set(mode="EDIT")
    assert (2.0, 0.0, 0.0) in places(obj, False)
    obj.data.edit_bones["B"].hide = True
    assert (2.0, 0.0, 0.0) not in places(obj, False)
    bpy.ops.object.mode_set(mode="OBJECT")
    obj.hide_set(True)
    assert dots_of(obj) == []


def test_vertices_of_edges():
    obj = lines([(0, 0, 0), (1, 0, 0)], [(0, 1)])
    pin_joints(obj, rig_graph(obj), [1])
    assert (places(obj, True), places(obj, False)) == ([(1, 0, 0)], [(0, 0, 0)])


def test_drawing(monkeypatch):
    """What is drawn where, by a stand-in for the graphics card."""
    obj, drawn = chain(2), []
    pin_joints(obj, rig_graph(obj), [0])
    monkeypatch.setattr(joint_dots, "location_3d_to_region_2d", lambda region, view, point: Vector(point[:2]))
    monkeypatch.setattr(joint_dots, "fill_discs", lambda centers, radius, color: drawn.append((len(centers), color)))
    monkeypatch.setattr(joint_dots.gpu.state, "blend_set", lambda mode: None)
    overlay = SimpleNamespace(show_overlays=True)
    context = SimpleNamespace(
        space_data=SimpleNamespace(overlay=overlay), region=None, region_data=None, preferences=bpy.context.preferences
    )
    handlers, wanted = [], [obj]
    space = SimpleNamespace(draw_handler_add=lambda draw, *_: handlers.append(draw))
    types = SimpleNamespace(SpaceView3D=space)
    monkeypatch.setattr(viewport_overlay, "bpy", SimpleNamespace(context=context, types=types))
    JointDots(lambda _context: wanted[0]).register()
    (draw,) = handlers
    draw()
    assert [count for count, _ in drawn] == [3, 3, 1, 1]
    rim, free, other_rim, pinned = (color for _, color in drawn)
    assert rim == other_rim
    assert len({rim, free, pinned}) == 3
    overlay.show_overlays = False
    draw()
    overlay.show_overlays, wanted[0] = True, None
    draw()
    assert len(drawn) == 4
