# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw the motions of morphs, docs/pictures/motions.jpg: ``python3 run.py python docs/motions.py``.

Three pairs of the coherence benchmark, seven frames each: transport alone above, a guided motion or a warp below.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import bpy
import numpy as np
from PIL import Image, ImageDraw, ImageFont

from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.bridge.morphs.contact_sheet import render_contact_sheet
from convwass_addon.bridge.morphs.stored import INDEX_KEY, WEIGHTS_KEY
from convwass_addon.bridge.objects import write_mesh
from convwass_addon.geometry.mesh import TriangleMesh
from convwass_addon.progress import drained

# Unlike the add-on, the benchmarks are not installed.
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from benchmarks.blends import baked_frames
from benchmarks.coherence_pairs import pairs_named

PICTURE = Path(__file__).resolve().parent / "pictures" / "motions.jpg"
FRAMES = 7
"""In a row, the two shapes among them."""

# Pixels: of the picture, of the names at its left, and between two pairs.
_WIDTH, _GUTTER, _BETWEEN = 1500, 130, 12
_QUALITY = 85
_INK, _FAINT = (52, 52, 56), (120, 120, 126)
_CLAY = (0.48, 0.12, 0.05, 1.0)


@dataclass(frozen=True)
class Comparison:
    """A pair of shapes, and the motion that is shown below transport alone.

    Attributes
    ----------
    pair : str
        A name of `benchmarks.coherence_pairs`.
    motion : str
        As `MorphSettings` calls it.
    """

    pair: str
    motion: str


COMPARISONS = (
    Comparison("man raises arm", "guided"),
    Comparison("dog rears", "guided"),
    Comparison("chair to man", "warp"),
)


def main() -> None:
    """Bake and render all pairs."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cells", type=int, default=64, help="along the longest side (%(default)s)")
    parser.add_argument("--out", type=Path, default=PICTURE, help="the JPEG to write (%(default)s)")
    options = parser.parse_args()
    blocks = []
    for comparison in COMPARISONS:
        motions = ("transport", comparison.motion)
        rows = [baked_row(comparison.pair, motion, options.cells) for motion in motions]
        blocks.append(labeled(rendered(rows), motions))
    stacked(blocks).save(options.out, quality=_QUALITY, optimize=True, progressive=True)


def baked_row(pair: str, motion: str, cells: int) -> list[TriangleMesh]:
    """Bake the frames from one shape of a pair to the other, both included."""
    print(f"{pair}: {motion}", flush=True)
    (chosen,) = pairs_named([pair], None)
    ends = chosen.ends()
    shapes = (ends.first, ends.second)
    frames = baked_frames(shapes, FRAMES - 1, MorphSettings(resolution=cells, motion=motion))
    return [shapes[frame.blend.source] if frame.mesh is None else frame.mesh for frame in frames]


def rendered(rows: Sequence[Sequence[TriangleMesh]]) -> Image.Image:
    """Render rows of frames by the contact sheet of morphs."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    collection = bpy.data.collections.new("Sheet")
    bpy.context.scene.collection.children.link(collection)
    clay = _clay()
    # The sheet leaves room between neighbors that touch.
    extents = np.max([np.ptp(frame.bounds, axis=0) for frames in rows for frame in frames], axis=0)
    across, down = float(extents[:2].max()), float(extents[2])
    for row, frames in enumerate(rows):
        for column, frame in enumerate(frames):
            obj = _object(frame, clay)
            obj.location = (across * column, 0.0, -down * row)
            share = column / (len(frames) - 1)
            obj[WEIGHTS_KEY], obj[INDEX_KEY] = [1.0 - share, share], row * len(frames) + column
            collection.objects.link(obj)
    with TemporaryDirectory() as folder:
        path = drained(render_contact_sheet(collection, Path(folder) / "sheet.png", width=_WIDTH - _GUTTER))
        with Image.open(path) as picture:
            return picture.convert("RGB")


def _clay() -> bpy.types.Material:
    material = bpy.data.materials.new("Clay")
    if material.node_tree is None:  # Blender 4.5
        material.use_nodes = True
    shader = next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
    shader.inputs["Base Color"].default_value = _CLAY
    shader.inputs["Roughness"].default_value = 0.5
    return material


def _object(mesh: TriangleMesh, material: bpy.types.Material) -> bpy.types.Object:
    data = bpy.data.meshes.new("Frame")
    write_mesh(data, mesh)
    data.shade_smooth()
    data.materials.append(material)
    return bpy.data.objects.new("Frame", data)


def labeled(sheet: Image.Image, motions: Sequence[str]) -> Image.Image:
    """Write the names of the motions beside the rows of a sheet."""
    block = Image.new("RGB", (_WIDTH, sheet.height), "white")
    block.paste(sheet, (_GUTTER, 0))
    draw, font = ImageDraw.Draw(block), ImageFont.load_default(20)
    for row, motion in enumerate(motions):
        middle = sheet.height * (row + 0.5) / len(motions)
        draw.text((_GUTTER / 2, middle), motion.capitalize(), _INK if row else _FAINT, font, anchor="mm")
    return block


def stacked(blocks: Sequence[Image.Image]) -> Image.Image:
    """Put pictures below each other."""
    height = sum(block.height + _BETWEEN for block in blocks) - _BETWEEN
    picture = Image.new("RGB", (_WIDTH, height), "white")
    top = 0
    for block in blocks:
        picture.paste(block, (0, top))
        top += block.height + _BETWEEN
    return picture


if __name__ == "__main__":
    main()
