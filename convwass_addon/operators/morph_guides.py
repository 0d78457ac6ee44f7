# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of guides of a morph: corresponding points, clicked or taken from names."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import EnumProperty, StringProperty

from ..bridge.flat.flat_kinds import looks_flat
from ..bridge.morphs.inputs.morph_guides import (
    NamedGuide,
    guides_from_bones,
    guides_from_empties,
    guides_from_groups,
    parsed_guide,
)
from ..bridge.object_names import object_of
from ..errors import ConvwassError, InputError
from ..properties.morph_guides import CONVWASS_PG_guide, CONVWASS_PG_guides
from ..translations import translated
from .chosen_inputs import chosen_inputs
from .lists import ClearsList, RemovesItem, SidebarList
from .picking import PicksPoints, nearest_hit, redraw_views
from .reporting import refuse, reporting_errors
from .windows import write_status


def guided_objects(context: bpy.types.Context) -> list[bpy.types.Object]:
    """Return the meshes to morph, on which guides can be placed; raises InputError if there are fewer than two."""
    objects = chosen_inputs(context, context.scene.convwass_morph).objects
    meshes = [obj for obj in objects if obj.type == "MESH"]
    if all(looks_flat(obj) for obj in objects):
        raise InputError("Flat shapes do not support guides; choose solid meshes.")
    if len(meshes) < 2:
        raise InputError("Guides are points on meshes; choose at least two meshes to morph.")
    return meshes


class _EditsGuides:
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        if context.mode != "OBJECT":
            cls.poll_message_set("Go to Object Mode first")
            return False
        return True


class CONVWASS_OT_add_morph_guide(PicksPoints, _EditsGuides, bpy.types.Operator):
    """Click on the same points of all shapes until Esc; blends join them. On symmetric shapes, one side is enough"""

    bl_idname = "convwass.add_morph_guide"
    bl_label = "Add Guide"

    label: StringProperty(name="Label", description="Name of the point, such as nose", options={"SKIP_SAVE"})
    points: StringProperty(
        name="Points",
        description='Vertices by object name, such as {"Man": 12, "Woman": 345}; empty to click on them',
        options={"SKIP_SAVE"},
    )

    def invoke(self, context, event):
        if self.points or bpy.app.background:
            return self.execute(context)
        try:
            self._shapes = guided_objects(context)
        except ConvwassError as error:
            return refuse(self, error)
        self._say(context)
        return self._wait(context)

    @reporting_errors
    def execute(self, context):
        if not self.points:
            raise InputError("Name the points of the guide: vertices by object name.")
        _add(context.scene.convwass_guides, parsed_guide(self.label, self.points))
        return {"FINISHED"}

    def cancel(self, context):
        own = context.scene.convwass_guides
        if own.items and len(own.items[-1].points) < 2:
            own.items.remove(len(own.items) - 1)
            own.active = max(len(own.items) - 1, 0)
        PicksPoints.cancel(self, context)
        redraw_views(context)

    def _is_over(self, context):
        try:
            return any(obj.name not in context.scene.objects for obj in self._shapes)
        except ReferenceError:
            return True

    def _take(self, context, region, place):
        hit = nearest_hit(self._shapes, context.evaluated_depsgraph_get(), region, place)
        if hit is None:
            self.report({"INFO"}, rpt_("This is not on any of the shapes; click on their surfaces"))
        else:
            self._place(context.scene.convwass_guides, *hit)
        self._say(context)
        redraw_views(context)
        return {"RUNNING_MODAL"}

    def _place(self, own: CONVWASS_PG_guides, obj: bpy.types.Object, vertex: int) -> None:
        """Add a clicked vertex to a guide."""
        try:
            _require_free(own, obj, vertex)
        except InputError as error:
            self.report({"INFO"}, translated(error.sentence))
            return
        guide = self._open_guide(own, obj)
        guide.place(obj, vertex)
        if len(self._marked(guide)) == len(self._shapes):
            bpy.ops.ed.undo_push(message=rpt_("Add Guide"))

    def _marked(self, guide: CONVWASS_PG_guide) -> list[bpy.types.Object]:
        """Return the shapes on which a guide has a point."""
        return [point.object for point in guide.points if point.object in self._shapes]

    def _open_guide(self, own: CONVWASS_PG_guides, obj: bpy.types.Object) -> CONVWASS_PG_guide:
        """Return the guide for a click on an object: the last one if it is incomplete, else a new one."""
        if own.items:
            on = self._marked(own.items[-1])
            # A further click on the only object so far replaces its point.
            if 0 < len(on) < len(self._shapes) and (obj not in on or len(on) == 1):
                return own.items[-1]
        own.active = len(own.items)
        return own.items.add()

    def _say(self, context: bpy.types.Context) -> None:
        """Show in the status bar what to click next."""
        own = context.scene.convwass_guides
        on = self._marked(own.items[-1]) if own.items else []
        missing, number = self._shapes, len(own.items) + 1
        if 0 < len(on) < len(self._shapes):
            missing, number = [obj for obj in self._shapes if obj not in on], len(own.items)
        names = ", ".join(obj.name for obj in missing)
        write_status(context, rpt_("Guide {:d}: click on {:s}    Esc: done").format(number, names))


