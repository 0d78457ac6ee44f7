# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of fitting armatures, as each scene has its own, and the pins of bones."""

from __future__ import annotations

import bpy
from bpy.props import BoolProperty, FloatProperty, PointerProperty

from ..applications.skeletons.skeleton_settings import SkeletonSettings
from ..bridge.active import active_object
from ..bridge.armatures.fit_request import FitRequest
from ..bridge.armatures.joint_dots import JointDots
from ..bridge.armatures.pins import KINDS, register_pins, unregister_pins
from .from_schema import values_of, with_properties


@with_properties(FitRequest)
@with_properties(SkeletonSettings)
class FitProperties:
    """What the fit of an armature is asked for."""

    def skeleton_settings(self) -> SkeletonSettings:
        """Return the settings of the application; raises InputError where they make no sense."""
        return SkeletonSettings(**values_of(self, SkeletonSettings))


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


def is_mesh(_settings: bpy.types.PropertyGroup, obj: bpy.types.Object) -> bool:
    """Whether an object can be a body, as the panel asks."""
    return obj.type == "MESH"


def is_rig(_settings: bpy.types.PropertyGroup, obj: bpy.types.Object) -> bool:
    """Whether an object can be a rig: an armature, or a mesh of edges alone."""
    return obj.type == "ARMATURE" or (obj.type == "MESH" and not obj.data.polygons and bool(obj.data.edges))


class CONVWASS_PG_armature(FitProperties, bpy.types.PropertyGroup):
    """Settings of fitting armatures in a scene."""

    body: PointerProperty(
        name="Body", description="Mesh that the armature is fitted into", type=bpy.types.Object, poll=is_mesh
    )
    rig: PointerProperty(
        name="Armature",
        description="Armature that is fitted, or a mesh of edges without faces; while there is none, the active one",
        type=bpy.types.Object,
        poll=is_rig,
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


def dotted_rig(context: bpy.types.Context) -> bpy.types.Object | None:
    """Return the rig whose joints are drawn: only where somebody works on one with the panel."""
    own = context.scene.convwass_armature
    rig = chosen_rig(context) if own.show_joints and own.body is not None else None
    return rig if rig is not None and rig.type in KINDS else None


_classes = (CONVWASS_PG_armature,)
_register_classes, _unregister_classes = bpy.utils.register_classes_factory(_classes)
_dots = JointDots(dotted_rig)


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
