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

REFLECT_HELP = """Blend two to four materials. A material is one of

  principled:ROUGHNESS[,ANISOTROPY]   a metal of Blender's Principled BSDF
  ggx:ALPHA_X,ALPHA_Y                 microfacets
  blinn:EXPONENT                      Blinn's highlight
  ashikhmin:NU,NV                     the highlight of Ashikhmin and Shirley
  FILE.binary                         a measured material of the MERL database
  FILE.npz, FILE.lobes.exr            a table written by this command; only with other tables

examples:
  reflect principled:0.2 principled:0.6 --weights 0.5,0.5 --out half.npz
  reflect principled:0.2 principled:0.7 --rows 32 --steps 5 --out path.exr
  reflect blinn:40 principled:0.4 principled:0.8 --rows 32 --pad 3 --out pad.blend

"""

SKY_HELP = """Blend two or more equirectangular skies: suns move with their glow, everything else cross-fades.

example with your own files:
  sky morning.exr noon.exr --steps 25 --out skies

"""


def add_reflect_options(parser: ArgumentParser) -> None:
    """Add the options of ``reflect``."""
    parser.add_argument("materials", nargs="+", metavar="MATERIAL", help="two to four materials, as described above")
    parser.add_argument(
        "--out",
        type=Path,
        required=True,
        metavar="FILE",
        help=".npz or .lobes.exr for one blend, .exr for a stack of lookup images for Blender, .blend for a scene of "
        "spheres that show it",
    )
    parser.add_argument("--json", action="store_true", help="print the record as JSON")
    group = parser.add_argument_group("blend")
    group.add_argument(
        "--weights",
        type=numbers,
        action="append",
        metavar="W,W,...",
        help="weights of one blend (default: equal); repeated, the corners of a path with --steps",
    )
    group.add_argument(
        "--steps", type=int, metavar="N", help="number of blends along the path, or from the first material to the last"
    )
    group.add_argument("--pad", type=int, metavar="N", help="a pad of N x N blends of three or four materials")
    settings = parser.add_argument_group("transport")
    add_setting_options(settings, ReflectanceSettings)


def add_sky_options(parser: ArgumentParser) -> None:
    """Add the options of ``sky``."""
    parser.add_argument(
        "skies",
        nargs="+",
        type=Path,
        metavar="IMAGE",
        help="two or more images that Blender can read, in order, twice as wide as high; only .exr and .hdr hold the "
        "full brightness of suns",
    )
    parser.add_argument("--out", type=Path, required=True, metavar="FOLDER", help="output folder")
    parser.add_argument("--json", action="store_true", help="print the record as JSON")
    parser.add_argument(
        "--steps", type=int, default=25, metavar="N", help="number of images, including both ends (%(default)s)"
    )
    parser.add_argument("--first", type=int, default=1, metavar="N", help="number of the first image (%(default)s)")
    parser.add_argument(
        "--width", type=int, metavar="PIXELS", help="width of the images (default: width of the first sky)"
    )
    settings = parser.add_argument_group("suns")
    add_setting_options(settings, SkySettings)
