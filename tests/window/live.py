# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Live morphs: drag a handle that a shape follows, edit, save, undo and render meanwhile, and end them."""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Iterator
from typing import TYPE_CHECKING

import bpy
from mathutils.bvhtree import BVHTree

if TYPE_CHECKING:
    from inside import Window

Surface = tuple[list[tuple[float, ...]], BVHTree]
"""Vertices, and what finds closest points."""

# Positions of the handle for pictures.
_PLACES = (0.0, 0.25, 0.5, 0.75, 1.0)
# Seconds for measuring the frame rate.
_MEASURED = 6.0
# It goes on until there are so many, or for so many seconds.
_FEW, _PATIENCE = 5, 90.0


def live(window: Window) -> Iterator[float]:
    """Do everything in order; failures raise AssertionError."""
    yield from _follows_the_mouse(window)
    yield from _keeps_up(window)
    yield from _is_solved_at_rest(window)
    yield from _follows_a_transform(window)
    yield from _survives_a_render(window)
    yield from _is_alone(window)
    yield from _leaves_no_trace(window)
    yield from _ends_when_it_is_undone(window)
    yield from _follows_an_edit(window)
    yield from _is_not_saved(window)
    yield from _freezes_without_an_input(window)
    yield from _blends_three(window)


def _follows_the_mouse(window: Window) -> Iterator[float]:
    yield from _new_scene(window)
    for name, color in (("horse", (0.6, 0.25, 0.1, 1.0)), ("bird", (0.1, 0.35, 0.7, 1.0))):
        bpy.data.objects[name].color = color
    window.area.spaces.active.shading.color_type = "VERTEX"
    yield from window.press("convwass.live_morph")
    began = time.monotonic()
    yield from window.wait(_is_shown, 60, "a blend is shown")
    window.say(f"the first blend is seen {time.monotonic() - began:.2f} s after the click has been taken in")
    yield from _seen_from_the_front(window)
    for number, place in enumerate(_PLACES, start=1):
        handle = bpy.data.objects["Live Handle"]
        side = bpy.data.objects["Live Pad"].dimensions.x
        start, middle = handle.matrix_world.translation, bpy.data.objects["Live Pad"].location
        end = (middle.x + (place - 0.5) * side, middle.y, middle.z)
        sizes = _size()
        yield from window.drag([window.on_screen(start), window.on_screen(end)])
        yield 0.5
        assert abs(_value().morph - place) < 0.02, f"the handle is at {_value().morph:.2f}, not at {place}"
        assert number == 3 or _size() != sizes, "the shape does not follow the mouse"
        yield from window.picture(f"live {number}")
    window.say("the shape follows the handle under the mouse")


def _keeps_up(window: Window) -> Iterator[float]:
    """Change the value continuously and count how often Blender shows another mesh."""
    seen, changes = None, 0
    begun, used = time.monotonic(), time.process_time()
    # A busy machine draws few of them.
    while (passed := time.monotonic() - begun) < _MEASURED or (changes < _FEW and passed < _PATIENCE):
        _value().morph = 0.5 + 0.45 * math.sin(3.0 * (time.monotonic() - begun))
        yield 0.01
        now = _signature()
        changes, seen = changes + (now != seen), now
    used = time.process_time() - used
    window.say(f"{changes / passed:.1f} blends a second, drawn by software; {used / passed:.1f} processors at work")
    assert changes >= _FEW, "the shape does not follow the value"


def _is_solved_at_rest(window: Window) -> Iterator[float]:
    """Compare what is shown in motion with what is shown at rest, once the lattice is filled."""
    yield from window.wait(lambda: str(_session().message) == "Ready", 240, "the lattice is filled")
    cell = 2.0 / bpy.context.scene.convwass_live.live_resolution
    distances = []
    for place in (0.17, 0.38, 0.71):
        _value().morph = place
        yield 0.1
        moving = _surface()
        yield from window.wait(lambda: _session().is_solved, 60, "the blend is solved")
        yield 0.5
        distances.append(_distance(moving, _surface()) / cell)
    window.say("cells from the shape in motion to the solved one: " + ", ".join(f"{one:.3f}" for one in distances))
    assert max(distances) < 0.3, "the shape in motion is not the one at rest"


