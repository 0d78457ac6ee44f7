# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Blend materials and skies: create them with buttons, render them, cancel once, and make some mistakes."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import bpy

if TYPE_CHECKING:
    from inside import Window

_ROUGH = {"Chrome": 0.25, "Brass": 0.45, "Satin": 0.7}
_COLORS = {"Chrome": (0.9, 0.9, 0.9, 1), "Brass": (0.9, 0.5, 0.15, 1), "Satin": (0.2, 0.3, 0.9, 1)}


def light(window: Window) -> Iterator[float]:
    """Do everything in order; failures raise AssertionError."""
    yield from _begins(window)
    yield from _blends_two(window)
    yield from _looks(window)
    yield from _drags_on_a_pad(window)
    yield from _goes_wrong(window)
    yield from _bakes_skies(window)
    yield from _stops(window)


def _begins(window: Window) -> Iterator[float]:
    yield from window.empty_scene()
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.data.energy, sun.data.angle = 3.0, 0.0
    sun.rotation_euler = (math.radians(50.0), 0.0, math.radians(-30.0))
    bpy.context.collection.objects.link(sun)
    for name, roughness in _ROUGH.items():
        material = bpy.data.materials.new(name)
        node = next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
        node.inputs["Roughness"].default_value, node.inputs["Metallic"].default_value = roughness, 1.0
        node.inputs["Base Color"].default_value = _COLORS[name]
    own = bpy.context.scene.convwass_reflectance
    own.material, own.material_2 = bpy.data.materials["Chrome"], bpy.data.materials["Satin"]
    own.detail, own.blends = 24, 3
    yield from window.open_tab("Convwass")
    yield from window.open_panel("CONVWASS_PT_light")
    yield from window.picture("60 light")


def _blends_two(window: Window) -> Iterator[float]:
    yield from window.press("convwass.blend_materials")
    yield from _runs(window, 120, "the materials are blended")
    made = [material.name for material in bpy.data.materials if material.name.startswith("Blend")]
    assert made == ["Blend Chrome-Satin", "Blend Chrome-Satin fitted"], f"it made {made}"
    window.say(f"two materials are blended by a button: {', '.join(made)}")


def _looks(window: Window) -> Iterator[float]:
    """Put both next to the first one and render them in Cycles and in the other engine."""
    names = ("Chrome", "Blend Chrome-Satin", "Blend Chrome-Satin fitted", "Satin")
    for place, name in enumerate(names):
        with window.override():
            bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, location=(2.2 * place - 3.3, 0, 0))
            ball = bpy.context.object
            bpy.ops.object.shade_smooth()
        ball.data.materials.append(bpy.data.materials[name])
    with window.override():
        bpy.ops.object.select_all(action="SELECT")
        bpy.ops.view3d.view_axis(type="FRONT")
        bpy.ops.view3d.view_selected()
        bpy.ops.object.select_all(action="DESELECT")
    scene = bpy.context.scene
    scene.frame_set(30)
    # Without a graphics card, the other engine compiles its shaders slowly.
    for engine, picture, seconds in (("CYCLES", "61 cycles", 20.0), ("BLENDER_EEVEE", "62 eevee", 75.0)):
        scene.render.engine = engine
        scene.cycles.preview_samples = 16
        window.area.spaces.active.shading.use_scene_lights_render = True
        window.area.spaces.active.shading.type = "RENDERED"
        yield seconds
        yield from window.picture(picture)
    window.area.spaces.active.shading.type = "SOLID"
    yield 1.0
    window.say("there are pictures of the balls as Cycles and the other engine show them")


def _drags_on_a_pad(window: Window) -> Iterator[float]:
    scene = bpy.context.scene
    own = scene.convwass_reflectance
    own.material_3, own.blend, own.output = bpy.data.materials["Brass"], "PAD", "FITTED"
    scene.cursor.location = (0.0, 0.0, 2.8)
    yield from window.press("convwass.blend_materials")
    yield from _runs(window, 180, "the pad is made")
    handle = bpy.data.objects["Material Handle"]
    fitted = next(material for material in bpy.data.materials if material.name.endswith("on a pad fitted"))
    place = fitted.node_tree.nodes["Place on the Pad"].inputs["X"]
    bpy.data.objects["Sphere"].data.materials[0] = fitted
    with window.override():
        bpy.ops.object.select_all(action="SELECT")
        bpy.ops.view3d.view_selected()
        bpy.ops.object.select_all(action="DESELECT")
        handle.select_set(True)
        bpy.context.view_layer.objects.active = handle
    before = place.default_value
    at = window.on_screen(handle.matrix_world.translation)
    yield from window.move(*at)
    yield from window.key("g")
    yield from window.move(at[0] + 40, at[1] + 10)
    yield from window.click(at[0] + 60, at[1] + 20)
    yield 0.5
    assert place.default_value > before + 0.02, f"dragging the empty took it from {before} to {place.default_value}"
    yield from window.picture("63 pad")
    window.say(f"an empty is dragged on a pad, and drives the material from {before:.2f} to {place.default_value:.2f}")


