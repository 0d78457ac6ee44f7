# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The options of the command ``recolor``."""

from __future__ import annotations

from argparse import ArgumentParser
from pathlib import Path

from ..applications.palettes.palette_settings import RecolorSettings, TableSettings
from .argument_types import numbers
from .from_schema import add_setting_options

RECOLOR_HELP = """Give images the palette of another image, or the barycenter of the palettes of several.

Several images are frames of one clip, and so are those of a movie: they are graded alike, by the palette of all of them
together, so that nothing flickers. With --cube the grade is written as a table too, for other programs; --lut applies
such a table instead.

examples:
  recolor photo.png --palette painting.jpg --out graded.png
  recolor shot.*.png --palette still.png --strength 0.7 --out graded/
  recolor shot.mp4 --palette still.png --out graded/
  recolor day.exr --palette dusk.exr night.exr --weights 0.7,0.3 --out between.exr
  recolor photo.png --palette painting.jpg --steps 8 --out sequence/
  recolor photo.png --palette painting.jpg --cube grade.cube
  recolor shot.*.png --lut grade.cube --out graded/

"""


def add_recolor_options(parser: ArgumentParser) -> None:
    """Add all of them."""
    parser.add_argument(
        "images", metavar="IMAGE", nargs="+", type=Path, help="an image, the frames of a clip, or a movie"
    )
    parser.add_argument("--palette", type=Path, nargs="+", default=[], metavar="IMAGE", help="whose colors are taken")
    parser.add_argument("--weights", type=numbers, metavar="W,W,...", help="of several palettes (all alike)")
    parser.add_argument("--lut", type=Path, metavar="FILE", help="apply this .cube instead of a palette")
    _add_map_options(parser)
    group = parser.add_argument_group("what is written")
    group.add_argument("--out", type=Path, metavar="FILE", help="the image to write, or a folder for several")
    group.add_argument("--cube", type=Path, metavar="FILE", help="write the grade as a .cube table")
    add_setting_options(group, TableSettings)
    group.add_argument(
        "--steps", type=int, metavar="N", help="write N images on the way from strength 0 to --strength, from one"
    )
    group.add_argument(
        "--depth", choices=("automatic", "8", "16", "32"), default="automatic", help="bits of a channel (%(default)s)"
    )
    group.add_argument("--json", action="store_true", help="print what is known about the map as JSON")


def _add_map_options(parser: ArgumentParser) -> None:
    group = parser.add_argument_group("how it is done")
    add_setting_options(group, RecolorSettings)
    group.add_argument("--mask", type=Path, metavar="IMAGE", help="white where the images change, of their size")
    group.add_argument("--palette-mask", type=Path, metavar="IMAGE", help="white where the only palette counts")
    group.add_argument("--workers", type=int, metavar="N", help="threads (one per processor)")