def _follows_a_transform(window: Window) -> Iterator[float]:
    """Use Blender's transform operator, which consumes all events meanwhile."""
    yield from window.into_view()
    _value().morph = 0.5
    yield 0.5
    before = _value().morph
    handle = bpy.data.objects["Live Handle"]
    for obj in bpy.context.selected_objects:
        obj.select_set(False)
    handle.select_set(True)
    bpy.context.view_layer.objects.active = handle
    x, y = window.on_screen(handle.matrix_world.translation)
    yield from window.move(x, y - 60)
    yield from window.key("g")
    for step in range(1, 5):
        yield from window.move(x + 20 * step, y - 60)
    middle = _size()
    yield from window.click(x + 80, y - 60)
    yield 0.5
    assert _value().morph > before + 0.02, "G does not move the handle"
    assert middle != 0
    window.say("the shape follows G as well")


def _survives_a_render(window: Window) -> Iterator[float]:
    scene = bpy.context.scene
    scene.render.engine, scene.render.resolution_x, scene.render.resolution_y = "BLENDER_WORKBENCH", 64, 64
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(camera)
    scene.camera = camera
    with window.override():
        bpy.ops.render.render("INVOKE_DEFAULT")
    yield from window.wait(lambda: not bpy.app.is_job_running("RENDER"), 60, "the render ends")
    yield 1.0
    before = _size()
    _value().morph = 0.2
    yield 0.7
    assert _size() != before, "after a render the shape follows no longer"
    for area in bpy.context.window_manager.windows[0].screen.areas:
        if area.type == "IMAGE_EDITOR":
            area.type = "VIEW_3D"
    for other in bpy.context.window_manager.windows[1:]:
        with bpy.context.temp_override(window=other):
            bpy.ops.wm.window_close()
    bpy.data.objects.remove(camera)
    window.say("a render does no harm")


def _is_alone(window: Window) -> Iterator[float]:
    """A second live morph has to wait for the end of the first."""
    with window.override():
        assert not bpy.ops.convwass.live_morph.poll(), "two live morphs run at once"
    yield 0.1
    window.say("a second live morph is refused")


def _leaves_no_trace(window: Window) -> Iterator[float]:
    yield from window.into_view()
    yield from window.key("Escape")
    yield from window.wait(lambda: "Live Morph" not in bpy.data.objects, 10, "Escape ends it")
    assert sorted(obj.name for obj in bpy.data.objects) == ["bird", "horse"]
    assert all(obj.visible_get() for obj in bpy.data.objects), "shapes stay hidden"
    assert not [c for c in bpy.data.collections if c.name.startswith("Live")]
    window.say("Escape leaves no trace")


def _ends_when_it_is_undone(window: Window) -> Iterator[float]:
    yield from _new_scene(window)
    bpy.ops.ed.undo_push(message="before")
    yield from window.press("convwass.live_morph")
    yield from window.wait(_is_shown, 60, "a blend is shown")
    yield from window.into_view()
    yield from window.key("ctrl+z")
    yield 2.0
    yield from window.key("Escape")
    yield 1.0
    assert not any(obj.name.startswith("Live") for obj in bpy.data.objects), "undo leaves parts of a live morph"
    assert all(obj.visible_get() for obj in bpy.data.objects), "undo leaves shapes hidden"
    window.say("undo while it is live harms nothing")


def _follows_an_edit(window: Window) -> Iterator[float]:
    """Enlarge a shape in Edit Mode while it is live."""
    yield from _new_scene(window)
    yield from window.press("convwass.live_morph")
    yield from window.wait(_is_shown, 60, "a blend is shown")
    # Shapes are in the order of their names.
    _value().morph = 1.0
    yield 1.0
    before = _height()
    horse = bpy.data.objects["horse"]
    horse.hide_set(False)
    with window.override():
        bpy.context.view_layer.objects.active = horse
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="SELECT")
        bpy.ops.transform.resize(value=(1.0, 1.0, 1.5))
    yield 0.5
    with window.override():
        bpy.ops.object.mode_set(mode="OBJECT")
    yield from window.wait(lambda: _height() > 1.4 * before, 60, "the shape is blended anew")
    window.say("an edited shape is blended anew")


