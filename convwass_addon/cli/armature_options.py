# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The options of the command ``armature``."""

from __future__ import annotations

from argparse import ArgumentParser
from pathlib import Path

from ..applications.skeletons.skeleton_settings import SkeletonSettings
from ..bridge.armatures.fit_request import FitRequest
from .argument_types import joint_place, pinned_joint
from .from_schema import add_setting_options
from .reports import add_output_options

ARMATURE_HELP = """Fit an armature into a mesh: pinned joints keep their positions, the others are placed inside.

BODY is a mesh. RIG is an armature, or a mesh of edges without faces. Both are objects in a .blend, written
file.blend:Object, or files that Blender can import; the name is optional if the .blend contains only one candidate.
Joints of armatures are named after bones, such as Arm.L.head and Arm.L.tail; joints of meshes are vertex numbers.
Pin the ends of limbs, and at least three joints of every loop. Positions are in world space, in scene units. Joints
that are pinned in the .blend are pinned here too.

examples with your own files:
  armature spider.blend:Spider spider.blend:Rig --out fitted.blend
  armature spider.obj rigs.blend:Spider --pin Leg1.tail=0.9,1.2,0 Leg2.tail=1.3,0.5,0 Body.head --auto-weights
  armature tree.obj tree_lines.ply --place 0=0,0,-0.1 7=1.5,0.2,3 12=-1.1,0.4,2.8 --report tree.json

"""


def add_armature_options(parser: ArgumentParser) -> None:
    """Add the options to the parser."""
    parser.add_argument("body", metavar="BODY", help="a file, or file.blend:Object")
    parser.add_argument("rig", metavar="RIG", help="a file, or file.blend:Object")
    _add_pin_options(parser)
    _add_solver_options(parser)
    group = parser.add_argument_group("output")
    add_setting_options(group, FitRequest, only=("auto_weights",))
    add_output_options(group, Path("armature.blend"), "write the joints as JSON")


def _add_pin_options(parser: ArgumentParser) -> None:
    group = parser.add_argument_group("joints")
    group.add_argument(
        "--pin",
        type=pinned_joint,
        nargs="+",
        action="extend",
        default=[],
        metavar="JOINT[=X,Y,Z]",
        help="joints to keep where they are, or to pin at a position",
    )
    group.add_argument(
        "--place",
        type=joint_place,
        nargs="+",
        action="extend",
        default=[],
        metavar="JOINT=X,Y,Z",
        help="joints to place inside the body, behind a point on its surface",
    )
    add_setting_options(group, SkeletonSettings, only=("outside_pins",))


def _add_solver_options(parser: ArgumentParser) -> None:
    group = parser.add_argument_group("method")
    add_setting_options(group, FitRequest, only=("bones",))
    add_setting_options(group, SkeletonSettings, without=("outside_pins",))
