# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What is drawn over 3D viewports: its handlers come and go, and its discs are round."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from mathutils import Vector

from convwass_addon.bridge import viewport_overlay
from convwass_addon.bridge.armatures.joint_dots import JointDots
from convwass_addon.bridge.soft_maps.pair_labels import PairLabels


def test_discs_are_filled_in_one_go(monkeypatch):
    made = []
    shader = SimpleNamespace(uniform_float=lambda name, value: None)
    monkeypatch.setattr(viewport_overlay.gpu.shader, "from_builtin", lambda name: shader, raising=False)
    monkeypatch.setattr(
        viewport_overlay,
        "batch_for_shader",
        lambda shader, kind, content, indices: (
            made.append((content["pos"], indices)) or SimpleNamespace(draw=lambda shader: None)
        ),
    )
    viewport_overlay.fill_discs([Vector((0, 0)), Vector((10, 0))], 2.0, (1, 1, 1, 1))
    ((points, triangles),) = made
    corners = np.array([points[corner] for triangle in triangles for corner in triangle]).reshape(-1, 3, 2)
    sides = corners[:, 1:] - corners[:, :1]
    area = 0.5 * np.abs(np.linalg.det(sides)).sum()
    assert area == pytest.approx(2 * np.pi * 4, rel=0.03)
    assert {point for triangle in triangles for point in triangle} == set(range(len(points)))


@pytest.mark.parametrize("kind", [JointDots, PairLabels])
def test_the_handler_comes_and_goes(kind, monkeypatch):
    handlers = []
    space = SimpleNamespace(
        draw_handler_add=lambda draw, *_: handlers.append(draw) or draw,
        draw_handler_remove=lambda draw, _: handlers.remove(draw),
    )
    monkeypatch.setattr(viewport_overlay, "bpy", SimpleNamespace(types=SimpleNamespace(SpaceView3D=space)))
    overlay = kind(lambda context: None)
    for _ in range(2):
        overlay.register()
        overlay.register()
        assert len(handlers) == 1
        overlay.unregister()
        overlay.unregister()
        assert handlers == []
