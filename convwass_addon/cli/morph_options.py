# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The options of the command ``morph``."""

from __future__ import annotations

from argparse import ArgumentParser
from pathlib import Path

from ..applications.flat.flat_settings import FlatSettings
from ..applications.morphs.morph_settings import MorphSettings
from ..applications.one_mesh.texture_settings import TextureSettings
from ..bridge.morphs.disk.exports import SUFFIXES
from ..bridge.morphs.morph_request import MorphRequest
from ..bridge.morphs.outputs import ON_DISK, PACKED, SHAPE_KEYS
from .argument_types import WORKERS, frame_range, numbers
from .from_schema import add_setting_options

MORPH_HELP = """Morph shapes of any topology into each other by optimal transport and save the result as a .blend.

A shape is a file that Blender can import (OBJ, PLY, STL, glTF, FBX, USD, Alembic), or an object or a collection in a
.blend, written file.blend:NAME. It may be open, self-intersecting, inside out, or consist of several parts.

Shapes can also be flat, if all of them are. A flat shape is text:WORD, an SVG file, an image (PNG, JPEG, TIFF, BMP,
WebP), whose silhouette is used, or a text, curve, drawing, image Empty or flat mesh in a .blend. The frames are curves.

examples in the project's folder:
  morph assets/shapes/cow.ply assets/shapes/bird.ply assets/shapes/double_torus.ply --frames 24 --render
  morph morph.blend:cow morph.blend:bird --motion transport --output player --out player.blend
  morph assets/shapes/horse.ply assets/shapes/double_torus.ply assets/shapes/bird.ply --layout triangle --output pad
  morph assets/shapes/cow.ply assets/shapes/bird.ply --weights 0.3,0.7 --export blend.ply
  morph assets/shapes/horse.ply assets/shapes/cow.ply --cache frames --frames-range 0-11
  morph assets/shapes/horse.ply assets/shapes/cow.ply --cache frames --at 7.35,8.5 --out between.blend
  morph text:A text:B --frames 24 --scale equal-volume --out letters.blend
  morph text:SUN text:ICE --words letters --out words.blend

examples with your own files:
  morph scene.blend:Cube scene.blend:Suzanne --frames 48
  morph text:A logo.svg --out logo.blend
  morph a.obj b.obj --frames 240 --cache /shared/frames --scheduler tcp://192.168.1.10:8786

"""

WRITTEN = ("flat_output", "faces", "looks", "grays", "between", "basis", "key_error", "symmetric", "two_meshes")
"""The settings of a request that describe the output; the others describe the morph."""


def add_morph_options(parser: ArgumentParser) -> None:
    """Add the options to the parser."""
    parser.add_argument(
        "shapes", nargs="+", metavar="SHAPE", help="a file, file.blend:Object, or text:WORD; two or more, in order"
    )
    parser.add_argument("--out", type=Path, default=Path("morph.blend"), help="the .blend to write (%(default)s)")
    _add_layout_options(parser)
    _add_solver_options(parser)
    _add_computing_options(parser)
    _add_output_options(parser)


def _add_layout_options(parser: ArgumentParser) -> None:
    group = parser.add_argument_group("layout")
    add_setting_options(group, MorphRequest, without=WRITTEN)
    group.add_argument(
        "--weights", type=numbers, help="make a single blend with one weight per shape, such as 0.2,0.3,0.5"
    )
    group.add_argument(
        "--at",
        type=numbers,
        metavar="NUMBERS",
        help="path only: make a sheet of the blends at these fractional frame numbers, such as 7.35,8.5, starting "
        "from the nearest frames in --cache; missing ones are computed first",
    )


def _add_solver_options(parser: ArgumentParser) -> None:
    group = parser.add_argument_group("method")
    add_setting_options(group, MorphSettings, FlatSettings)
    group.add_argument(
        "--guides",
        metavar="groups|empties|bones|FILE",
        help="corresponding points of the shapes: small vertex groups, Empties or bone ends with the same name, or a "
        'JSON file such as [{"name": "nose", "points": {"Man": 12, "Woman": 345}}], with numbers of vertices before '
        "modifiers, as in Blender",
    )


def _add_computing_options(parser: ArgumentParser) -> None:
    group = parser.add_argument_group("computation")
    group.add_argument("--workers", **WORKERS)
    group.add_argument(
        "--scheduler",
        metavar="ADDRESS",
        help="compute frames on the workers of a Dask cluster, such as tcp://HOST:8786",
    )
    group.add_argument(
        "--cache",
        type=Path,
        metavar="FOLDER",
        help="keep finished frames in this folder and compute only the missing ones; several machines can share it",
    )
    group.add_argument(
        "--frames-range",
        type=frame_range,
        metavar="A-B",
        help="path only: compute these frames into the cache and write no .blend; the first shape is frame 0",
    )


def _add_output_options(parser: ArgumentParser) -> None:
    group = parser.add_argument_group("output")
    group.add_argument(
        "--output",
        choices=[*PACKED, *ON_DISK, SHAPE_KEYS],
        default="objects",
        help="how the .blend shows the morph: one object per frame, one player object, a pad to drag on (for a "
        "sheet), VDB, Alembic or USD files next to it, or the first mesh with shape keys to the other shapes "
        "(%(default)s)",
    )
    add_setting_options(group, MorphRequest, only=WRITTEN)
    group.add_argument(
        "--render",
        action="store_true",
        help="also render a picture of the morph and, for a path, an animation, next to the .blend",
    )
    group.add_argument(
        "--export",
        type=Path,
        metavar="FILE",
        help="also export the meshes; the extension sets the format: "
        + ", ".join(SUFFIXES)
        + "; with --output shape-keys also .fbx, but no .obj, .ply and .stl",
    )
    group.add_argument(
        "--textures",
        action="store_true",
        help="with --output shape-keys: also bake images of the looks of the shapes, and a material that mixes them",
    )
    add_setting_options(group, TextureSettings)
    group.add_argument("--json", action="store_true", help="print the solver's records as JSON")
