# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The options of the command ``recolor``."""

from __future__ import annotations

from argparse import ArgumentParser
from pathlib import Path

from ..applications.palettes.palette_settings import RecolorSettings, TableSettings
from .argument_types import numbers
from .from_schema import add_setting_options

RECOLOR_HELP = """Give images the palette of another image, or the barycenter of several palettes.

Several images, or the frames of a movie, are treated as one clip: all of them get the same color map, so that nothing
flickers. --cube also writes the color map as a lookup table for other programs; --lut applies such a table.

examples in the project's folder:
  recolor assets/shapes/cow_spotted.png --palette docs/pictures/recolor.jpg --out spotted.png --cube grade.cube
  recolor assets/shapes/cow_spotted.png --lut grade.cube --out again.png
  recolor assets/shapes/cow_spotted.png --palette docs/pictures/recolor.jpg --steps 8 --out sequence/

examples with your own files:
  recolor photo.png --palette painting.jpg --out graded.png
  recolor shot.*.png --palette still.png --strength 0.7 --out graded/
  recolor shot.mp4 --palette still.png --out graded/
  recolor day.exr --palette dusk.exr night.exr --weights 0.7,0.3 --out between.exr
  recolor shot.*.png --lut grade.cube --out graded/

"""


def add_recolor_options(parser: ArgumentParser) -> None:
    """Add the options to the parser."""
    parser.add_argument(
        "images", metavar="IMAGE", nargs="+", type=Path, help="an image, the frames of a clip, or a movie"
    )
    parser.add_argument(
        "--palette",
        type=Path,
        nargs="+",
        action="extend",
        default=[],
        metavar="IMAGE",
        help="images whose colors are used",
    )
    parser.add_argument(
        "--weights", type=numbers, metavar="W,W,...", help="weights of several palettes (default: equal)"
    )
    parser.add_argument(
        "--lut", type=Path, metavar="FILE", help="apply this .cube instead of a palette, with --strength"
    )
    _add_map_options(parser)
    group = parser.add_argument_group("output")
    group.add_argument("--out", type=Path, metavar="FILE", help="the image to write, or a folder for several")
    group.add_argument("--cube", type=Path, metavar="FILE", help="write the color map as a .cube lookup table")
    add_setting_options(group, TableSettings)
    group.add_argument(
        "--steps", type=int, metavar="N", help="with a single image: write N images from strength 0 to --strength"
    )
    group.add_argument(
        "--depth", choices=("automatic", "8", "16", "32"), default="automatic", help="bits per channel (%(default)s)"
    )
    group.add_argument("--json", action="store_true", help="print the record of the map as JSON")


def _add_map_options(parser: ArgumentParser) -> None:
    group = parser.add_argument_group("method")
    add_setting_options(group, RecolorSettings)
    group.add_argument("--mask", type=Path, metavar="IMAGE", help="white where the images change; of the same size")
    group.add_argument(
        "--palette-mask",
        type=Path,
        metavar="IMAGE",
        help="white where the palette's colors count; for a single palette",
    )
    group.add_argument("--workers", type=int, metavar="N", help="threads (default: one per processor)")
