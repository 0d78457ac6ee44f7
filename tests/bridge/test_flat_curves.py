# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves of flat frames are filled completely."""

from __future__ import annotations

import bpy
import numpy as np
import pytest

from convwass_addon.bridge.flat.flat_curves import write_curves
from convwass_addon.bridge.flat.flat_rings import CurveStyle
from convwass_addon.geometry.plane.fitting import BezierRing
from convwass_addon.geometry.plane.outlines import ring_area


def dumbbell(half_width, count, seed):
    """Two discs that are joined by a narrow neck of many short edges, counterclockwise."""
    noise = np.random.default_rng(seed).normal(size=(2, count))
    x = np.linspace(-0.1, 0.1, count)
    above = np.column_stack([x, half_width + 0.001 * noise[0]])
    below = np.column_stack([x[::-1], -half_width + 0.001 * noise[1]])
    angles = np.radians(np.linspace(160.0, -160.0, 24))
    right = np.column_stack([0.4 + 0.3 * np.cos(angles), 0.3 * np.sin(angles)])
    left = np.column_stack([-0.4 - 0.3 * np.cos(angles), -0.3 * np.sin(angles)])
    return np.concatenate([above, right, below, left])[::-1]


def straight(corners):
    """Return a ring of straight segments between corners."""
    after, before = np.roll(corners, -1, axis=0), np.roll(corners, 1, axis=0)
    left, right = corners + (before - corners) / 3.0, corners + (after - corners) / 3.0
    return BezierRing(corners, left, right, np.ones(len(corners), bool), 0.0)


def filled_area(curve):
    mesh = bpy.data.meshes.new_from_object(bpy.data.objects.new("curve", curve))
    return sum(face.area for face in mesh.polygons)


@pytest.mark.parametrize(
    "half_width, count, seed", [(0.004, 30, 186), (0.002, 8, 239), (0.01, 12, 305), (0.002, 8, 531)]
)
def test_shapes_with_narrow_necks_are_filled(half_width, count, seed):
    """With eight steps per segment, Blender leaves out one of the discs."""
    corners = dumbbell(half_width, count, seed)
    curve = bpy.data.curves.new("frame", "CURVE")
    write_curves(curve, [straight(corners)], CurveStyle(fill_mode="FRONT"))
    assert filled_area(curve) == pytest.approx(ring_area(corners), rel=0.005)


def test_checking_the_fill_leaves_nothing_behind():
    before = [len(kind) for kind in (bpy.data.curves, bpy.data.meshes, bpy.data.objects)]
    curve = bpy.data.curves.new("frame", "CURVE")
    write_curves(curve, [straight(dumbbell(0.05, 8, 0))], CurveStyle(extrude=0.2, bevel_depth=0.01))
    after = [len(kind) for kind in (bpy.data.curves, bpy.data.meshes, bpy.data.objects)]
    assert after == [before[0] + 1, *before[1:]]
    assert (curve.extrude, curve.fill_mode) == (pytest.approx(0.2), "BOTH")
