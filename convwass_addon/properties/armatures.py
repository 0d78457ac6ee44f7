# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of fitting armatures, as each scene has its own, and the pins of bones."""

from __future__ import annotations

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty

from ..applications.skeletons.skeleton_settings import SkeletonSettings
from ..bridge.active import active_object
from ..bridge.armatures.joint_dots import JointDots
from ..bridge.armatures.pins import KINDS, register_pins, unregister_pins


class FitProperties:
    """What the fit of an armature is asked for."""

    gamma: FloatProperty(
        name="Blur",
        description="How much is blurred on the surface of the body, rescaled to an area of 1: with more, joints come "
        "to lie deeper and bones straighter, with too much all of them in the middle",
        default=SkeletonSettings.gamma,
        min=1e-5,
        soft_min=0.001,
        soft_max=0.01,
        max=1.0,
        precision=4,
        step=0.05,
    )
    weights: EnumProperty(
        name="Lengths",
        description="How bones share the way between pinned joints",
        items=(
            (
                "LENGTH",
                "Proportional",
                "Bones keep the proportions that they had when the first joint was pinned; Unpin All forgets those",
            ),
            ("UNIFORM", "All Alike", "All bones take up as much of the way"),
        ),
    )
    placement: EnumProperty(
        name="Placement",
        description="Where joints go in what they are next to",
        items=(
            ("CENTERED", "Centered", "Settle joints along the middle of the limbs"),
            (
                "EXPECTED",
                "As Published",
                "Leave joints at the means of their distributions, as in the paper; where limbs are thin or bent, "
                "those leave the body",
            ),
        ),
    )
    bones: EnumProperty(
        name="Bones",
        description="Which bones are fitted",
        items=(
            (
                "DEFORM",
                "That Deform",
                "Bones that deform meshes, or all if none does; others, such as handles of controls, go along with "
                "the joints next to them",
            ),
            ("ALL", "All", "All bones, those of controls too"),
        ),
    )
    links: IntProperty(
        name="Links",
        description="Parts that a bone is cut into while it is laid out, so that it can bend with the body",
        default=SkeletonSettings.links,
        min=1,
        soft_max=6,
        max=20,
    )
    limit_spread: BoolProperty(
        name="Limit Spread",
        description="Keep what moves along the surface from spreading out more than the pinned joints do, which "
        "follows thin limbs more closely but lies less deep",
        default=False,
    )
    slack: FloatProperty(
        name="Slack",
        description="How much more it may spread out than the pinned joints do, in nats; less than 1 may not come to "
        "an end",
        default=1.0,
        min=0.0,
        soft_max=5.0,
        max=20.0,
    )
    outside_pins: EnumProperty(
        name="Pins Outside",
        description="What to do with joints that are pinned outside of the body",
        items=(
            ("REFUSE", "Refuse", "Say which they are, and change nothing"),
            ("MOVE", "Move Inside", "Move them to the nearest place inside"),
        ),
    )
    thickness: FloatProperty(
        name="Thickness",
        description="Thickness that is given to surfaces which enclose nothing, and that closes gaps between parts; 0 "
        "for none",
        default=0.0,
        min=0.0,
        soft_max=1.0,
        subtype="DISTANCE",
    )
    auto_weights: BoolProperty(
        name="Automatic Weights",
        description="Bind the body to the armature afterwards, with Blender's automatic weights; they replace those of "
        "groups that are named like the bones",
        default=False,
    )

    def skeleton_settings(self) -> SkeletonSettings:
        """Return the settings of the application; raises InputError where they make no sense."""
        return SkeletonSettings(
            gamma=self.gamma,
            slack=self.slack if self.limit_spread else None,
            weights=self.weights.lower(),
            links=self.links,
            placement=self.placement.lower(),
            outside_pins=self.outside_pins.lower(),
            thickness=self.thickness,
        )


def depth_property() -> object:
    """Return the property of how far behind the surface a joint is placed."""
    return FloatProperty(
        name="Depth",
        description="How far behind the surface joints are placed by a click: 1 is the middle of the body there, less "
        "stays closer to the surface",
        default=1.0,
        min=0.05,
        soft_min=0.2,
        soft_max=2.0,
        max=10.0,
    )


def _is_mesh(_settings: bpy.types.PropertyGroup, obj: bpy.types.Object) -> bool:
    return obj.type == "MESH"


def _is_rig(_settings: bpy.types.PropertyGroup, obj: bpy.types.Object) -> bool:
    return obj.type == "ARMATURE" or (obj.type == "MESH" and not obj.data.polygons and bool(obj.data.edges))


class CONVWASS_PG_armature(FitProperties, bpy.types.PropertyGroup):
    """Settings of fitting armatures in a scene."""

    body: PointerProperty(
        name="Body", description="Mesh that the armature is fitted into", type=bpy.types.Object, poll=_is_mesh
    )
    rig: PointerProperty(
        name="Armature",
        description="Armature that is fitted, or a mesh of edges without faces; while there is none, the active one",
        type=bpy.types.Object,
        poll=_is_rig,
    )
    depth: depth_property()
    show_joints: BoolProperty(
        name="Show Joints",
        description="Draw dots on the joints in the viewport: green ones are pinned, blue ones are free",
        default=True,
    )


def chosen_rig(context: bpy.types.Context) -> bpy.types.Object | None:
    """Return the rig that is chosen in the panel, or else the active armature; None where there is neither."""
    own = context.scene.convwass_armature
    if own.rig is not None:
        return own.rig
    active = active_object(context)
    return active if active is not None and active.type == "ARMATURE" else None


def _dotted_rig(context: bpy.types.Context) -> bpy.types.Object | None:
    """Return the rig whose joints are drawn: only where somebody works on one with the panel."""
    own = context.scene.convwass_armature
    rig = chosen_rig(context) if own.show_joints and own.body is not None else None
    return rig if rig is not None and rig.type in KINDS else None


_classes = (CONVWASS_PG_armature,)
_register_classes, _unregister_classes = bpy.utils.register_classes_factory(_classes)
_dots = JointDots(_dotted_rig)


def register() -> None:
    """Add the settings to scenes and the pins to bones, and draw the joints."""
    _register_classes()
    bpy.types.Scene.convwass_armature = PointerProperty(type=CONVWASS_PG_armature)
    register_pins()
    _dots.register()


def unregister() -> None:
    """Take them away."""
    _dots.unregister()
    unregister_pins()
    del bpy.types.Scene.convwass_armature
    _unregister_classes()
