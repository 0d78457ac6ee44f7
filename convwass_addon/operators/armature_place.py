# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Place joints inside the body, behind points clicked on its surface."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy
import numpy as np
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import FloatVectorProperty
from numpy.typing import NDArray

from ..bridge.armatures.pins import pin_joints
from ..errors import ConvwassError, InputError
from ..properties.armatures import chosen_rig, depth_property
from .armature_targets import OnBody, chosen_joints, joints_property
from .mesh_targets import length_text
from .picking import PicksPoints, surface_point_at
from .reporting import refuse, reporting_errors
from .windows import write_status

if TYPE_CHECKING:
    from ..applications.skeletons.inner_points import InnerPointFinder
    from ..bridge.armatures.rig_graphs import RigGraph


class CONVWASS_OT_place_joint(PicksPoints, OnBody, bpy.types.Operator):
    """Place each selected joint in the body with a click on the surface: it moves to the middle of the volume behind the click and is pinned"""  # noqa: E501

    bl_idname = "convwass.place_joint"
    bl_label = "Place Joints"

    joints: joints_property()
    location: FloatVectorProperty(
        name="Location",
        description="Point on the surface of the body, in world space; the joint is placed behind it",
        subtype="TRANSLATION",
        options={"SKIP_SAVE"},
    )
    depth: depth_property()

    _waiting: list[str]

    @reporting_errors
    def execute(self, context):
        names = self._names(context)
        if len(names) != 1:
            raise InputError("One surface point cannot place {count} joints; name one joint.", count=len(names))
        self._finder: InnerPointFinder = _finder(context)
        self._place(context, names[0], np.array(self.location, dtype=np.float64))
        return {"FINISHED"}

    def invoke(self, context, event):
        if self.properties.is_property_set("location") or bpy.app.background:
            return self.execute(context)
        try:
            self._waiting, self._finder = self._names(context), _finder(context)
        except ConvwassError as error:
            return refuse(self, error)
        self._say(context)
        return self._wait(context)

    def _is_over(self, context):
        return chosen_rig(context) is None or context.scene.convwass_armature.body is None

    def _take(self, context, region, place):
        body, depsgraph = context.scene.convwass_armature.body, context.evaluated_depsgraph_get()
        point = surface_point_at(body, depsgraph, region, place)
        if point is None:
            self.report({"INFO"}, rpt_("This is not on the body; click on its surface"))
            return {"RUNNING_MODAL"}
        self._place(context, self._waiting[0], point)
        bpy.ops.ed.undo_push(message=rpt_("Place Joint"))
        self._waiting.pop(0)
        if not self._waiting:
            self.cancel(context)
            # Every joint already has its own undo step.
            return {"CANCELLED"}
        self._say(context)
        return {"RUNNING_MODAL"}

    def _names(self, context: bpy.types.Context) -> list[str]:
        """Return the joints to place; raises InputError if there are none or they cannot be moved."""
        from ..bridge.armatures.rigs import require_movable, rig_graph

        rig = chosen_rig(context)
        require_movable(rig)
        context.view_layer.update()
        graph = rig_graph(rig, only_deforming=False)
        return [graph.graph.names[joint] for joint in chosen_joints(rig, graph, self.joints)]

    def _say(self, context: bpy.types.Context) -> None:
        text = rpt_("Click on the body where {:s} belongs ({:d} left)    Esc: done")
        write_status(context, text.format(self._waiting[0], len(self._waiting)))

    def _place(self, context: bpy.types.Context, name: str, point: NDArray[np.float64]) -> None:
        """Move a joint behind a surface point and pin it; raises InputError if that is impossible."""
        from ..bridge.armatures.rigs import move_joints

        rig = chosen_rig(context)
        found = self._finder.find(point, self.depth)
        graph, joint = _moving_joint(rig, name)
        positions = graph.graph.positions.copy()
        positions[joint] = found.position
        # Bones are measured before the joint moves.
        pin_joints(rig, graph, [joint])
        move_joints(rig, graph, positions)
        text = rpt_("{:s} is pinned {:s} behind the surface")
        self.report({"INFO"}, text.format(name, length_text(context.scene, found.depth)))


def _moving_joint(rig: bpy.types.Object, name: str) -> tuple[RigGraph, int]:
    """Return the graph in which a joint is to move, and its number there.

    That of the deforming bones, if it is one of theirs; other bones then move along as a whole.
    """
    from ..bridge.armatures.rigs import rig_graph

    whole, deforming = rig_graph(rig, only_deforming=False), rig_graph(rig)
    joint = whole.joint(name)
    shared = set(whole.ends[joint])
    own = next((number for number, ends in enumerate(deforming.ends) if shared & set(ends)), None)
    return (whole, joint) if own is None else (deforming, own)


def _finder(context: bpy.types.Context) -> InnerPointFinder:
    """Return a finder of points inside the body, used for all clicks."""
    from ..applications.skeletons.inner_points import InnerPointFinder
    from ..bridge.armatures.rigs import resting_body

    body = context.scene.convwass_armature.body
    return InnerPointFinder(resting_body(body, chosen_rig(context), context.evaluated_depsgraph_get()))


classes = (CONVWASS_OT_place_joint,)
