# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings for fitting armatures, stored in the scene, and the pins of bones."""

from __future__ import annotations

import bpy
from bpy.props import BoolProperty, FloatProperty, PointerProperty

from ..applications.skeletons.skeleton_settings import SkeletonSettings
from ..bridge.active import active_object
from ..bridge.armatures.fit_request import FitRequest
from ..bridge.armatures.joint_dots import JointDots
from ..bridge.armatures.pins import KINDS, register_pins, unregister_pins
from .from_schema import values_of, with_properties
from .registration import registration


@with_properties(FitRequest)
@with_properties(SkeletonSettings)
class FitProperties:
    """Properties of a fit."""

    def skeleton_settings(self) -> SkeletonSettings:
        """Return the settings of the application; raises InputError if they are invalid."""
        return SkeletonSettings(**values_of(self, SkeletonSettings))


def depth_property() -> object:
    """Return the property for the depth of joints below the surface."""
    return FloatProperty(
        name="Depth",
        description="How far below the clicked surface point a joint is placed: 1 is the middle of the body, smaller "
        "values are closer to the surface",
        default=1.0,
        min=0.05,
        soft_min=0.2,
        soft_max=2.0,
        max=10.0,
    )


def is_mesh(_settings: bpy.types.PropertyGroup, obj: bpy.types.Object) -> bool:
    """Poll of the body: return whether an object is a mesh."""
    return obj.type == "MESH"


def is_rig(_settings: bpy.types.PropertyGroup, obj: bpy.types.Object) -> bool:
    """Poll of the rig: return whether an object is an armature, or a mesh with edges but no faces."""
    return obj.type == "ARMATURE" or (obj.type == "MESH" and not obj.data.polygons and bool(obj.data.edges))


class CONVWASS_PG_armature(FitProperties, bpy.types.PropertyGroup):
    """Settings for fitting armatures in a scene."""

    body: PointerProperty(name="Body", description="Mesh to fit the armature into", type=bpy.types.Object, poll=is_mesh)
    rig: PointerProperty(
        name="Armature",
        description="Armature to fit, or a mesh of edges without faces; if empty, the active armature",
        type=bpy.types.Object,
        poll=is_rig,
    )
    depth: depth_property()
    show_joints: BoolProperty(
        name="Show Joints",
        description="Draw dots on the joints in the viewport: green for pinned joints, blue for free joints",
        default=True,
    )


def chosen_rig(context: bpy.types.Context) -> bpy.types.Object | None:
    """Return the rig chosen in the panel, else the active armature, else None."""
    own = context.scene.convwass_armature
    if own.rig is not None:
        return own.rig
    active = active_object(context)
    return active if active is not None and active.type == "ARMATURE" else None


def dotted_rig(context: bpy.types.Context) -> bpy.types.Object | None:
    """Return the rig whose joints are drawn, or None if the panel is not in use."""
    own = context.scene.convwass_armature
    rig = chosen_rig(context) if own.show_joints and own.body is not None else None
    return rig if rig is not None and rig.type in KINDS else None


_register, _unregister = registration(
    (CONVWASS_PG_armature,),
    ((bpy.types.Scene, "convwass_armature", CONVWASS_PG_armature),),
    (JointDots(dotted_rig),),
)


def register() -> None:
    """Add the settings to scenes and the pins to bones, and draw the joints."""
    register_pins()
    _register()


def unregister() -> None:
    """Remove them."""
    _unregister()
    unregister_pins()
