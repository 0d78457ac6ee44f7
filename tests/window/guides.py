# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Guides of a morph between a straight and a bent arm: set Motion to Guided, click two guides, bake, and look."""

from __future__ import annotations

import json
from collections.abc import Iterator
from math import cos, pi, sin
from typing import TYPE_CHECKING

import bpy
from mathutils import Vector

if TYPE_CHECKING:
    from inside import Window

_NAMES = ("Arm", "Bent Arm")
_AROUND, _ALONG, _RADIUS = 16, 40, 0.3
# Length of the arm along its center line, and of the elbow.
_LENGTH, _ELBOW = 4.0, 1.2


def guides(window: Window) -> Iterator[float]:
    """Do everything in order; failures raise AssertionError."""
    yield from _begins(window)
    yield from _sets_the_motion(window)
    yield from _clicks(window)
    yield from _bakes(window)
    yield from _takes_them_back(window)


def _begins(window: Window) -> Iterator[float]:
    yield from window.empty_scene()
    for name, angle, height in zip(_NAMES, (0.0, pi / 2), (1.5, -1.5), strict=True):
        obj = bpy.data.objects.new(name, _arm(name, angle))
        obj.location.z = height
        bpy.context.scene.collection.objects.link(obj)
        obj.select_set(True)
    own = bpy.context.scene.convwass_morph
    own.frames, own.resolution = 4, 48
    with window.override():
        bpy.ops.view3d.view_axis(type="FRONT")
        bpy.ops.view3d.view_all()
    yield from window.open_tab("Convwass")


def _sets_the_motion(window: Window) -> Iterator[float]:
    yield from window.click_field("convwass_morph.motion", across=0.65)
    yield from window.picture("30 motions")
    yield from window.key("g")
    assert bpy.context.scene.convwass_morph.motion == "GUIDED", bpy.context.scene.convwass_morph.motion
    window.say("Motion is set to Guided")


def _clicks(window: Window) -> Iterator[float]:
    # Called directly: the button is in a nested panel, whose header open_panel does not find.
    with window.override():
        bpy.ops.convwass.add_morph_guide("INVOKE_DEFAULT")
    shapes = [bpy.data.objects[name] for name in _NAMES]
    # In another order the second time.
    for ring, order in ((2, shapes), (_ALONG - 3, shapes[::-1])):
        for obj in order:
            yield from window.click(*window.on_screen(_seen(obj, ring)))
    yield from window.click(*window.on_screen((_LENGTH, 0.0, 3.5)))
    yield from window.picture("31 guides")
    yield from window.key("Escape")
    found = [dict(guide.points) for guide in bpy.context.scene.convwass_guides.named]
    assert [sorted(points) for points in found] == [sorted(_NAMES)] * 2, f"clicking on both arms made {found}"
    for points, ring in zip(found, (2, _ALONG - 3), strict=True):
        for name, vertex in points.items():
            at = bpy.data.objects[name].matrix_world @ bpy.data.objects[name].data.vertices[vertex].co
            away = (at - _seen(bpy.data.objects[name], ring)).length
            assert away < 0.2, f"vertex {vertex} of {name} is {away:.2f} from where it was clicked on"
    window.say("two guides are clicked on two arms; a click on nothing adds none")


def _bakes(window: Window) -> Iterator[float]:
    chosen = [dict(guide.points) for guide in bpy.context.scene.convwass_guides.named]
    for obj in bpy.data.objects:
        obj.select_set(True)
    yield from window.press("convwass.bake_morph")
    yield from window.wait(lambda: bool(window.morphs) and not window.progress.running, 240, "the bake ends")
    (morph,) = window.morphs
    stored = json.loads(morph["convwass_morph"])["settings"]
    assert stored["motion"] == "guided", stored["motion"]
    assert [guide["points"] for guide in stored["guides"]] == chosen, f"{stored['guides']} are stored"
    bpy.context.scene.frame_set(json.loads(morph["convwass_morph"])["first_frame"] + 2)
    middle = sorted(morph.objects, key=lambda obj: obj["convwass_index"])[2]
    straight = _reach(bpy.data.objects[_NAMES[0]])
    share = _reach(middle) / straight
    yield from window.picture("32 swung halfway")
    # Bent by 45 degrees, an arm reaches 0.95 times as far as a straight one; along straight lines, 0.85 times.
    assert share > 0.91, f"halfway the arm reaches {share:.2f} of its length"
    window.say(f"the bake keeps the guides, and halfway the arm reaches {share:.2f} of its length")


def _takes_them_back(window: Window) -> Iterator[float]:
    bpy.ops.convwass.clear_morph_guides()
    yield from window.press("convwass.select_morph_inputs")
    assert len(bpy.context.scene.convwass_guides.named) == 2, "the guides of the morph do not come back"
    window.say("the inputs are selected again, and the guides are on the list")


def _arm(name: str, angle: float) -> bpy.types.Mesh:
    """Return a closed tube along X whose second half is bent upwards by an angle."""
    place, points, heading = Vector(), [], 0.0
    step = _LENGTH / (_ALONG - 1)
    for ring in range(_ALONG):
        if ring:
            place += step * Vector((cos(heading), 0.0, sin(heading)))
        share = (ring * step - 0.5 * (_LENGTH - _ELBOW)) / _ELBOW
        heading = angle * min(max(share, 0.0), 1.0)
        up = Vector((-sin(heading), 0.0, cos(heading)))
        turns = (2 * pi * number / _AROUND for number in range(_AROUND))
        points += [place + _RADIUS * (cos(turn) * up + sin(turn) * Vector((0.0, 1.0, 0.0))) for turn in turns]
    faces = [
        (first + a, first + a + _AROUND, first + b + _AROUND, first + b)
        for first in range(0, len(points) - _AROUND, _AROUND)
        for a, b in ((number, (number + 1) % _AROUND) for number in range(_AROUND))
    ]
    faces += [tuple(range(_AROUND)), tuple(reversed(range(len(points) - _AROUND, len(points))))]
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(points, [], faces)
    return mesh


def _seen(obj: bpy.types.Object, ring: int) -> Vector:
    """Return a point of an arm's ring, central in the front view."""
    return obj.matrix_world @ obj.data.vertices[ring * _AROUND + 3 * _AROUND // 4].co


def _reach(obj: bpy.types.Object) -> float:
    """Return the largest distance between two points."""
    points = [vertex.co for vertex in obj.data.vertices][::5]
    return max((a - b).length for a in points for b in points)