def _goes_wrong(window: Window) -> Iterator[float]:
    """Blend incompatible materials: there is a message, and nothing changes."""
    own = bpy.context.scene.convwass_reflectance
    own.blend = "KEYED"
    before = len(bpy.data.materials)
    yield from window.press("convwass.blend_materials")
    yield 0.5
    yield from window.picture("64 no weight is keyed")
    assert len(bpy.data.materials) == before, "an error made a material"
    assert not window.progress.running, "an error left it running"
    window.say("weights without keys are refused in words")
    yield from window.into_view(0.2, 0.9)


def _bakes_skies(window: Window) -> Iterator[float]:
    own = bpy.context.scene.convwass_sky
    own.world, own.world_2 = _sky_world("Morning", 12.0, 200.0), _sky_world("Noon", 50.0, 290.0)
    own.width, own.frame_start, own.frame_end = 256, 1, 5
    own.folder = str(_folder(window))
    yield from window.open_panel("CONVWASS_PT_sky")
    yield from window.picture("65 sky")
    yield from window.press("convwass.blend_skies")
    yield from _runs(window, 180, "the skies are baked")
    names = sorted(path.name for path in _folder(window).iterdir())
    assert names == [f"sky.000{frame}.exr" for frame in range(1, 6)], f"it wrote {names}"
    bpy.context.scene.frame_set(3)
    bpy.context.scene.render.engine = "CYCLES"
    shading = window.area.spaces.active.shading
    shading.use_scene_world_render, shading.type = True, "RENDERED"
    with window.override():
        bpy.ops.view3d.view_axis(type="BACK")
        bpy.ops.view3d.view_persportho()
        bpy.ops.view3d.view_orbit(angle=0.25, type="ORBITUP")
    yield 40.0
    yield from window.picture("66 sky between")
    shading.type = "SOLID"
    window.say("five skies are baked by a button, and the world shows them")


def _stops(window: Window) -> Iterator[float]:
    """Cancel the next bake: the existing skies are unchanged."""
    own = bpy.context.scene.convwass_sky
    before = {path.name: path.stat().st_mtime_ns for path in _folder(window).iterdir()}
    own.frame_end, own.width = 400, 1024
    yield from window.press("convwass.blend_skies")
    yield from window.wait(
        lambda: window.progress.running and window.progress.fraction > 0.1, 120, "the next skies begin"
    )
    yield from window.picture("67 baking")
    yield from window.into_view()
    yield from window.key("Escape")
    yield from window.wait(lambda: not window.progress.running, 60, "it stops")
    after = {path.name: path.stat().st_mtime_ns for path in _folder(window).iterdir()}
    assert after == before, f"stopping left {sorted(after)}"
    yield from window.picture("68 stopped")
    window.say("stopped by Escape, with the skies of before untouched")


def _runs(window: Window, seconds: float, what: str) -> Iterator[float]:
    """Wait until a job has started, shown its progress, and ended."""
    seen = set()

    def done():
        seen.add((window.progress.running, round(window.progress.fraction, 3)))
        return len(seen) > 1 and not window.progress.running

    yield from window.wait(done, seconds, what)
    yield 0.5


def _folder(window: Window) -> Path:
    return window.pictures / "skies"


def _sky_world(name: str, elevation: float, rotation: float) -> bpy.types.World:
    world = bpy.data.worlds.new(name)
    tree = world.node_tree
    texture = tree.nodes.new("ShaderNodeTexSky")
    kinds = texture.bl_rna.properties["sky_type"].enum_items.keys()
    texture.sky_type = "MULTIPLE_SCATTERING" if "MULTIPLE_SCATTERING" in kinds else "NISHITA"
    texture.sun_elevation, texture.sun_rotation = math.radians(elevation), math.radians(rotation)
    background = next(node for node in tree.nodes if node.type == "BACKGROUND")
    tree.links.new(texture.outputs["Color"], background.inputs["Color"])
    return world
