# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Render the moving pictures of the README, docs/pictures/*.webp: ``python3 run.py python docs/moving.py``.

Each is baked as by a user, rendered in Cycles, and played back and forth. ``--only NAME`` renders one of them.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Callable
from pathlib import Path

import bpy
import numpy as np
from characters import body_object
from filming import Film, save, save_loop
from live_films import live_frames, with_pad
from numpy.typing import NDArray
from photographs import color_material, finer, sample_shape
from walking_film import walking_frames

import convwass_addon
from convwass_addon.bridge.morphs.stored import frame_objects
from convwass_addon.bridge.objects import triangle_mesh
from convwass_addon.bridge.studio.framing import View
from convwass_addon.bridge.studio.rendered_scene import world_points

# Unlike the add-on, the benchmarks are not installed.
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from benchmarks.coherence_pairs import pairs_named

FRAMES = 24
"""From one shape to the other."""

_CLAY = (0.48, 0.12, 0.05)
# Milliseconds of a frame of a live morph.
_MOMENT = 60


def first() -> None:
    """Turn a chestnut horse into a spotted cow, with limbs, faces and colors."""
    begin()
    paint(finer(sample_shape("horse"), 2), _chestnut)
    paint(finer(sample_shape("cow"), 2), _piebald)
    save("first", Film(bake("horse", "cow")).rendered((680, 450)))


def hold_together() -> None:
    """Raise the arm of a man, by transport alone and with the automatic motion."""
    save("hold_together", *(_raising(motion).rendered((420, 480)) for motion in ("TRANSPORT", "AUTOMATIC")))


def _raising(motion: str) -> Film:
    names = clay_pair("man raises arm")
    label = {"TRANSPORT": "Transport alone", "AUTOMATIC": "Convwass: Automatic"}[motion]
    return Film(bake(*names, motion=motion), label)


def live() -> None:
    """Lead the handle of a live morph of three animals around its pad."""
    begin()
    names = ("horse", "dog", "cow")
    shapes = [sample_shape(name) for name in names]
    depsgraph = bpy.context.evaluated_depsgraph_get()
    moments = live_frames([triangle_mesh(obj, depsgraph) for obj in shapes], names)
    frames = [body_object("Moment", moment.mesh) for moment in moments]
    for frame in frames:
        paint(frame, _clay)
    pictures = Film(frames).rendered((560, 460))
    with_pads = [with_pad(picture, moment.weights, names) for picture, moment in zip(pictures, moments, strict=True)]
    save_loop("live", with_pads, [_MOMENT] * len(moments))


def any_topology() -> None:
    """Turn a chair, which has holes, into a man, who has none."""
    names = clay_pair("chair to man")
    save("any_topology", Film(bake(*names)).rendered((460, 520)))


def walking() -> None:
    """Turn a textured man into an ogre and back while both walk."""
    begin()
    frames = walking_frames()
    pictures = Film(frames[:-1]).rendered((520, 520), View(math.radians(-60.0), math.radians(18.0)))
    save_loop("walking", pictures, [_MOMENT] * len(pictures))


def one_mesh() -> None:
    """Let a dog rear on its own vertices, by shape keys, and draw its edges."""
    names = clay_pair("dog rears")
    before = set(bpy.data.objects)
    bpy.ops.convwass.bake_morph(frames=FRAMES, output="SHAPE_KEYS")
    (obj,) = set(bpy.data.objects) - before
    obj.data.materials.clear()
    obj.data.materials.append(_wired(bpy.data.materials[names[0]]))
    (slider,) = (key for key in obj.keys() if not key.startswith("convwass"))  # noqa: SIM118 (Blender's)
    obj.animation_data.action = None
    save("one_mesh", Film([_posed(obj, slider, step / FRAMES) for step in range(FRAMES + 1)]).rendered((560, 440)))


def _posed(obj: bpy.types.Object, slider: str, value: float) -> bpy.types.Object:
    obj[slider] = value
    obj.update_tag()
    graph = bpy.context.evaluated_depsgraph_get()
    return bpy.data.objects.new("Pose", bpy.data.meshes.new_from_object(obj.evaluated_get(graph)))


