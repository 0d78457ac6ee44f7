# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Place joints inside the body, behind the points of its surface that are clicked on."""

from __future__ import annotations

import bpy
import numpy as np
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import FloatVectorProperty
from bpy_extras.view3d_utils import region_2d_to_origin_3d, region_2d_to_vector_3d
from numpy.typing import NDArray

from ..applications.skeletons.inner_points import InnerPointFinder
from ..armature_properties import chosen_rig, depth_property
from ..bridge.armatures.rigs import move_joints, pin_joints, require_movable, resting_body, rig_graph
from ..errors import ConvwassError, InputError
from .armature_targets import OnBody, chosen_joints, joints_property
from .density_pick import view_at
from .density_targets import length_text
from .reporting import refuse


class CONVWASS_OT_place_joint(OnBody, bpy.types.Operator):
    """Put the selected joints into the body with one click each on its surface: each goes to the middle of what is behind the click, and is pinned"""  # noqa: E501

    bl_idname = "convwass.place_joint"
    bl_label = "Place Joints"

    joints: joints_property()
    location: FloatVectorProperty(
        name="Location",
        description="Point on the surface of the body, in world space, behind which the joint goes",
        subtype="TRANSLATION",
        options={"SKIP_SAVE"},
    )
    depth: depth_property()

    _waiting: list[str]
    _finder: InnerPointFinder

    def execute(self, context):
        try:
            names = self._names(context)
            if len(names) != 1:
                raise InputError(
                    "A point of the surface is for one joint, not for {count}; name one.", count=len(names)
                )
            self._finder = _finder(context)
            self._place(context, names[0], np.array(self.location, dtype=np.float64))
        except ConvwassError as error:
            return refuse(self, error)
        return {"FINISHED"}

    def invoke(self, context, event):
        if self.properties.is_property_set("location") or bpy.app.background:
            return self.execute(context)
        try:
            self._waiting, self._finder = self._names(context), _finder(context)
        except ConvwassError as error:
            return refuse(self, error)
        context.window_manager.modal_handler_add(self)
        context.window.cursor_modal_set("EYEDROPPER")
        self._say(context)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        is_gone = chosen_rig(context) is None or context.scene.convwass_armature.body is None
        if is_gone or (event.type in ("ESC", "RIGHTMOUSE", "RET") and event.value == "PRESS"):
            self.cancel(context)
            # Every joint has its own undo step by now.
            return {"CANCELLED"}
        if event.type != "LEFTMOUSE" or event.value != "PRESS":
            return {"PASS_THROUGH"}
        region = view_at(context.window, event.mouse_x, event.mouse_y)
        if region is None:
            return {"PASS_THROUGH"}
        place = event.mouse_x - region.x, event.mouse_y - region.y
        try:
            point = surface_point_at(context, context.scene.convwass_armature.body, region, place)
            if point is None:
                self.report({"INFO"}, rpt_("There is nothing of the body; click on its surface"))
                return {"RUNNING_MODAL"}
            self._place(context, self._waiting[0], point)
        except ConvwassError as error:
            self.cancel(context)
            return refuse(self, error)
        bpy.ops.ed.undo_push(message=rpt_("Place Joint"))
        self._waiting.pop(0)
        if not self._waiting:
            self.cancel(context)
            return {"CANCELLED"}
        self._say(context)
        return {"RUNNING_MODAL"}

    def cancel(self, context):
        context.window.cursor_modal_restore()
        context.workspace.status_text_set(None)

    def _names(self, context: bpy.types.Context) -> list[str]:
        """Return the joints that are meant; raises InputError where there are none, or they cannot be moved."""
        rig = chosen_rig(context)
        require_movable(rig)
        context.view_layer.update()
        graph = rig_graph(rig, only_deforming=False)
        return [graph.graph.names[joint] for joint in chosen_joints(rig, graph, self.joints)]

    def _say(self, context: bpy.types.Context) -> None:
        text = rpt_("Click on the body where {:s} belongs ({:d} to go)    Esc: done")
        context.workspace.status_text_set(text.format(self._waiting[0], len(self._waiting)))

    def _place(self, context: bpy.types.Context, name: str, point: NDArray[np.float64]) -> None:
        """Move a joint behind a point of the surface and pin it; raises InputError where that cannot be."""
        rig = chosen_rig(context)
        found = self._finder.find(point, self.depth)
        graph = rig_graph(rig, only_deforming=False)
        joint = graph.joint(name)
        positions = graph.graph.positions.copy()
        positions[joint] = found.position
        # Before it is moved, for the lengths of its bones.
        pin_joints(rig, graph, [joint], True)
        move_joints(rig, graph, positions)
        text = rpt_("{:s} is pinned {:s} behind the surface")
        self.report({"INFO"}, text.format(name, length_text(context.scene, found.depth)))


def _finder(context: bpy.types.Context) -> InnerPointFinder:
    """Return what finds points inside of the body, for as many clicks as there will be."""
    body = context.scene.convwass_armature.body
    return InnerPointFinder(resting_body(body, chosen_rig(context), context.evaluated_depsgraph_get()))


def surface_point_at(
    context: bpy.types.Context, obj: bpy.types.Object, region: bpy.types.Region, place: tuple[int, int]
) -> NDArray[np.float64] | None:
    """Return the point of an object's surface that a point of a view shows, world space; None for nothing."""
    evaluated = obj.evaluated_get(context.evaluated_depsgraph_get())
    matrix = evaluated.matrix_world
    inverse = matrix.inverted_safe()
    origin = inverse @ region_2d_to_origin_3d(region, region.data, place)
    direction = inverse.to_3x3() @ region_2d_to_vector_3d(region, region.data, place)
    is_hit, location, _, _ = evaluated.ray_cast(origin, direction)
    return np.array(matrix @ location, dtype=np.float64) if is_hit else None


classes = (CONVWASS_OT_place_joint,)
