# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Take the pictures of docs/walkthrough.md: the same steps in the same order, cropped to the subject of the text.

python3 run.py window --blender PATH --only walkthrough

They are saved in a folder ``walkthrough`` next to the other pictures; copy them from there to docs/pictures.
"""

from __future__ import annotations

import subprocess
from collections.abc import Iterator
from math import radians
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

import bpy
from mathutils import Euler, Vector

if TYPE_CHECKING:
    from inside import Window

_PROJECT = Path(__file__).resolve().parents[2]
# Letters are readable at the size at which pages show the pictures.
_UI_SCALE = 1.25
_WIDTH, _QUALITY = 1000, 80
# Seconds for compiling materials for the viewport without a graphics card.
_SHADERS = 15.0
_COLORS = {
    "horse": (0.75, 0.22, 0.1),
    "bird": (0.1, 0.3, 0.75),
    "double_torus": (0.8, 0.5, 0.1),
    "cow": (0.85, 0.75, 0.6),
}


def walkthrough(window: Window) -> Iterator[float]:
    """Take all pictures in order; failures raise AssertionError."""
    view, system = bpy.context.preferences.view, bpy.context.preferences.system
    before, view.ui_scale, view.smooth_view = view.ui_scale, _UI_SCALE, 0
    # Nothing should be hidden by the sidebar.
    system.use_region_overlap = False
    (window.pictures / "walkthrough").mkdir(exist_ok=True)
    yield 1.0
    for stage in (_extension, _live, _morph, _pad, _flat, _densities, _soft_map, _armature, _recolor, _light):
        yield from stage(window)
    view.ui_scale, system.use_region_overlap = before, True
    window.say("the walk-through has its pictures")


def _extension(window: Window) -> Iterator[float]:
    area = window.area
    area.type = "PREFERENCES"
    bpy.context.preferences.active_section = "EXTENSIONS"
    bpy.context.window_manager.extension_search = "convwass"
    yield 4.0
    # There is nothing below.
    yield from _shot(window, "extension", area, share=0.42)
    area.type = "VIEW_3D"
    yield 1.0


def _live(window: Window) -> Iterator[float]:
    import live

    yield from _begin(window)
    shapes = [_shape(window, name, 3.0 * place) for place, name in enumerate(("horse", "cow"))]
    yield from _look_at(window, shapes)
    yield from window.open_tab("Convwass")
    yield from window.press("convwass.live_morph")
    yield from window.wait(live._is_shown, 60, "a blend is shown")
    yield from live._seen_from_the_front(window)
    live._value().morph = 0.35
    yield from window.wait(lambda: str(live._session().message) == "Ready", 300, "the blends are ready")
    yield from window.into_view()
    yield from _shot(window, "live")
    yield from window.key("Escape")
    yield 1.0


def _morph(window: Window) -> Iterator[float]:
    yield from _begin(window)
    shapes = [_shape(window, name, 3.0 * place) for place, name in enumerate(("horse", "bird"))]
    yield from _look_at(window, shapes)
    settings = bpy.context.scene.convwass_morph
    settings.resolution, settings.frames = 80, 24
    settings.scaling, settings.reverse = "EQUAL_VOLUME", True
    yield from window.open_tab("Convwass")
    yield from _shot(window, "select")
    # In the middle, where previews differ from both shapes.
    bpy.context.scene.frame_set(13)
    yield from window.press("convwass.bake_morph")
    yield from window.wait(
        lambda: window.progress.fraction > 0.7 or not window.progress.running, 300, "the bake gets on"
    )
    yield from window.into_view()
    yield from _shot(window, "baking")
    yield from window.wait(lambda: window.morphs and not window.progress.running, 600, "the bake ends")
    bpy.context.scene.frame_set(13)
    yield from window.open_panel("CONVWASS_PT_baked_morph")
    yield from _shot(window, "baked", has_timeline=True)
    with window.override():
        bpy.ops.convwass.make_player()
    yield 1.5
    yield from _shot(window, "player")


def _pad(window: Window) -> Iterator[float]:
    yield from _begin(window)
    shapes = [_shape(window, name, 2.4 * place) for place, name in enumerate(("horse", "bird", "double_torus"))]
    yield from _look_at(window, shapes)
    settings = bpy.context.scene.convwass_morph
    settings.layout, settings.steps, settings.resolution = "TRIANGLE", 5, 88
    with window.override():
        bpy.ops.convwass.bake_morph(layout="TRIANGLE", steps=5, resolution=88, scaling="EQUAL_VOLUME")
        bpy.ops.convwass.make_blend_pad()
        bpy.ops.view3d.view_axis(type="FRONT")
        bpy.ops.view3d.view_all()
    window.area.spaces.active.region_3d.view_distance *= 0.65
    yield from window.open_tab("Convwass")
    empty = next(obj for obj in bpy.data.objects if obj.type == "EMPTY")
    _select(empty)
    yield 2.0
    x, y = window.on_screen(empty.matrix_world.translation)
    yield from window.move(x, y)
    yield from window.key("g")
    for step in range(1, 5):
        yield from window.move(x + 12 * step, y - 8 * step)
    yield from window.click(x + 48, y - 32)
    yield 1.0
    yield from _shot(window, "pad")


def _flat(window: Window) -> Iterator[float]:
    yield from _begin(window)
    words = []
    for place, letter in enumerate("AB"):
        curve = bpy.data.curves.new(letter, "FONT")
        curve.body, curve.size, curve.extrude = letter, 2.0, 0.05
        words.append(bpy.data.objects.new(letter, curve))
        words[-1].location = (1.8 * place, 0.0, 0.0)
        bpy.context.collection.objects.link(words[-1])
    for obj in words:
        obj.select_set(True)
    bpy.context.view_layer.objects.active = words[0]
    with window.override():
        bpy.ops.view3d.view_axis(type="TOP")
        bpy.ops.view3d.view_selected()
        bpy.ops.convwass.bake_morph(flat_resolution=256, frames=24, scaling="EQUAL_VOLUME")
    bpy.context.scene.frame_set(13)
    yield from window.open_tab("Convwass")
    yield from _shot(window, "flat")


def _densities(window: Window) -> Iterator[float]:
    yield from _begin(window)
    horse = _shape(window, "horse", 0.0)
    low, high = (pick(vertex.co.z for vertex in horse.data.vertices) for pick in (min, max))
    for name, is_in in (("Hooves", lambda z: z < low + 0.1 * (high - low)), ("Head", lambda z: z > high - 0.15)):
        inside = [vertex.index for vertex in horse.data.vertices if is_in(vertex.co.z)]
        horse.vertex_groups.new(name=name).add(inside, 1.0, "REPLACE")
    yield from _look_at(window, [horse])
    own = horse.convwass_density
    own.first, own.second, own.trail = "Hooves", "Head", True
    with window.override():
        bpy.ops.convwass.interpolate_density(first="Hooves", second="Head", steps=12, trail=True)
    window.area.spaces.active.shading.type = "MATERIAL"
    bpy.context.scene.frame_set(8)
    yield from window.open_tab("Convwass")
    yield from window.open_panel("CONVWASS_PT_densities")
    yield _SHADERS
    yield from _shot(window, "densities")
    window.area.spaces.active.shading.type = "SOLID"


def _soft_map(window: Window) -> Iterator[float]:
    import soft_maps

    yield from soft_maps._begins(window)
    own = bpy.context.scene.convwass_soft_map
    _select(own.source, own.target)
    with window.override():
        bpy.ops.object.shade_smooth()
    yield from _look_at(window, [own.source, own.target])
    for place in soft_maps._PLACES:
        found = [_nearest(obj, soft_maps._seen(obj, place)) for obj in (own.source, own.target)]
        with window.override():
            bpy.ops.convwass.add_map_pair(label=place, source_vertex=found[0], target_vertex=found[1])
    with window.override():
        bpy.ops.convwass.compute_soft_map()
        bpy.ops.convwass.show_soft_map()
    for obj in list(bpy.context.selected_objects):
        obj.select_set(False)
    yield 1.0
    yield from _shot(window, "soft_map")


def _nearest(obj: bpy.types.Object, place: tuple[float, float, float]) -> int:
    """Return the index of the vertex nearest to a point in the scene."""
    away = [(obj.matrix_world @ vertex.co - Vector(place)).length for vertex in obj.data.vertices]
    return away.index(min(away))


def _armature(window: Window) -> Iterator[float]:
    import armatures

    yield from _begin(window)
    body = window.import_shape("octopus")
    with window.override():
        bpy.ops.object.shade_smooth()
    tips = armatures._tips(body)
    rig = armatures._rig(tips)
    rig.show_in_front = True
    own = bpy.context.scene.convwass_armature
    own.body, own.rig = body, rig
    with window.override():
        bpy.ops.object.mode_set(mode="EDIT")
    for arm, tip in enumerate(tips):
        below = tip - Vector((0.0, 0.0, 0.01))
        _, bottom, _, _ = body.ray_cast(below, Vector((0.0, 0.0, -1.0)))
        rig.data.edit_bones[f"arm{arm}.{armatures._BONES}"].tail = (tip + bottom) / 2.0
    for bone in rig.data.edit_bones:
        bone.select = bone.select_head = False
        bone.select_tail = bone.name.endswith(f".{armatures._BONES}")
    with window.override():
        bpy.ops.convwass.pin_joints()
        bpy.ops.convwass.fit_armature()
        bpy.ops.object.mode_set(mode="OBJECT")
    yield from _look_at(window, [body])
    _select(rig)
    yield from window.open_tab("Convwass")
    yield from window.open_panel("CONVWASS_PT_armature")
    yield from _shot(window, "armature")


def _recolor(window: Window) -> Iterator[float]:
    yield from _begin(window)
    area = window.area
    # Two photographs cropped from the picture that shows the result.
    with TemporaryDirectory() as folder:
        images = {}
        for name, corner in (("coffee", "+0+0"), ("rocket", "+1728+292")):
            path = str(Path(folder) / f"{name}.png")
            source = str(_PROJECT / "docs" / "pictures" / "recolor.jpg")
            subprocess.run(["convert", source, "-crop", f"420x280{corner}", "+repage", path], check=True)
            images[name] = bpy.data.images.load(path)
            images[name].pack()
    own = bpy.context.scene.convwass_recolor
    own.palette = images["rocket"]
    area.type = "IMAGE_EDITOR"
    space = area.spaces.active
    space.image, space.show_region_ui = images["coffee"], True
    yield 2.0
    panel = next(region for region in area.regions if region.type == "UI")
    canvas = next(region for region in area.regions if region.type == "WINDOW")
    panel.active_panel_category = "Convwass"
    with bpy.context.temp_override(window=bpy.context.window_manager.windows[0], area=area, region=canvas):
        bpy.ops.convwass.recolor_image(image="coffee.png")
        space.image = bpy.data.images["coffee.png recolored"]
        bpy.ops.image.view_all(fit_view=True)
    yield 2.0
    yield from _shot(window, "recolor", area)
    area.type = "VIEW_3D"
    yield 1.0


def _light(window: Window) -> Iterator[float]:
    yield from _begin(window)
    own = bpy.context.scene.convwass_reflectance
    made = [_metal("Mirror", 0.12, (0.9, 0.6, 0.2)), _metal("Brushed", 0.6, (0.3, 0.5, 0.9))]
    own.material, own.material_2, own.blend = *made, "WEIGHTS"
    known = set(bpy.data.materials)
    with window.override():
        bpy.ops.convwass.blend_materials(
            materials="Mirror, Brushed", weights="1, 1", blend="WEIGHTS", output="FITTED", detail=24
        )
    made.insert(1, next(material for material in bpy.data.materials if material not in known))
    balls = []
    for place, material in enumerate(made):
        with window.override():
            bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, location=(2.3 * place, 0.0, 0.0))
            bpy.ops.object.shade_smooth()
        balls.append(bpy.context.object)
        balls[-1].data.materials.append(material)
    yield from _look_at(window, balls)
    window.area.spaces.active.region_3d.view_distance *= 0.8
    bpy.ops.object.select_all(action="DESELECT")
    window.area.spaces.active.shading.type = "MATERIAL"
    yield from window.open_tab("Convwass")
    yield from window.open_panel("CONVWASS_PT_light")
    yield _SHADERS
    yield from _shot(window, "light")


def _metal(name: str, roughness: float, color: tuple[float, float, float]) -> bpy.types.Material:
    material = bpy.data.materials.new(name)
    if not material.node_tree:
        material.use_nodes = True
    shader = next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
    for socket, value in (("Metallic", 1.0), ("Roughness", roughness), ("Base Color", (*color, 1.0))):
        shader.inputs[socket].default_value = value
    return material


def _begin(window: Window) -> Iterator[float]:
    """Open an empty scene without distractions."""
    bpy.ops.wm.read_homefile(use_empty=False, app_template="")
    yield 1.5
    for obj in list(bpy.data.objects):
        bpy.data.objects.remove(obj)
    space = window.area.spaces.active
    space.overlay.show_cursor, space.shading.color_type = False, "OBJECT"
    yield 0.5


def _shape(window: Window, name: str, x: float) -> bpy.types.Object:
    """Import a sample shape and color it."""
    obj = window.import_shape(name)
    obj.location.x = x
    obj.color = (*_COLORS[name], 1.0)
    with window.override():
        bpy.ops.object.shade_smooth()
    return obj


def _look_at(window: Window, objects: list[bpy.types.Object]) -> Iterator[float]:
    """Select objects and view them from the front, slightly from above and from the side."""
    _select(*objects)
    view = window.area.spaces.active.region_3d
    view.view_perspective = "PERSP"
    view.view_rotation = Euler((radians(76), 0.0, radians(12))).to_quaternion()
    with window.override():
        bpy.ops.view3d.view_selected()
    view.view_distance *= 0.75
    yield 1.0


def _select(*objects: bpy.types.Object) -> None:
    for obj in bpy.context.selected_objects:
        obj.select_set(False)
    for obj in objects:
        obj.select_set(True)
    bpy.context.view_layer.objects.active = objects[0]


def _shot(
    window: Window,
    name: str,
    area: bpy.types.Area | None = None,
    *,
    share: float = 1.0,
    has_timeline: bool = False,
) -> Iterator[float]:
    """Save a picture of an area, by default the viewport: the top fraction of its height, or also everything below."""
    area = area or window.area
    yield 1.0
    yield from window.picture(name)
    top = bpy.context.window_manager.windows[0].height - area.y - area.height
    height = round(area.height * share) + (area.y if has_timeline else 0)
    whole, target = window.pictures / f"{name}.png", window.pictures / "walkthrough" / f"{name}.jpg"
    cut = ["-crop", f"{area.width}x{height}+{area.x}+{top}", "+repage", "-resize", f"{_WIDTH}x"]
    small = ["-strip", "-interlace", "Plane", "-quality", str(_QUALITY)]
    subprocess.run(["convert", str(whole), *cut, *small, str(target)], check=True)
    whole.unlink()
