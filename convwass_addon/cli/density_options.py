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

DENSITY_HELP = """Move what is painted on a surface along it by optimal transport: measure, interpolate, blend.

A distribution is a vertex group of the mesh, or vertex:123 (vertex:5,17,29): a unit mass at some vertices, spread by
the blur. The mesh is an object of a .blend, written file.blend:Object, as it stands with the modifiers that only move
vertices; or a file that Blender reads, which has no groups. Lengths are in scene units. Distances between groups are
solved to a tolerance of 0.00001 in 1000 iterations at most, and all distances with 20 substeps, if nothing else is set.

examples:
  density cow.blend:Cow --from Head --to Tail --steps 24 --out cow_flow.blend
  density cow.blend:Cow --through Head Belly Tail Head --entropy-limit off --out cow_flow.blend
  density cow.blend:Cow --blend Head=0.3,Tail=0.7 --out blend.blend
  density cow.blend:Cow --propagate Head=1 1=2 2=Tail 1=Ear --out between.blend
  density cow.obj --from vertex:10 --to vertex:2500
  density cow.blend:Cow --measure Head Tail
  density cow.blend:Cow --matrix --json
  density cow.obj --distance-from 10 --out distance.blend

"""


def add_density_options(parser: ArgumentParser) -> None:
    """Add all of them."""
    parser.add_argument("mesh", metavar="MESH", help="a file, or file.blend:Object")
    _add_tasks(parser)
    _add_solver_options(parser)
    group = parser.add_argument_group("what is written")
    group.add_argument(
        "--out",
        type=Path,
        metavar="FILE",
        help="the .blend to write (density.blend where something travels or blends; none for measures)",
    )
    group.add_argument(
        "--name", help="of the animated attribute or the group that is written (Density, Blend, Distance)"
    )
    group.add_argument("--json", action="store_true", help="print the figures of the solver as JSON")


def _add_tasks(parser: ArgumentParser) -> None:
    group = parser.add_argument_group("what is done")
    group.add_argument("--from", dest="start", metavar="GROUP", help="where the density starts, with --to")
    tasks = group.add_mutually_exclusive_group(required=True)
    tasks.add_argument("--to", dest="end", metavar="GROUP", help="animate the density of --from to this one")
    tasks.add_argument("--through", nargs="+", metavar="GROUP", help="animate a density through these, in their order")
    tasks.add_argument(
        "--blend", type=named_numbers, metavar="GROUP=NUMBER,...", help="blend groups by weights, such as A=0.3,B=0.7"
    )
    tasks.add_argument(
        "--propagate",
        type=place_pair,
        nargs="+",
        metavar="PLACE=PLACE",
        help="fill in what is between: places of a graph by its edges, such as Head=x x=y y=Tail; those that are no "
        "groups are made as groups",
    )
    tasks.add_argument("--measure", nargs=2, metavar="GROUP", help="the distance between two groups")
    tasks.add_argument("--matrix", action="store_true", help="the distances between all groups of the object")
    tasks.add_argument(
        "--distance-from", type=int, nargs="+", metavar="VERTEX", help="the distance from vertices to everywhere"
    )


def _add_solver_options(parser: ArgumentParser) -> None:
    group = parser.add_argument_group("how it is done")
    add_setting_options(group, DensitySettings, DensityRequest)
    group.add_argument("--biased", action="store_true", help="measure: the plain value of eq. (10), with its blur")