def _add(own: CONVWASS_PG_guides, guide: NamedGuide) -> None:
    """Add a guide to the list.

    Raises
    ------
    InputError
        An object or vertex does not exist or is in another guide, or there are fewer than two points.
    """
    if len(guide.points) < 2:
        raise InputError("A guide connects points of at least two shapes; mark the same point on another shape, too.")
    for name, vertex in guide.points.items():
        obj = object_of(name, bpy.data.objects)
        if obj is None or obj.type != "MESH":
            raise InputError("There is no mesh object named {name}; check the points of the guide.", name=name)
        if not 0 <= vertex < len(obj.data.vertices):
            raise InputError(
                "There is no vertex {vertex}; {name} has {count} vertices.",
                vertex=vertex,
                name=name,
                count=len(obj.data.vertices),
            )
        _require_free(own, obj, vertex)
    own.add(guide)


def _require_free(own: CONVWASS_PG_guides, obj: bpy.types.Object, vertex: int) -> None:
    """Raise InputError if a vertex is already in a guide."""
    number = own.holder(obj, vertex)
    if number is not None:
        raise InputError(
            "Vertex {vertex} of {name} is already in guide {number}; choose another one, or remove that guide.",
            vertex=vertex,
            name=obj.name,
            number=number,
        )


def _is_free(own: CONVWASS_PG_guides, guide: NamedGuide) -> bool:
    points = [(object_of(name, bpy.data.objects), vertex) for name, vertex in guide.points.items()]
    return all(own.holder(*point) is None for point in points)


class CONVWASS_OT_morph_guides_from_names(_EditsGuides, bpy.types.Operator):
    """Add a guide for each name that occurs on several shapes"""

    bl_idname = "convwass.morph_guides_from_names"
    bl_label = "Guides from Names"

    kind: EnumProperty(
        name="From",
        description="What marks the points",
        items=(
            ("GROUPS", "Vertex Groups", "Small vertex groups: the central vertex of each"),
            ("EMPTIES", "Empties", "Empties such as Nose and Nose.001: the vertex nearest to each"),
            ("BONES", "Bones", "Ends of bone chains, such as fingertips and toes, of the rigs that deform the shapes"),
        ),
    )

    @reporting_errors
    def execute(self, context):
        own, depsgraph = context.scene.convwass_guides, context.evaluated_depsgraph_get()
        objects = guided_objects(context)
        if self.kind == "EMPTIES":
            found = guides_from_empties(objects, depsgraph, list(context.scene.objects))
        else:
            found = {"GROUPS": guides_from_groups, "BONES": guides_from_bones}[self.kind](objects, depsgraph)
        known = {guide.label for guide in own.items}
        new = [guide for guide in found if guide.name not in known and _is_free(own, guide)]
        if not found:
            raise InputError(
                "The shapes have no small vertex groups, Empties or bones of the same name; click on points instead."
            )
        for guide in new:
            _add(own, guide)
        self.report({"INFO"}, rpt_("{:d} guides added").format(len(new)))
        return {"FINISHED"} if new else {"CANCELLED"}


class _OnGuides(_EditsGuides):
    @classmethod
    def poll(cls, context):
        if not context.scene.convwass_guides.items:
            cls.poll_message_set("There are no guides")
            return False
        return super().poll(context)

    def _list(self, context: bpy.types.Context) -> SidebarList:
        return SidebarList(context.scene.convwass_guides, "items", "active")


class CONVWASS_OT_remove_morph_guide(_OnGuides, RemovesItem, bpy.types.Operator):
    """Remove a guide from the list"""

    bl_idname = "convwass.remove_morph_guide"
    bl_label = "Remove Guide"


class CONVWASS_OT_clear_morph_guides(_OnGuides, ClearsList, bpy.types.Operator):
    """Clear the list of guides"""

    bl_idname = "convwass.clear_morph_guides"
    bl_label = "Clear Guides"


classes = (
    CONVWASS_OT_add_morph_guide,
    CONVWASS_OT_morph_guides_from_names,
    CONVWASS_OT_remove_morph_guide,
    CONVWASS_OT_clear_morph_guides,
)
