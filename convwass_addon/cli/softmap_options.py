# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The options of the command ``softmap``."""

from __future__ import annotations

from argparse import ArgumentParser
from pathlib import Path

from ..applications.soft_maps.soft_map_settings import SoftMapSettings
from ..bridge.soft_maps.soft_map_requests import MapRequest, TransferRequest
from .argument_types import vertex_pair
from .from_schema import add_setting_options
from .reports import add_output_options

KINDS = ("weights", "keys", "uvs", "colors")
"""The kinds of data that can be transferred."""

SOFTMAP_HELP = """Map one mesh to another from a few pairs of corresponding vertices, and transfer vertex groups,
shape keys, UV maps and colors with the map.

A mesh is an object in a .blend, written file.blend:Object, with the modifiers that only move vertices applied, or a
file that Blender can import. A pair such as 12:40 means that vertex 12 of SOURCE corresponds to vertex 40 of TARGET.
Four pairs are enough for two poses of one mesh, about ten for meshes of different proportions. Mark the ends of limbs,
on both the left and the right side.

example in the project's folder:
  softmap assets/shapes/cow_spotted.obj assets/shapes/horse.ply --pairs 2697:2697 2:2 1930:1865 482:399 --transfer uvs

examples with your own files:
  softmap fox.blend:Fox dog.blend:Dog --pairs 12:40 77:301 5:9 63:118 --transfer weights keys --out dog_rigged.blend
  softmap pets.blend:Fox pets.blend:Dog --pairs-from empties --transfer uvs colors
  softmap old.obj new.obj --pairs 12:40 77:301 --transfer uvs --report map.json
  softmap fox.blend:Fox --mirror --pairs 12:13 40:44 --transfer keys

"""


def add_softmap_options(parser: ArgumentParser) -> None:
    """Add the options to the parser."""
    parser.add_argument("source", metavar="SOURCE", help="a file, or file.blend:Object")
    parser.add_argument("target", metavar="TARGET", nargs="?", help="the other object, in the same file or another")
    _add_pair_options(parser)
    _add_transfer_options(parser)
    _add_solver_options(parser)
    group = parser.add_argument_group("output")
    add_output_options(group, Path("softmap.blend"), "write the record of the map as JSON")


def _add_pair_options(parser: ArgumentParser) -> None:
    group = parser.add_argument_group("corresponding points")
    group.add_argument(
        "--pairs",
        type=vertex_pair,
        nargs="+",
        action="extend",
        default=[],
        metavar="S:T",
        help="vertices of SOURCE and TARGET",
    )
    group.add_argument(
        "--pairs-from",
        choices=("groups", "empties"),
        help="use small vertex groups of equal names, or Empties of equal names that lie on or are parented to both "
        "objects",
    )
    add_setting_options(group, MapRequest)
    group.add_argument(
        "--mirror",
        action="store_true",
        help="map SOURCE to its own mirror image; pairs are vertices that mirror each other, and names with a side, "
        "such as Arm.L, switch sides",
    )


def _add_transfer_options(parser: ArgumentParser) -> None:
    group = parser.add_argument_group("transfer")
    group.add_argument(
        "--transfer",
        nargs="+",
        action="extend",
        choices=KINDS,
        default=[],
        metavar="KIND",
        help=f"any of {', '.join(KINDS)}",
    )
    group.add_argument(
        "--names",
        nargs="+",
        action="extend",
        default=[],
        metavar="NAME",
        help="only groups, keys or maps with these names",
    )
    add_setting_options(group, TransferRequest)


def _add_solver_options(parser: ArgumentParser) -> None:
    group = parser.add_argument_group("method")
    add_setting_options(group, SoftMapSettings)
    group.add_argument(
        "--repair",
        type=float,
        metavar="CONFIDENCE",
        help="replace points with a confidence below this, 0 to 1, by those of their neighbors",
    )
