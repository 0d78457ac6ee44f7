# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""First steps with densities: paint two vertex groups with the mouse, move one density to the other, and play."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import bpy

if TYPE_CHECKING:
    from inside import Window

_ATTRIBUTE = "Density"


def densities(window: Window) -> Iterator[float]:
    """Do everything in order; failures raise AssertionError."""
    yield from _begins(window)
    yield from _paints(window)
    yield from _travels(window)
    yield from _plays(window)


def _begins(window: Window) -> Iterator[float]:
    yield from window.empty_scene()
    with window.override():
        bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=5)
        bpy.ops.object.shade_smooth()
        bpy.ops.view3d.view_axis(type="FRONT")
        bpy.ops.view3d.view_all()
    for name in ("Left", "Right"):
        bpy.context.object.vertex_groups.new(name=name)
    yield from window.open_tab("Convwass")


def _paints(window: Window) -> Iterator[float]:
    obj = bpy.context.object
    with window.override():
        bpy.ops.object.mode_set(mode="WEIGHT_PAINT")
    yield 2.0
    for index, side in enumerate((-0.55, 0.55)):
        obj.vertex_groups.active_index = index
        yield 0.5
        x, y = window.on_screen((side, -0.8, 0.2))
        yield from window.drag([(x, y), (x + 4, y + 30), (x - 4, y + 60)])
    weights = [_painted(obj, index) for index in range(2)]
    assert all(weights), f"painting with the mouse left no weight: {weights}"
    yield from window.open_panel("CONVWASS_PT_densities")
    yield from window.press("convwass.normalize_density")
    yield 1.0
    assert obj.convwass_density_findings.group == "Right", "normalizing found nothing out"
    yield from window.picture("10 painted")
    window.say(f"two groups are painted, of {weights[0]} and {weights[1]} vertices, and normalized by a button")


def _travels(window: Window) -> Iterator[float]:
    obj = bpy.context.object
    yield from window.press("convwass.interpolate_density")
    seen = set()

    def done():
        seen.add(round(window.progress.fraction, 3))
        return _ATTRIBUTE in _played(obj) and not window.progress.running

    yield from window.wait(done, 120, "the density arrives")
    window.say(f"a density travels from group to group by a button: the bar showed {len(seen)} values")


def _plays(window: Window) -> Iterator[float]:
    scene, obj = bpy.context.scene, bpy.context.object
    with window.override():
        bpy.ops.object.mode_set(mode="OBJECT")
    window.area.spaces.active.shading.type = "MATERIAL"
    centers = []
    for frame in (scene.frame_start, 13, scene.frame_start + 24):
        scene.frame_set(frame)
        yield 1.0
        centers.append(_center(obj))
        yield from window.picture(f"11 density at frame {frame}")
    assert centers[0] < -0.3 < centers[1] < 0.3 < centers[2], f"the density does not travel: {centers}"
    yield from window.into_view()
    frame = scene.frame_current
    yield from window.key("space")
    yield 2.0
    yield from window.key("space")
    assert scene.frame_current != frame, "pressing space plays nothing"
    window.say("and plays, from left to right")


def _painted(obj: bpy.types.Object, index: int) -> int:
    return sum(any(one.group == index and one.weight > 0 for one in vertex.groups) for vertex in obj.data.vertices)


def _played(obj: bpy.types.Object) -> list[str]:
    return [m.node_group.get("convwass_density") for m in obj.modifiers if m.type == "NODES" and m.node_group]


def _center(obj: bpy.types.Object) -> float:
    """Return the position of the density from left to right."""
    mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    values = [item.value for item in mesh.attributes[_ATTRIBUTE].data]
    total = sum(values)
    return sum(value * vertex.co.x for value, vertex in zip(values, mesh.vertices, strict=True)) / total