def _is_not_saved(window: Window) -> Iterator[float]:
    """Save while it is live, and open the file."""
    path = str(window.pictures / "live.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    yield 0.5
    assert bpy.data.objects["bird"].hide_get() and "Live Morph" in bpy.data.objects, "saving ends it"
    bpy.ops.wm.open_mainfile(filepath=path)
    yield 2.0
    assert sorted(obj.name for obj in bpy.data.objects) == ["bird", "horse"], "the file has parts of a live morph"
    assert all(obj.visible_get() for obj in bpy.data.objects), "shapes are hidden in the file"
    assert _session() is None, "it runs on in another file"
    window.say("a saved file has only the shapes")


def _freezes_without_an_input(window: Window) -> Iterator[float]:
    yield from _new_scene(window)
    yield from window.press("convwass.live_morph")
    yield from window.wait(_is_shown, 60, "a blend is shown")
    yield from window.wait(lambda: str(_session().message) == "Ready", 240, "the lattice is filled")
    bpy.data.objects.remove(bpy.data.objects["bird"])
    yield from window.wait(lambda: _session().is_frozen, 20, "it freezes")
    before = _size()
    _value().morph = 0.21
    yield 0.7
    assert _size() != before, "a frozen shape does not follow the handle"
    yield from window.picture("live frozen")
    yield from window.into_view()
    yield from window.key("Escape")
    yield 1.0
    assert [obj.name for obj in bpy.data.objects] == ["horse"] and bpy.data.objects["horse"].visible_get()
    window.say("without an input it freezes, and can still be dragged")


def _blends_three(window: Window) -> Iterator[float]:
    yield from _new_scene(window, ("horse", "bird", "cow"))
    yield from window.press("convwass.live_morph")
    yield from window.wait(_is_shown, 60, "a blend is shown")
    yield from _seen_from_the_front(window)
    yield 8.0
    handle = bpy.data.objects["Live Handle"]
    x, y = window.on_screen(handle.matrix_world.translation)
    yield from window.drag([(x, y), (x + 30, y + 20)])
    yield from window.picture("live three")
    assert _value().across > 0.51, "the handle of the triangle cannot be dragged"
    yield from window.press("convwass.keep_live_shape")
    yield from window.wait(lambda: "Blend" in bpy.data.objects, 60, "a shape is kept")
    yield from window.into_view()
    yield from window.key("Escape")
    yield 1.0
    assert sorted(obj.name for obj in bpy.data.objects) == ["Blend", "bird", "cow", "horse"]
    window.say("three shapes on a triangle, one of them kept")


def _new_scene(window: Window, names: tuple[str, ...] = ("horse", "bird")) -> Iterator[float]:
    """Start with some sample shapes of equal size side by side, all selected."""
    yield from window.empty_scene()
    for place, name in enumerate(names):
        obj = window.import_shape(name)
        obj.scale = [2.0 / max(obj.dimensions)] * 3
        obj.location.x = 2.5 * place
    with window.override():
        bpy.ops.object.select_all(action="SELECT")
        bpy.ops.view3d.view_all()
    settings = bpy.context.scene.convwass_morph
    settings.motion = "TRANSPORT"
    yield from window.open_tab("Convwass")


def _seen_from_the_front(window: Window) -> Iterator[float]:
    with window.override():
        bpy.ops.view3d.view_axis(type="FRONT")
        bpy.ops.view3d.view_all()
    yield 2.0


def _value() -> bpy.types.PropertyGroup:
    return bpy.context.window_manager.convwass_live


def _is_shown() -> bool:
    return "Live Morph" in bpy.data.objects and _size() > 0


def _signature() -> tuple[float, ...]:
    mesh = bpy.data.objects["Live Morph"].data
    return (len(mesh.vertices), *mesh.vertices[0].co, *mesh.vertices[len(mesh.vertices) // 2].co)


def _size() -> int:
    return len(bpy.data.objects["Live Morph"].data.vertices)


def _session() -> object:
    """Return the live morph that is running."""
    name = next(name for name in sys.modules if name.endswith("convwass_addon.bridge.live.running"))
    return sys.modules[name].running_live()


def _surface() -> Surface:
    mesh = bpy.data.objects["Live Morph"].data
    mesh.calc_loop_triangles()
    points = [tuple(vertex.co) for vertex in mesh.vertices]
    return points, BVHTree.FromPolygons(points, [tuple(own.vertices) for own in mesh.loop_triangles])


def _distance(one: Surface, other: Surface) -> float:
    """Return the mean distance of the points of one surface from another."""
    return sum(other[1].find_nearest(point)[3] for point in one[0]) / len(one[0])


def _height() -> float:
    heights = [vertex.co.z for vertex in bpy.data.objects["Live Morph"].data.vertices]
    return max(heights) - min(heights) if heights else 0.0
