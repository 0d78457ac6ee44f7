# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw the looks of frames, docs/pictures/looks.jpg: ``python3 run.py python docs/looks.py``.

A horse with procedural spots and bumps becomes a cow with an image texture, first with colors of vertices only, then
with each of the ways to mix whole materials. Ten minutes on a core; ``--cells N`` draws it finer.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from tempfile import TemporaryDirectory

import bpy
import numpy as np
from photographs import PROJECT, finer, sample_shape
from PIL import Image, ImageDraw, ImageFont

from convwass_addon.applications.morphs.computation import Computation
from convwass_addon.applications.morphs.frame_cache import FrameCache
from convwass_addon.applications.morphs.layouts import path_blends
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.bridge.morphs.job import MorphJob
from convwass_addon.bridge.morphs.pictures.contact_sheet import render_contact_sheet
from convwass_addon.bridge.nodes.node_trees import own_tree
from convwass_addon.progress import drained

_ROWS = {"COLORS": "Colors", "FADE": "Fade", "FRONT": "Front", "PATCHES": "Patches"}
_WIDTH, _GUTTER, _QUALITY = 1300, 100, 88
# Part of the height of a rendered row that is shown.
_TOP, _BOTTOM = 0.1, 0.92


def main() -> None:
    """Render a row for every value of the setting, and put them below each other."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cells", type=int, default=64, help="cells along the longest side (%(default)s)")
    parser.add_argument("--out", type=Path, default=PROJECT / "docs" / "pictures" / "looks.jpg")
    options = parser.parse_args()
    with TemporaryDirectory() as folder:
        rows = [_row(looks, options.cells, Path(folder)) for looks in _ROWS]
    picture = Image.new("RGB", (_WIDTH + _GUTTER, sum(row.height for row in rows)), "white")
    writing, top = ImageDraw.Draw(picture), 0
    for name, row in zip(_ROWS.values(), rows, strict=True):
        picture.paste(row, (_GUTTER, top))
        place = (_GUTTER - 14, top + row.height // 2)
        writing.text(place, name, (52, 52, 56), ImageFont.load_default(20), anchor="rm")
        top += row.height
    picture.save(options.out, quality=_QUALITY)


def _row(looks: str, cells: int, folder: Path) -> Image.Image:
    """Bake five frames from one animal to the other, and render them; all rows share the solved blends."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    horse, cow = finer(sample_shape("horse"), 1), finer(sample_shape("cow"), 1)
    assign(horse, spotted())
    unwrap(cow)
    assign(cow, quilted())
    bpy.context.view_layer.update()
    settings = MorphSettings(cells)
    job = MorphJob([horse, cow], path_blends(2, 4), settings, {"looks": looks}, 1)
    for step in job.steps(computation=Computation(cache=FrameCache(folder / "cache"))):
        job.write(step)
    morph = job.finish(hide_inputs=True)
    path = drained(render_contact_sheet(morph, folder / f"{looks}.png", width=_WIDTH, samples=16))
    with Image.open(path) as picture:
        shown = (0, int(_TOP * picture.height), picture.width, int(_BOTTOM * picture.height))
        return picture.convert("RGB").crop(shown)


def assign(obj: bpy.types.Object, material: bpy.types.Material) -> None:
    """Give a shape a single material and smooth shading."""
    obj.data.shade_smooth()
    obj.data.materials.clear()
    obj.data.materials.append(material)


def unwrap(obj: bpy.types.Object) -> None:
    """Unwrap a shape into a few dozen islands."""
    bpy.context.view_layer.objects.active = obj
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.uv.smart_project(angle_limit=1.2, island_margin=0.01)
    bpy.ops.object.mode_set(mode="OBJECT")


def _material(name: str) -> tuple[bpy.types.Material, bpy.types.NodeTree, bpy.types.Node]:
    material = bpy.data.materials.new(name)
    shader = next(node for node in own_tree(material).nodes if node.type == "BSDF_PRINCIPLED")
    return material, material.node_tree, shader


def spotted() -> bpy.types.Material:
    """Return the coat of a giraffe, with raised spots, in object coordinates."""
    material, tree, shader = _material("Giraffe")
    place, cells = tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeTexVoronoi")
    ramp, bump = tree.nodes.new("ShaderNodeValToRGB"), tree.nodes.new("ShaderNodeBump")
    cells.feature = "DISTANCE_TO_EDGE"
    cells.inputs["Scale"].default_value = 9.0
    ramp.color_ramp.elements[0].position, ramp.color_ramp.elements[1].position = 0.06, 0.09
    ramp.color_ramp.elements[0].color, ramp.color_ramp.elements[1].color = (0.9, 0.78, 0.52, 1), (0.3, 0.09, 0.02, 1)
    bump.inputs["Distance"].default_value = 0.02
    shader.inputs["Roughness"].default_value = 0.4
    tree.links.new(place.outputs["Object"], cells.inputs["Vector"])
    tree.links.new(cells.outputs["Distance"], ramp.inputs["Fac"])
    tree.links.new(ramp.outputs["Color"], bump.inputs["Height"])
    tree.links.new(ramp.outputs["Color"], shader.inputs["Base Color"])
    tree.links.new(bump.outputs["Normal"], shader.inputs["Normal"])
    return material


def quilted() -> bpy.types.Material:
    """Return a cloth of blue and white squares with seams, as an image with a normal map."""
    material, tree, shader = _material("Quilt")
    size, squares = 2048, 40
    rows, columns = np.indices((size, size)) * squares / size
    inside = np.minimum.reduce([rows % 1, columns % 1, 1 - rows % 1, 1 - columns % 1])
    is_dark = ((rows.astype(int) + columns.astype(int)) % 2 == 1)[..., None]
    colors = np.where(is_dark, [0.05, 0.25, 0.6, 1.0], [0.93, 0.93, 0.88, 1.0])
    colors[inside < 0.06] = [0.85, 0.6, 0.1, 1.0]
    height = np.minimum(inside / 0.35, 1.0) ** 0.5
    up, right = np.gradient(height, 1.0 / 20.0)
    normals = np.stack([-right, -up, np.ones_like(up)], axis=2)
    normals = 0.5 + 0.5 * normals / np.linalg.norm(normals, axis=2, keepdims=True)
    texture = _image(tree, colors, "sRGB")
    tree.links.new(texture.outputs["Color"], shader.inputs["Base Color"])
    texture = _image(tree, np.concatenate([normals, np.ones((size, size, 1))], axis=2), "Non-Color")
    bend = tree.nodes.new("ShaderNodeNormalMap")
    tree.links.new(texture.outputs["Color"], bend.inputs["Color"])
    tree.links.new(bend.outputs["Normal"], shader.inputs["Normal"])
    shader.inputs["Roughness"].default_value = 0.7
    return material


def _image(tree: bpy.types.NodeTree, pixels: np.ndarray, space: str) -> bpy.types.Node:
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = bpy.data.images.new("Image", pixels.shape[1], pixels.shape[0])
    # A change of the color space clears images that are not packed.
    node.image.colorspace_settings.name = space
    node.image.pixels.foreach_set(pixels.astype(np.float32).ravel())
    node.image.pack()
    return node


if __name__ == "__main__":
    main()
