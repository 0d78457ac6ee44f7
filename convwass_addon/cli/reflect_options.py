# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The options of the commands ``reflect`` and ``sky``."""

from __future__ import annotations

from argparse import ArgumentParser
from pathlib import Path

from ..applications.reflectance.reflectance_settings import ReflectanceSettings
from ..applications.skies.sky_settings import SkySettings
from .argument_types import numbers
from .from_schema import add_setting_options

REFLECT_HELP = """Make a material between two to four others. A material is

  principled:ROUGHNESS[,ANISOTROPY]   a metal of Blender's Principled BSDF
  ggx:ALPHA_X,ALPHA_Y                 microfacets
  blinn:EXPONENT                      Blinn's highlight
  ashikhmin:NU,NV                     Ashikhmin and Shirley's
  FILE.binary                         a measured material of the MERL database
  FILE.npz, FILE.lobes.exr            a table that this command has written; all of them tables then

  convwass reflect principled:0.2 principled:0.6 --weights 0.5,0.5 --out half.npz
  convwass reflect blinn:400 principled:0.7 --steps 9 --out path.exr
  convwass reflect blinn:400 principled:0.4 principled:0.8 --pad 5 --out pad.blend
"""

SKY_HELP = """Make the skies between equirectangular images, two or more: suns move with their glow, the rest fades.

  convwass sky morning.exr noon.exr --steps 25 --out skies
"""


def add_reflect_options(parser: ArgumentParser) -> None:
    """Add what ``reflect`` takes."""
    parser.add_argument("materials", nargs="+", metavar="MATERIAL", help="two to four, see above")
    parser.add_argument(
        "--out",
        type=Path,
        required=True,
        metavar="FILE",
        help=".npz or .lobes.exr for one blend, .exr for what Blender looks up, .blend for balls that show it",
    )
    parser.add_argument("--json", action="store_true", help="print a record for programs")
    group = parser.add_argument_group("blend")
    group.add_argument(
        "--weights",
        type=numbers,
        action="append",
        metavar="W,…",
        help="one blend with these weights (all alike); given several times, a way through them in --steps",
    )
    group.add_argument(
        "--steps", type=int, metavar="N", help="so many blends on a way, or from the first material to the last"
    )
    group.add_argument("--pad", type=int, metavar="N", help="N x N blends all over a pad of three or four materials")
    settings = parser.add_argument_group("transport")
    add_setting_options(settings, ReflectanceSettings)


def add_sky_options(parser: ArgumentParser) -> None:
    """Add what ``sky`` takes."""
    parser.add_argument(
        "skies", nargs="+", type=Path, metavar="IMAGE", help="two or more in turn, twice as wide as high; .exr or .hdr"
    )
    parser.add_argument("--out", type=Path, required=True, metavar="FOLDER", help="where the images go")
    parser.add_argument("--json", action="store_true", help="print a record for programs")
    parser.add_argument("--steps", type=int, default=25, metavar="N", help="images, both ends included (%(default)s)")
    parser.add_argument("--first", type=int, default=1, metavar="N", help="number of the first one (%(default)s)")
    parser.add_argument("--width", type=int, metavar="PIXELS", help="of the images (that of the first sky)")
    settings = parser.add_argument_group("suns")
    add_setting_options(settings, SkySettings)
