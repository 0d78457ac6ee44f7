# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw baked textures of one mesh, docs/pictures/baked_textures.jpg: ``python3 run.py python docs/baked_textures.py``.

A horse with procedural spots becomes a cow with a quilt, on the mesh of the horse, with images of both. Below are the
two images of their base colors and the normal map of the cow, on the UV map of the horse. Three minutes on a core.
"""

from __future__ import annotations

import bpy
import numpy as np
from looks import assign, quilted, spotted, unwrap
from photographs import PROJECT, finer, row_picture, sample_shape
from PIL import Image

import convwass_addon
from convwass_addon.bridge.files.image_files import pixel_values
from convwass_addon.bridge.studio.framing import View

PICTURE = PROJECT / "docs" / "pictures" / "baked_textures.jpg"
VALUES = (0.0, 0.3, 0.5, 0.7, 1.0)
_VIEW = View(np.radians(-60.0), np.radians(10.0))
_ROW, _SAMPLES, _QUALITY, _STEP = (1400, 330), 32, 86, 1.25


def main() -> None:
    """Bake the keys and the images, and draw them."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    convwass_addon.register()
    horse, cow = sample_shape("horse"), finer(sample_shape("cow"), 1)
    for obj, material in ((horse, spotted()), (cow, quilted())):
        unwrap(obj)
        assign(obj, material)
    bpy.ops.convwass.bake_morph(inputs="horse,cow", output="SHAPE_KEYS", frames=24)
    obj = bpy.data.objects["horse Morph"]
    obj.animation_data.action = None
    bpy.context.view_layer.objects.active = obj
    bpy.ops.convwass.bake_textures(texture_size=1024, texture_samples=4)
    row = _row(obj)
    images = [
        _picture(bpy.data.images[f"horse Morph {name}"]) for name in ("Base Color", "cow Base Color", "cow Normal")
    ]
    side = row.width // len(images)
    whole = Image.new("RGB", (row.width, row.height + side), "white")
    whole.paste(row, (0, 0))
    for number, image in enumerate(images):
        whole.paste(image.resize((side, side), Image.Resampling.LANCZOS), (number * side, row.height))
    whole.save(PICTURE, quality=_QUALITY)
    print(f"{PICTURE.name}: {PICTURE.stat().st_size / 1e3:.0f} kB")


def _picture(image: bpy.types.Image) -> Image.Image:
    """Return an image as it is stored."""
    return Image.fromarray(np.rint(255.0 * pixel_values(image)[::-1, :, :3]).astype(np.uint8))


def _row(obj: bpy.types.Object) -> Image.Image:
    """Render the mesh at some values of its slider, side by side."""
    graph, shown = bpy.context.evaluated_depsgraph_get(), []
    for value in VALUES:
        obj["cow"] = value
        obj.update_tag()
        graph.update()
        mesh = bpy.data.meshes.new_from_object(obj.evaluated_get(graph), preserve_all_data_layers=True, depsgraph=graph)
        shown.append(bpy.data.objects.new("Figure", mesh))
        # The material reads the slider of the object.
        shown[-1]["cow"] = value
    return row_picture(shown, _VIEW, _STEP * max(obj.dimensions), _ROW, _SAMPLES)


if __name__ == "__main__":
    main()