def _wired(material: bpy.types.Material) -> bpy.types.Material:
    """Return a material that is darker where edges are."""
    nodes, links = material.node_tree.nodes, material.node_tree.links
    shader = next(node for node in nodes if node.type == "BSDF_PRINCIPLED")
    mix, wire = nodes.new("ShaderNodeMixRGB"), nodes.new("ShaderNodeWireframe")
    wire.use_pixel_size = True
    wire.inputs["Size"].default_value = 0.7
    links.new(wire.outputs[0], mix.inputs[0])
    mix.inputs[1].default_value, mix.inputs[2].default_value = (0.75, 0.6, 0.45, 1.0), (0.06, 0.05, 0.05, 1.0)
    links.new(mix.outputs[0], shader.inputs["Base Color"])
    return material


def begin() -> None:
    """Begin with an empty scene."""
    bpy.ops.wm.read_factory_settings(use_empty=True)


def clay_pair(pair: str) -> tuple[str, str]:
    """Create the shapes of a pair of the coherence benchmark in an empty scene, and return their names."""
    begin()
    (chosen,) = pairs_named([pair], None)
    ends = chosen.ends()
    for name, mesh in (("First", ends.first), ("Second", ends.second)):
        obj = body_object(name, mesh)
        paint(obj, _clay)
    return "First", "Second"


def bake(first: str, second: str, motion: str = "AUTOMATIC") -> list[bpy.types.Object]:
    """Bake a morph from the first of two objects to the second, and return its frames including the shapes."""
    for obj in bpy.data.objects:
        obj.select_set(obj.name in (first, second))
    bpy.context.view_layer.objects.active = bpy.data.objects[first]
    # Objects selected by a script are sorted by name.
    bpy.ops.convwass.bake_morph(frames=FRAMES, resolution=100, motion=motion, reverse=first > second)
    morph = next(collection for collection in bpy.data.collections if collection.name.startswith("Morph"))
    return frame_objects(morph)


def paint(obj: bpy.types.Object, color: Callable[[NDArray[np.float64]], NDArray[np.float64]]) -> None:
    """Color an object by the positions of its vertices, and add a material of its name that shows the colors."""
    mesh = obj.data
    mesh.shade_smooth()
    points = world_points(obj).astype(np.float64)
    colors = np.ones((len(points), 4), dtype=np.float32)
    colors[:, :3] = color((points - points.min(axis=0)) / np.ptp(points, axis=0).max())
    attribute = mesh.color_attributes.new("Paint", "FLOAT_COLOR", "POINT")
    attribute.data.foreach_set("color", colors.ravel())
    mesh.materials.clear()
    mesh.materials.append(color_material(obj.name, "Paint"))
    obj.select_set(True)
    bpy.context.view_layer.objects.active = obj


def _clay(points: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.broadcast_to(_CLAY, points.shape)


def _chestnut(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return chestnut, darker towards the hooves."""
    dark = np.clip(1.0 - points[:, 2] / 0.35, 0.0, 1.0)[:, None]
    return dark * [0.03, 0.012, 0.008] + (1.0 - dark) * [0.33, 0.1, 0.03]


def _piebald(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return black patches on white."""
    rng = np.random.default_rng(5)
    centers = points[rng.choice(len(points), 14, replace=False)]
    reach = rng.uniform(0.06, 0.15, len(centers))
    depth = (np.linalg.norm(points[:, None] - centers, axis=2) - reach).min(axis=1)
    inside = np.clip(0.5 - depth / 0.015, 0.0, 1.0)[:, None]
    return inside * [0.015, 0.013, 0.012] + (1.0 - inside) * [0.82, 0.78, 0.72]


FILMS = {film.__name__: film for film in (first, hold_together, live, one_mesh, walking, any_topology)}


def main() -> None:
    """Bake and render."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", choices=FILMS, help="render this one alone")
    only = parser.parse_args().only
    convwass_addon.register()
    for name in [only] if only else FILMS:
        print(name, flush=True)
        FILMS[name]()


if __name__ == "__main__":
    main()
