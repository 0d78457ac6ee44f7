# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw shapes that become a ball with their own mesh, docs/pictures/two_meshes.jpg.

``python3 run.py python docs/two_meshes.py``
"""

from __future__ import annotations

import bpy
import numpy as np
from photographs import PROJECT, row_picture, sample_shape
from PIL import Image

import convwass_addon
from convwass_addon.bridge.objects import triangle_mesh
from convwass_addon.bridge.studio.framing import View
from convwass_addon.bridge.studio.rendered_scene import world_points

PICTURE = PROJECT / "docs" / "pictures" / "two_meshes.jpg"
SHAPES = ("knot", "octopus")
FRAMES = (1, 6, 11, 14, 16, 20, 25)

# The picture of a row in pixels, light paths per pixel, per cent of JPEG.
_ROW, _SAMPLES, _QUALITY = (1500, 230), 24, 88
_VIEW = View(np.radians(-62.0), np.radians(10.0))
_COLORS = ((0.72, 0.42, 0.24, 1.0), (0.24, 0.4, 0.66, 1.0))


def main() -> None:
    """Bake a morph of each shape to a ball, and draw a row of its frames."""
    rows = []
    for shape in SHAPES:
        bpy.ops.wm.read_factory_settings(use_empty=True)
        convwass_addon.register()
        names = _shape_and_ball(shape)
        for name, color in zip(names, _COLORS, strict=True):
            material = bpy.data.materials.new(name)
            material.diffuse_color = color
            material.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = color
            bpy.data.objects[name].data.materials.append(material)
        bpy.ops.convwass.bake_morph(inputs=",".join(names), output="SHAPE_KEYS", two_meshes=True, frames=24)
        rows.append(_row())
        convwass_addon.unregister()
    whole = Image.new("RGB", (rows[0].width, sum(row.height for row in rows)))
    for number, row in enumerate(rows):
        whole.paste(row, (0, sum(own.height for own in rows[:number])))
    whole.save(PICTURE, quality=_QUALITY)
    print(f"{PICTURE.name}: {PICTURE.stat().st_size / 1e3:.0f} kB")


def _shape_and_ball(shape: str) -> list[str]:
    """Add a sample shape and a ball of the same volume around its center."""
    obj = sample_shape(shape)
    obj.name = shape.title()
    volume = triangle_mesh(obj, bpy.context.evaluated_depsgraph_get()).volume
    radius, center = float(np.cbrt(0.75 / np.pi * volume)), np.mean(world_points(obj), axis=0)
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=5, radius=radius, location=center)
    bpy.context.object.name = "Ball"
    return [obj.name, "Ball"]


def _row() -> Image.Image:
    """Render the shown mesh at some frames, side by side."""
    scene, shown = bpy.context.scene, []
    step = 1.15 * max(float(np.ptp(world_points(obj), axis=0).max()) for obj in scene.objects if obj.type == "MESH")
    for frame in FRAMES:
        scene.frame_set(frame)
        graph = bpy.context.evaluated_depsgraph_get()
        (obj,) = (own for own in scene.objects if own.name.endswith(" Morph") and not own.hide_render)
        mesh = bpy.data.meshes.new_from_object(obj.evaluated_get(graph), depsgraph=graph)
        mesh.transform(obj.matrix_world)
        mesh.shade_smooth()
        shown.append(bpy.data.objects.new("Figure", mesh))
    return row_picture(shown, _VIEW, step, _ROW, _SAMPLES)


if __name__ == "__main__":
    main()
