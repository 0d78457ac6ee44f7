# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Painted meshes for the tests of densities."""

from __future__ import annotations

import bpy
import numpy as np
import pytest

from convwass_addon.bridge.element_values import element_values
from convwass_addon.bridge.vertex_groups import read_group, write_group
from tests.linked_objects import linked_to_new_file


def ball(location=(0, 0, 0), radius=1.0):
    """Add a sphere of 266 vertices with the groups A and B, caps around its ends along X."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=24, ring_count=12, location=location, radius=radius)
    obj = bpy.context.object
    points = positions(obj) / radius
    write_group(obj, "A", (points[:, 0] > 0.8).astype(float))
    write_group(obj, "B", (points[:, 0] < -0.8).astype(float))
    obj.vertex_groups.active_index = 0
    return obj


def two_balls():
    """Add two spheres that are one mesh; A is on the first one, B on the second, Both on both."""
    first = ball()
    ball(location=(5, 0, 0))
    first.select_set(True)
    bpy.context.view_layer.objects.active = first
    bpy.ops.object.join()
    on_first = positions(first)[:, 0] < 2
    for name, place in (("A", on_first), ("B", ~on_first)):
        write_group(first, name, read_group(first, name) * place)
    write_group(first, "Both", np.where(on_first, 1.0, 0.5))
    return first


def positions(obj):
    return element_values(obj.data.vertices, "co", 3).astype(np.float64)


def center(obj, weights):
    """Return the mean place of weights."""
    return weights @ positions(obj) / weights.sum()


def linked(tmp_path):
    """Save a painted ball and link it into an empty file."""
    obj = linked_to_new_file(ball().name, tmp_path)
    bpy.context.view_layer.objects.active = obj
    return obj


def curve(obj):
    """Return the keys of an object's only channel: (frame, value, interpolation)."""
    from bpy_extras.anim_utils import action_get_channelbag_for_slot

    data = obj.animation_data
    (only,) = action_get_channelbag_for_slot(data.action, data.action_slot).fcurves
    return [(key.co[0], pytest.approx(key.co[1], abs=1e-6), key.interpolation) for key in only.keyframe_points]
