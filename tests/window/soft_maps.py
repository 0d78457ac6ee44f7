# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""First steps with soft maps: click pairs on two animals, compute a map, transfer weights along it, and look at it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import bpy
from mathutils import Matrix, Vector

if TYPE_CHECKING:
    from inside import Window

# Places to click on both animals, as seen from the left.
_PLACES = ("nose", "tail", "front hoof", "hind hoof")


def soft_maps(window: Window) -> Iterator[float]:
    """Do everything in order; failures raise AssertionError."""
    yield from _begins(window)
    yield from _pairs(window)
    yield from _computes(window)
    yield from _transfers(window)
    yield from _looks(window)


def _begins(window: Window) -> Iterator[float]:
    yield from window.empty_scene()
    source = window.import_shape("horse")
    target = source.copy()
    target.data = source.data.copy()
    target.name = "Pony"
    bpy.context.collection.objects.link(target)
    # Another animal: shorter and stouter, with other vertices.
    for vertex in target.data.vertices:
        x, y, z = vertex.co
        vertex.co = (0.8 * x, 1.2 * y, 0.9 * z + 0.08 * x * x)
    with window.override():
        bpy.context.view_layer.objects.active = target
        decimate = target.modifiers.new("Fewer", "DECIMATE")
        decimate.ratio = 0.5
        bpy.ops.object.modifier_apply(modifier=decimate.name)
    source.location.x, target.location.x = -1.2, 1.2
    group = source.vertex_groups.new(name="Head")
    front = sorted(source.data.vertices, key=lambda vertex: vertex.co.x + vertex.co.z)[-300:]
    group.add([vertex.index for vertex in front], 1.0, "REPLACE")
    own = bpy.context.scene.convwass_soft_map
    own.source, own.target = source, target
    with window.override():
        bpy.ops.object.select_all(action="DESELECT")
        bpy.ops.view3d.view_axis(type="FRONT")
        bpy.ops.view3d.view_all()
    yield from window.open_tab("Convwass")
    yield from window.open_panel("CONVWASS_PT_soft_map")


def _pairs(window: Window) -> Iterator[float]:
    own = bpy.context.scene.convwass_soft_map
    yield from window.press("convwass.add_map_pair")
    for number, place in enumerate(_PLACES):
        for obj in (own.source, own.target):
            yield from window.click(*window.on_screen(_seen(obj, place)))
        if number == 0:
            yield from window.picture("20 first pair")
    yield from window.key("Escape")
    found = [(pair.source_vertex, pair.target_vertex) for pair in own.pairs]
    assert len(found) == len(_PLACES), f"clicking on both animals made the pairs {found}"
    yield from window.picture("21 pairs")
    window.say(f"{len(found)} pairs are clicked on two animals, and have numbers in the viewport")


def _computes(window: Window) -> Iterator[float]:
    yield from window.press("convwass.compute_soft_map")
    seen = set()

    def done():
        seen.add(round(window.progress.fraction, 3))
        return len(seen) > 1 and not window.progress.running

    yield from window.wait(done, 120, "the map is computed")
    window.say(f"a soft map is computed by a button: the bar showed {len(seen)} values")


def _transfers(window: Window) -> Iterator[float]:
    own = bpy.context.scene.convwass_soft_map
    yield from window.press("convwass.transfer_by_map")
    yield from window.wait(lambda: "Head" in own.target.vertex_groups, 30, "the weights arrive")
    yield 0.5
    index = own.target.vertex_groups["Head"].index
    heavy = [v.co.x for v in own.target.data.vertices if any(g.group == index and g.weight > 0.5 for g in v.groups)]
    assert heavy, "nothing of the head arrives"
    assert min(heavy) > 0.0, f"the head reaches to {min(heavy):.2f}"
    window.say(f"and carries the weights of the head to {len(heavy)} vertices of the other, by a button")


def _looks(window: Window) -> Iterator[float]:
    yield from window.press("convwass.show_soft_map")
    yield 1.0
    yield from window.picture("22 map")
    window.say("and colors show what belongs together")


def _seen(obj: bpy.types.Object, place: str) -> tuple[float, float, float]:
    """Return the center of a named part of an animal that faces +X, on the near side."""
    turned: Matrix = obj.matrix_world
    points = [turned @ vertex.co for vertex in obj.data.vertices]
    low, high = (Vector(tuple(pick(axis) for axis in zip(*points, strict=True))) for pick in (min, max))
    size = high - low
    wanted = {
        "nose": lambda p: p.x - 0.2 * p.z,
        "tail": lambda p: -p.x,
        "front hoof": lambda p: -p.z + 0.3 * p.x,
        "hind hoof": lambda p: -p.z - 0.3 * p.x,
    }[place]
    end = max(points, key=wanted)
    near = [p for p in points if (p - end).length < 0.06 * size.length]
    middle = sum(near, Vector()) / len(near)
    return middle.x, middle.y, middle.z
