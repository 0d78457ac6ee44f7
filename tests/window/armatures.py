# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""First steps with armatures: click the ends of an octopus' arms, and fit bones into it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import bpy
from mathutils import Vector

if TYPE_CHECKING:
    from inside import Window

# Number of bones per arm, and of rigged arms.
_BONES, _ARMS = 3, 5


def armatures(window: Window) -> Iterator[float]:
    """Do everything in order; failures raise AssertionError."""
    yield from window.empty_scene()
    body = window.import_shape("octopus")
    with window.override():
        bpy.ops.view3d.view_axis(type="TOP")
        bpy.ops.view3d.view_all()
    tips = _tips(body)
    assert len(tips) == _ARMS, f"{len(tips)} arms can be seen from above"
    rig = _rig(tips)
    own = bpy.context.scene.convwass_armature
    own.body, own.rig = body, rig
    yield from window.open_tab("Convwass")
    yield from window.open_panel("CONVWASS_PT_armature")
    yield from _places(window, rig, tips)
    yield from _fits(window, body, rig)


def _places(window: Window, rig: bpy.types.Object, tips: list[Vector]) -> Iterator[float]:
    with window.override():
        bpy.context.view_layer.objects.active = rig
        bpy.ops.object.mode_set(mode="EDIT")
    yield 1.0
    for bone in rig.data.edit_bones:
        bone.select = bone.select_head = False
        bone.select_tail = bone.name.endswith(f".{_BONES}")
    yield from window.press("convwass.place_joint")
    for tip in tips:
        yield from window.click(*window.on_screen(tuple(tip)))
    yield 0.5
    places = [rig.data.edit_bones[f"arm{arm}.{_BONES}"].tail for arm in range(_ARMS)]
    far = max((Vector(place.xy) - tip.xy).length for place, tip in zip(places, tips, strict=True))
    assert far < 0.15, f"a joint is {far:.2f} from where it was clicked"
    yield from window.picture("30 placed joints")
    window.say(f"{_ARMS} joints go behind {_ARMS} clicks on the body, and are pinned")


def _fits(window: Window, body: bpy.types.Object, rig: bpy.types.Object) -> Iterator[float]:
    before = [bone.head.copy() for bone in rig.data.edit_bones]
    yield from window.press("convwass.fit_armature")
    yield from window.wait(lambda: not window.progress.running and _moved(rig, before), 120, "the armature is fitted")
    yield 0.5
    with window.override():
        bpy.ops.object.mode_set(mode="OBJECT")
        bpy.ops.view3d.view_axis(type="FRONT")
    outside = [bone.name for bone in rig.data.bones if not _is_inside(body, bone.tail_local)]
    assert not outside, f"these bones end outside: {outside}"
    yield from window.picture("31 fitted")
    window.say(f"a button lays out the other joints of {len(rig.data.bones)} bones inside")
    yield from window.key("ctrl+z")


def _tips(body: bpy.types.Object) -> list[Vector]:
    """Return the ends of arms that can be clicked from above."""
    points = [vertex.co.copy() for vertex in body.data.vertices]
    middle = sum(points, Vector()) / len(points)
    left, found = points, []
    while left and len(found) < _ARMS:
        tip = max(left, key=lambda p: (p - middle).xy.length)
        angle = math.atan2(*(tip - middle).xy)
        left = [p for p in left if abs(math.remainder(math.atan2(*(p - middle).xy) - angle, math.tau)) > 0.35]
        inward = tip + 0.03 * Vector((*(middle - tip).xy.normalized(), 0.0))
        is_hit, place, _, _ = body.ray_cast(Vector((*inward.xy, 10.0)), Vector((0.0, 0.0, -1.0)))
        if is_hit and (place - tip).length < 0.15:
            found.append(place)
    return found


def _rig(tips: list[Vector]) -> bpy.types.Object:
    """Return straight arms that leave the body."""
    rig = bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig"))
    bpy.context.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    head = rig.data.edit_bones.new("head")
    head.head, head.tail = (0.0, 0.0, 0.5), (0.0, 0.0, 0.9)
    for arm, tip in enumerate(tips):
        way = Vector((*tip.xy.normalized(), 0.0))
        before = head
        for number in range(1, _BONES + 1):
            bone = rig.data.edit_bones.new(f"arm{arm}.{number}")
            bone.head = Vector((0.0, 0.0, 0.5)) + 0.4 * (number - 1) * way
            bone.tail = bone.head + 0.4 * way
            bone.parent, bone.use_connect = before, number > 1
            before = bone
    bpy.ops.object.mode_set(mode="OBJECT")
    return rig


def _moved(rig: bpy.types.Object, before: list[Vector]) -> bool:
    bones = rig.data.edit_bones if rig.mode == "EDIT" else rig.data.bones
    heads = [bone.head if rig.mode == "EDIT" else bone.head_local for bone in bones]
    return any((now - then).length > 1e-3 for now, then in zip(heads, before, strict=True))


def _is_inside(body: bpy.types.Object, point: Vector) -> bool:
    is_found, place, normal, _ = body.closest_point_on_mesh(point)
    return is_found and (point - place).dot(normal) < 0.0
