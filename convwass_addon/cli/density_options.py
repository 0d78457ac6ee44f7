# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The options of the command ``density``."""

from __future__ import annotations

from argparse import ArgumentParser
from pathlib import Path

from ..applications.densities.density_settings import DensitySettings
from ..bridge.densities.density_request import DensityRequest
from .argument_types import named_numbers, place_pair
from .from_schema import add_setting_options

DENSITY_HELP = """Measure, interpolate and blend painted densities on a surface by optimal transport.

A density is a vertex group of the mesh, or vertex:123 (vertex:5,17,29), a unit mass at these vertices, spread by the
blur. The mesh is an object in a .blend, written file.blend:Object, with the modifiers that only move vertices applied,
or a file that Blender can import, which has no groups. Lengths are in scene units. By default, distances use 20
substeps, and distances between groups a tolerance of 0.00001 and at most 1000 iterations.

examples in the project's folder:
  density assets/shapes/cow.ply --from vertex:2697 --to vertex:2 --steps 24 --out flow.blend
  density assets/shapes/cow.ply --blend vertex:2697=0.3,vertex:2=0.7 --out blend.blend
  density assets/shapes/cow.ply --measure vertex:2697 vertex:2
  density assets/shapes/cow.ply --distance-from 2697 --out distance.blend

examples with your own files:
  density cow.blend:Cow --from Head --to Tail --steps 24 --out cow_flow.blend
  density cow.blend:Cow --through Head Belly Tail Head --entropy-limit off --out cow_flow.blend
  density cow.blend:Cow --blend Head=0.3,Tail=0.7 --out blend.blend
  density cow.blend:Cow --propagate Head=1 1=2 2=Tail 1=Ear --out between.blend
  density cow.blend:Cow --measure Head Tail
  density cow.blend:Cow --matrix --json

"""


def add_density_options(parser: ArgumentParser) -> None:
    """Add the options to the parser."""
    parser.add_argument("mesh", metavar="MESH", help="a file, or file.blend:Object")
    _add_tasks(parser)
    _add_solver_options(parser)
    group = parser.add_argument_group("output")
    group.add_argument(
        "--out",
        type=Path,
        metavar="FILE",
        help="the .blend to write (default: density.blend for animations and blends, none for measurements)",
    )
    group.add_argument("--name", help="name of the attribute or group written (Density, Blend, Distance)")
    group.add_argument("--json", action="store_true", help="print the solver's figures as JSON")


def _add_tasks(parser: ArgumentParser) -> None:
    group = parser.add_argument_group("task")
    group.add_argument("--from", dest="start", metavar="GROUP", help="start of the animation, with --to")
    tasks = group.add_mutually_exclusive_group(required=True)
    tasks.add_argument("--to", dest="end", metavar="GROUP", help="animate the density from --from to this group")
    tasks.add_argument(
        "--through",
        nargs="+",
        action="extend",
        metavar="GROUP",
        help="animate a density through these groups, in order",
    )
    tasks.add_argument(
        "--blend", type=named_numbers, metavar="GROUP=NUMBER,...", help="blend groups by weights, such as A=0.3,B=0.7"
    )
    tasks.add_argument(
        "--propagate",
        type=place_pair,
        nargs="+",
        action="extend",
        metavar="PLACE=PLACE",
        help="interpolate over a graph with these edges, such as Head=x x=y y=Tail; places that are not groups become "
        "groups",
    )
    tasks.add_argument("--measure", nargs=2, metavar="GROUP", help="the distance between two groups")
    tasks.add_argument("--matrix", action="store_true", help="the distances between all groups of the object")
    tasks.add_argument(
        "--distance-from",
        type=int,
        nargs="+",
        action="extend",
        metavar="VERTEX",
        help="the distance from these vertices to all others",
    )


def _add_solver_options(parser: ArgumentParser) -> None:
    group = parser.add_argument_group("method")
    add_setting_options(group, DensitySettings, DensityRequest)
    group.add_argument(
        "--biased",
        action="store_true",
        help="with --measure: the raw value of eq. (10), including the bias of the blur",
    )
