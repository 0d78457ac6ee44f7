# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw the motions of morphs into docs/pictures: ``python3 run.py python docs/motions.py``.

Pairs of the coherence benchmark, seven frames each: transport alone above, a motion below. ``--only NAME`` draws one of
the pictures: motions, pairs_one_build, pairs_other, pairs_held_back, pairs_solid, pairs_props, pairs_vessels,
pairs_tubes or pairs_one_mesh.
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
from clay import clay, frame_object
from PIL import Image, ImageDraw, ImageFont

from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.applications.motions.guides import Guide
from convwass_addon.bridge.morphs.pictures.contact_sheet import render_contact_sheet
from convwass_addon.bridge.morphs.stored import INDEX_KEY, WEIGHTS_KEY
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.progress import drained

# Unlike the add-on, the benchmarks are not installed.
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from benchmarks.blends import baked_frames
from benchmarks.coherence import kept_frames
from benchmarks.coherence_cases import read_frames
from benchmarks.coherence_pairs import ONE_BUILD, SKINNED, SOLIDS, TUNED, pairs_named

PICTURES = Path(__file__).resolve().parent / "pictures"
FRAMES = 7
"""Number of frames in a row, including the two shapes."""

# Pixels: width of the picture, margins for names at the left and at the top, and gap between two pairs.
_WIDTH, _GUTTER, _HEAD, _BETWEEN = 1500, 130, 30, 12
_QUALITY = 85
_INK, _FAINT = (52, 52, 56), (120, 120, 126)
_CLAY = (0.48, 0.12, 0.05, 1.0)


@dataclass(frozen=True)
class Block:
    """A pair of shapes, and the motions shown for it, one per row.

    Attributes
    ----------
    pair : str
        A name of `benchmarks.coherence_pairs`.
    motions : tuple of str
        Values of `MorphSettings.motion`.
    """

    pair: str
    motions: tuple[str, ...]

    @classmethod
    def compared(cls, pair: str) -> Block:
        """Show transport above the automatic motion."""
        return cls(pair, ("transport", "automatic"))


def drawn_pictures() -> dict[str, list[Block]]:
    """Return the blocks of every picture by its name."""
    return {
        "motions": [Block.compared(pair) for pair in ("man raises arm", "dog to man", "chair to man")],
        "pairs_one_build": [Block.compared(pair.name) for pair in TUNED if pair.build == ONE_BUILD],
        "pairs_other": [
            Block.compared(pair)
            for pair in (
                *("dog to man", "chair to man", "octopus to horse"),
                *("horse to bird", "star to cross", "dog to centaur"),
            )
        ],
        "pairs_held_back": [
            Block.compared(pair)
            for pair in (
                *("giraffe grazes", "goat rears", "goat to ogre", "table to dog"),
                *("cactus to child", "starfish to hand", "A to B"),
            )
        ],
        "pairs_solid": [Block.compared(name) for name in (*[pair.name for pair in SOLIDS], "ball to knot")],
        "pairs_props": [
            Block.compared(pair)
            for pair in (
                *("star to heart", "ring to C", "bottle to lying rook"),
                *("wine glass to vase", "trophy to wine glass", "robot to chair", "locomotive to car"),
            )
        ],
        "pairs_vessels": [
            Block.compared(pair) for pair in ("mug to bottle", "goblet to bottle", "pawn to bowl", "mug to trophy")
        ],
        "pairs_one_mesh": [Block.compared(pair.name) for pair in SKINNED],
        "pairs_tubes": [Block.compared(pair) for pair in ("coil to rod", "spring to rod", "spring to snake")],
    }


def main() -> None:
    """Bake and render all pairs."""
    pictures = drawn_pictures()
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cells", type=int, default=100, help="along the longest side (%(default)s)")
    parser.add_argument("--only", choices=pictures, help="draw this picture alone")
    parser.add_argument(
        "--kept", action="store_true", help="use the frames that `run.py bench coherence` has stored, if there are any"
    )
    parser.add_argument("--samples", type=int, default=12, help="light paths per pixel (%(default)s)")
    options = parser.parse_args()
    for name in [options.only] if options.only else pictures:
        blocks = []
        for block in pictures[name]:
            bake = kept_row if options.kept else baked_row
            rows = [bake(block.pair, motion, options.cells) for motion in block.motions]
            blocks.append(drawn(rows, block, options.samples))
        save(stacked(blocks), name)


