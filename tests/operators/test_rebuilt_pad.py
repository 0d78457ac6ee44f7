# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A pad after its morph was baked again."""

from __future__ import annotations

import bpy
import pytest

from convwass_addon.bridge.morphs.rebuilt_pad import rebuild_pad
from convwass_addon.bridge.morphs.stand_ins import shown_morph
from convwass_addon.bridge.morphs.stored import frame_objects, stored_inputs
from convwass_addon.errors import InputError


def triangle_pad():
    for x in (0.0, 3.0, 6.0):
        bpy.ops.mesh.primitive_cube_add(location=(x, 0, 0))
    bpy.ops.object.select_all(action="SELECT")
    options = {"layout": "TRIANGLE", "steps": 2, "output": "PLAYER", "between": "NEAREST"}
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", resolution=16, **options)
    return bpy.context.object


def test_a_handle_stays_at_its_blend_when_the_shapes_grow(empty_scene):
    handle = triangle_pad()
    morph, corner = shown_morph(handle), handle.parent.data.vertices[1].co.copy()
    for frame, place in ((1, (0.0, 0.0, 0.0)), (9, corner)):
        handle.location = place
        handle.keyframe_insert("location", frame=frame)
    handle.parent.location.x += 10.0
    for obj in stored_inputs(morph):
        obj.scale *= 2.0
    before = handle.parent.location.copy()
    assert bpy.ops.convwass.rebake_morph() == {"FINISHED"}
    bpy.context.scene.frame_set(9)
    again = bpy.context.object
    assert again.location[:] == pytest.approx(again.parent.data.vertices[1].co)
    assert again.location[:] == pytest.approx(2.0 * corner, rel=0.1)
    # Twice as large, the pad is made farther away from the shapes.
    assert again.parent.location.x - 10.0 == pytest.approx(2.0 * (before.x - 10.0), rel=0.1)


def test_what_is_no_sheet_leaves_the_pad(empty_scene):
    handle = triangle_pad()
    morph = shown_morph(handle)
    bpy.data.objects.remove(frame_objects(morph)[-1])
    with pytest.raises(InputError, match="not a complete sheet"):
        rebuild_pad(morph)
    assert shown_morph(handle) == morph
