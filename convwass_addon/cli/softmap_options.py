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
"""What can be transferred."""

SOFTMAP_HELP = """Find where every vertex of one mesh belongs on another, from a few pairs of vertices, and carry vertex
groups, shape keys, UV maps and colors across.

A mesh is an object of a .blend, written file.blend:Object, as it stands with the modifiers that only move vertices; or
a file that Blender reads. Pairs are vertices that belong together, such as 12:40: 12 of SOURCE, 40 of TARGET. Four do
where one is a pose of the other, ten where proportions differ; mark the ends of limbs, left and right ones.

examples:
  softmap fox.blend:Fox dog.blend:Dog --pairs 12:40 77:301 5:9 63:118 --transfer weights keys --out dog_rigged.blend
  softmap pets.blend:Fox pets.blend:Dog --pairs-from empties --transfer uvs colors
  softmap old.obj new.obj --pairs 12:40 77:301 --transfer uvs --report map.json
  softmap fox.blend:Fox --mirror --pairs 12:13 40:44 --transfer keys

"""


def add_softmap_options(parser: ArgumentParser) -> None:
    """Add all of them."""
    parser.add_argument("source", metavar="SOURCE", help="a file, or file.blend:Object")
    parser.add_argument("target", metavar="TARGET", nargs="?", help="another one, of the same file or of another")
    _add_pair_options(parser)
    _add_transfer_options(parser)
    _add_solver_options(parser)
    group = parser.add_argument_group("what is written")
    add_output_options(group, Path("softmap.blend"), "write what is known about the map as JSON")


def _add_pair_options(parser: ArgumentParser) -> None:
    group = parser.add_argument_group("what belongs together")
    group.add_argument(
        "--pairs", type=vertex_pair, nargs="+", default=[], metavar="S:T", help="vertices of SOURCE and TARGET"
    )
    group.add_argument(
        "--pairs-from",
        choices=("groups", "empties"),
        help="small vertex groups of equal names, or Empties of equal names that stand on both, also by parenting",
    )
    add_setting_options(group, MapRequest)
    group.add_argument(
        "--mirror",
        action="store_true",
        help="map SOURCE to its own mirror image; pairs are vertices that mirror each other, and names with a side, "
        "such as Arm.L, go to the other side",
    )


def _add_transfer_options(parser: ArgumentParser) -> None:
    group = parser.add_argument_group("what is transferred")
    group.add_argument(
        "--transfer", nargs="+", choices=KINDS, default=[], metavar="KIND", help=f"any of {', '.join(KINDS)}"
    )
    group.add_argument("--names", nargs="+", default=[], metavar="NAME", help="only these groups, keys or maps")
    add_setting_options(group, TransferRequest)


def _add_solver_options(parser: ArgumentParser) -> None:
    group = parser.add_argument_group("how it is done")
    add_setting_options(group, SoftMapSettings)
    group.add_argument(
        "--repair",
        type=float,
        metavar="CONFIDENCE",
        help="fill in points of less confidence, 0 to 1, from those around them",
    )
