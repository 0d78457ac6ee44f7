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

ARMATURE_HELP = """Fit an armature into a mesh: pinned joints stay where they are, the others are laid out inside.

BODY is a mesh and RIG an armature, or a mesh of edges without faces: objects of a .blend, written file.blend:Object, or
files that Blender reads; a .blend that holds one only needs no name. Joints are called after bones, such as
Arm.L.head and Arm.L.tail, and joints of meshes after the numbers of their vertices. Pin the ends of limbs, and at least
three joints of every loop. Places are in world space, in scene units. Joints that are pinned in the .blend count too.

examples:
  armature spider.blend:Spider spider.blend:Rig --out fitted.blend
  armature spider.obj rigs.blend:Spider --pin Leg1.tail=0.9,1.2,0 Leg2.tail=1.3,0.5,0 Body.head --auto-weights
  armature tree.obj tree_lines.ply --place 0=0,0,-0.1 7=1.5,0.2,3 12=-1.1,0.4,2.8 --report tree.json

"""


def add_armature_options(parser: ArgumentParser) -> None:
    """Add all of them."""
    parser.add_argument("body", metavar="BODY", help="a file, or file.blend:Object")
    parser.add_argument("rig", metavar="RIG", help="a file, or file.blend:Object")
    _add_pin_options(parser)
    _add_solver_options(parser)
    group = parser.add_argument_group("what is written")
    add_setting_options(group, FitRequest, only=("auto_weights",))
    add_output_options(group, Path("armature.blend"), "write where the joints are as JSON")


def _add_pin_options(parser: ArgumentParser) -> None:
    group = parser.add_argument_group("which joints are known")
    group.add_argument(
        "--pin",
        type=pinned_joint,
        nargs="+",
        action="extend",
        default=[],
        metavar="JOINT[=X,Y,Z]",
        help="joints that stay where they are, or belong in a place",
    )
    group.add_argument(
        "--place",
        type=joint_place,
        nargs="+",
        action="extend",
        default=[],
        metavar="JOINT=X,Y,Z",
        help="joints that belong inside, behind a point of the surface",
    )
    add_setting_options(group, SkeletonSettings, only=("outside_pins",))


def _add_solver_options(parser: ArgumentParser) -> None:
    group = parser.add_argument_group("how it is done")
    add_setting_options(group, FitRequest, only=("bones",))
    add_setting_options(group, SkeletonSettings, without=("outside_pins",))