def baked_row(pair: str, motion: str, cells: int) -> list[TriangleMesh]:
    """Bake the frames from one shape of a pair to the other, both included."""
    print(f"{pair}: {motion}", flush=True)
    (chosen,) = pairs_named([pair], None)
    ends = chosen.ends()
    return baked((ends.first, ends.second), MorphSettings(resolution=cells, motion=motion))


def baked(
    shapes: tuple[TriangleMesh, TriangleMesh], settings: MorphSettings, guides: Sequence[Guide] = ()
) -> list[TriangleMesh]:
    """Bake the frames of a row from one shape to another, both included."""
    frames = baked_frames(shapes, FRAMES - 1, settings, guides)
    return [shapes[frame.blend.source] if frame.mesh is None else frame.mesh for frame in frames]


def kept_row(pair: str, motion: str, cells: int) -> list[TriangleMesh]:
    """Return frames stored by the coherence benchmark; if there are none, bake some."""
    path = kept_frames(pair, motion)
    if not path.exists():
        return baked_row(pair, motion, cells)
    frames = read_frames(path)
    return [frames[number] for number in np.linspace(0, len(frames) - 1, FRAMES).round().astype(int)]


def rendered(rows: Sequence[Sequence[TriangleMesh]], width: int, samples: int) -> Image.Image:
    """Render rows of frames with the contact sheet of morphs, `width` pixels wide."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    collection = bpy.data.collections.new("Sheet")
    bpy.context.scene.collection.children.link(collection)
    material = clay(_CLAY)
    # The sheet adds a gap between neighbors that touch.
    extents = np.max([np.ptp(frame.bounds, axis=0) for frames in rows for frame in frames], axis=0)
    across, down = float(extents[:2].max()), float(extents[2])
    for row, frames in enumerate(rows):
        for column, frame in enumerate(frames):
            obj = frame_object(frame, material)
            obj.location = (across * column - float(frame.bounds[:, 0].mean()), 0.0, -down * row)
            share = column / (len(frames) - 1)
            obj[WEIGHTS_KEY], obj[INDEX_KEY] = [1.0 - share, share], row * len(frames) + column
            collection.objects.link(obj)
    with TemporaryDirectory() as folder:
        path = drained(render_contact_sheet(collection, Path(folder) / "sheet.png", width=width, samples=samples))
        with Image.open(path) as picture:
            return picture.convert("RGB")


def drawn(rows: Sequence[Sequence[TriangleMesh]], block: Block, samples: int) -> Image.Image:
    """Render the rows of a pair; several have labels."""
    if len(rows) == 1:
        return rendered(rows, _WIDTH, samples)
    return labeled(rendered(rows, _WIDTH - _GUTTER, samples), block)


def save(picture: Image.Image, name: str) -> None:
    """Write a picture to the folder of pictures."""
    picture.save(PICTURES / f"{name}.jpg", quality=_QUALITY, optimize=True, progressive=True)


def labeled(sheet: Image.Image, block: Block) -> Image.Image:
    """Write the name of the pair above a sheet, and the motions at the left of its rows."""
    picture = Image.new("RGB", (_WIDTH, sheet.height + _HEAD), "white")
    picture.paste(sheet, (_GUTTER, _HEAD))
    draw, font = ImageDraw.Draw(picture), ImageFont.load_default(20)
    draw.text((_GUTTER / 6, _HEAD / 2), block.pair, _INK, font, anchor="lm")
    for row, motion in enumerate(block.motions):
        middle = _HEAD + sheet.height * (row + 0.5) / len(block.motions)
        draw.text((_GUTTER / 2, middle), motion.capitalize(), _INK if row else _FAINT, font, anchor="mm")
    return picture


def stacked(blocks: Sequence[Image.Image]) -> Image.Image:
    """Stack pictures vertically."""
    height = sum(block.height + _BETWEEN for block in blocks) - _BETWEEN
    picture = Image.new("RGB", (_WIDTH, height), "white")
    top = 0
    for block in blocks:
        picture.paste(block, (0, top))
        top += block.height + _BETWEEN
    return picture


if __name__ == "__main__":
    main()
