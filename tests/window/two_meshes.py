# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A ring becomes a ball with the meshes of both: baked with the button, played, and moved by the slider of either."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import bpy

if TYPE_CHECKING:
    from inside import Window


def two_meshes(window: Window) -> Iterator[float]:
    """Do everything in order; failures raise AssertionError."""
    yield from window.empty_scene()
    with window.override():
        bpy.ops.mesh.primitive_torus_add()
        bpy.context.object.name = "Ring"
        bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=4)
        bpy.context.object.name = "Ball"
        bpy.ops.object.select_all(action="SELECT")
        bpy.ops.view3d.view_all()
    settings = bpy.context.scene.convwass_morph
    settings.resolution, settings.output, settings.two_meshes = 40, "SHAPE_KEYS", True
    # Sorted by name, the ball would be the first.
    settings.reverse = True
    yield from window.open_tab("Convwass")
    yield from window.press("convwass.bake_morph")
    yield from window.wait(lambda: "Ball Morph" in bpy.data.objects, 240, "both meshes are there")
    for frame, name in ((1, "Ring"), (20, "Ring"), (25, "Ball")):
        bpy.context.scene.frame_set(frame)
        assert _shown() == [f"{name} Morph"], f"frame {frame} shows {_shown()}"
        yield from window.picture(f"frame {frame}")
    window.say("one mesh closes its hole, and the other one replaces it")
    yield from window.into_view()
    yield from window.click(*window.on_screen((0.0, 0.0, 0.0)))
    assert bpy.context.view_layer.objects.active.name == "Ball Morph"
    yield from window.open_panel("CONVWASS_PT_one_mesh")
    yield from window.click_field('["Ball"]', 0.5)
    yield from window.key("ctrl+a", "0", "period", "5", "Return")
    yield 1.0
    assert abs(bpy.data.objects["Ring Morph"]["Ball"] - 0.5) < 0.01, bpy.data.objects["Ring Morph"]["Ball"]
    assert _shown() == ["Ring Morph"], _shown()
    yield from window.picture("moved by the slider")
    window.say("the slider of the second mesh moves both")


def _shown() -> list[str]:
    """Return the names of the meshes that are seen."""
    graph = bpy.context.evaluated_depsgraph_get()
    return [own.object.name for own in graph.object_instances if own.object.type == "MESH"]
