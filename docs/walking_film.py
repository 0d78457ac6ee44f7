# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Two textured characters that walk while one becomes the other, for docs/moving.py."""

from __future__ import annotations

import math
import sys
from pathlib import Path

import bpy
from characters import STANDING, character, dotted, striped, turn
from mathutils import Matrix

from convwass_addon.bridge.morphs.stored import frame_objects

# Unlike the add-on, the benchmarks are not installed.
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from benchmarks.bipeds import MAN, OGRE, biped

CYCLE = 24
"""Frames of two steps, and from one character to the next."""

_CELLS = 90
# Degrees: swing of the thighs, bend of the knees, swing of the arms, bend of the elbows, arms hanging.
_THIGH, _KNEE, _ARM, _ELBOW, _HANG = 30.0, 45.0, 28.0, 25.0, 22.0


def walking_frames() -> list[bpy.types.Object]:
    """Return the frames of a man who becomes an ogre and a man again, all walking."""
    man = character("Man", biped(MAN, STANDING, 5), striped)
    ogre = character("Ogre", biped(OGRE, STANDING, 6), dotted)
    for walker in (man, ogre):
        _walk(walker.rig)
    again = man.body.copy()
    again.name = "Man Again"
    bpy.context.scene.collection.objects.link(again)
    bpy.context.scene.frame_set(1)
    bpy.ops.convwass.bake_morph(
        inputs="Man,Ogre,Man Again", frames=CYCLE, resolution=_CELLS, follow="FOLLOW", looks="PATCHES"
    )
    morph = next(collection for collection in bpy.data.collections if collection.name.startswith("Morph"))
    return frame_objects(morph)


def _walk(rig: bpy.types.Object) -> None:
    """Key a walk in place, for two cycles."""
    for frame in range(1, 2 * CYCLE + 2):
        for bone in rig.pose.bones:
            bone.matrix_basis = Matrix()
        bpy.context.view_layer.update()
        phase = 2.0 * math.pi * (frame - 1) / CYCLE
        for side, away, ahead in (("R", 1.0, phase), ("L", -1.0, phase + math.pi)):
            turn(rig.pose.bones[f"thigh.{side}"], "X", -_THIGH * math.sin(ahead))
            turn(rig.pose.bones[f"shin.{side}"], "X", _KNEE * max(0.0, math.cos(ahead)))
            turn(rig.pose.bones[f"upper_arm.{side}"], "Y", away * _HANG)
            turn(rig.pose.bones[f"upper_arm.{side}"], "X", _ARM * math.sin(ahead))
            turn(rig.pose.bones[f"forearm.{side}"], "X", -_ELBOW)
        for bone in rig.pose.bones:
            bone.keyframe_insert("rotation_quaternion", frame=frame)
