# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of stops of a density: edit it, and find the groups to use."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
from bpy.props import EnumProperty, StringProperty

from ..bridge.linked_data import is_linked
from ..bridge.vertex_groups import group_names
from ..errors import InputError
from .chosen_inputs import split_names
from .density_targets import MODES, OnMesh, chosen_group, chosen_pair
from .lists import ClearsList, MovesItem, RemovesItem, SidebarList
from .reporting import reporting_errors


@dataclass(frozen=True)
class Stops:
    """Vertex groups, with a frame and a weight each: the points of a path, or the groups to blend.

    Attributes
    ----------
    names : list of str
        Names of the groups; empty for a place without a group.
    frames : list of float
        Scene frames.
    weights : list of float
        Used for blending.
    """

    names: list[str]
    frames: list[float]
    weights: list[float]


class StopArguments:
    """Arguments with which scripts name groups."""

    groups: StringProperty(
        name="Groups",
        description="Names of vertex groups in order, one per line or separated by commas. Empty: the list of stops "
        "or, if that is empty too, the first and the second group",
        options={"SKIP_SAVE"},
    )

    def chosen_stops(
        self,
        context: bpy.types.Context,
        steps: int,
        frames: str = "",
        weights: str = "",
        first: str = "",
        second: str = "",
    ) -> Stops:
        """Return the named stops, else the list of the object, else its first and second group.

        Raises
        ------
        InputError
            There are no names and no stops, or some numbers are invalid.
        """
        own = context.object.convwass_density
        names = split_names(self.groups, group_names(context.object)) or ([first, second] if first or second else [])
        if names or not own.stops:
            names = names or chosen_pair(context.object)
            if not all(names):
                raise InputError("Choose a first and a second group, or add groups to the list of stops.")
            start = context.scene.frame_start
            found = Stops(names, [float(start + steps * place) for place in range(len(names))], [1.0] * len(names))
        else:
            stops = own.enabled_stops
            found = Stops(
                [stop.group for stop in stops], [stop.frame for stop in stops], [stop.weight for stop in stops]
            )
        return Stops(
            names=found.names, frames=_numbers(frames) or found.frames, weights=_numbers(weights) or found.weights
        )


def named_stops(stops: Stops) -> Stops:
    """Return the stops unchanged; raises InputError if one of them has no group."""
    missing = next((place for place, name in enumerate(stops.names) if not name), None)
    if missing is not None:
        raise InputError(
            "Stop number {number} on the list has no group; choose one, or remove the stop.", number=missing
        )
    return stops


def _numbers(text: str) -> list[float]:
    try:
        return [float(word) for word in text.replace(",", " ").split()]
    except ValueError as error:
        raise InputError("Frames and weights must be numbers separated by commas, not {text!r}.", text=text) from error


class _OnOwnList(OnMesh):
    modes = frozenset(MODES)

    @classmethod
    def poll(cls, context):
        if not super().poll(context):
            return False
        # Blender does not allow changes to lists of linked objects or library overrides.
        if is_linked(context.object):
            cls.poll_message_set("Make the object local first: Object > Relations > Make Local")
            return False
        return True


class _OnStops(_OnOwnList):
    @classmethod
    def poll(cls, context):
        if not super().poll(context):
            return False
        if not context.object.convwass_density.stops:
            cls.poll_message_set("The list of stops is empty")
            return False
        return True

    def _list(self, context: bpy.types.Context) -> SidebarList:
        return SidebarList(context.object.convwass_density, "stops", "active_stop")


class CONVWASS_OT_add_density_stop(_OnOwnList, bpy.types.Operator):
    """Add vertex groups to the list of stops, with a fixed number of frames between them"""

    bl_idname = "convwass.add_density_stop"
    bl_label = "Add Stop"

    which: EnumProperty(
        name="Which",
        description="What to add to the list",
        items=(
            ("ACTIVE", "Active Group", "The active vertex group"),
            ("ALL", "All Groups", "All vertex groups that are not on the list"),
            ("EMPTY", "Place to Fill In", "A stop without a group, which Propagate fills in"),
        ),
    )
    group: StringProperty(
        name="Group", description="Name of a vertex group to add to the list instead", options={"SKIP_SAVE"}
    )

    @reporting_errors
    def execute(self, context):
        obj = context.object
        own = obj.convwass_density
        names = self._names(obj)
        for name in names:
            frame = own.stops[-1].frame + own.steps if own.stops else context.scene.frame_start
            stop = own.stops.add()
            stop.group, stop.frame = name, frame
        own.active_stop = max(len(own.stops) - 1, 0)
        return {"FINISHED"} if names else {"CANCELLED"}

    def _names(self, obj: bpy.types.Object) -> list[str]:
        if self.group or self.which == "ACTIVE":
            return [chosen_group(obj, self.group)]
        if self.which == "EMPTY":
            return [""]
        known = {stop.group for stop in obj.convwass_density.stops}
        return [group.name for group in obj.vertex_groups if group.name not in known]


class CONVWASS_OT_remove_density_stop(_OnStops, RemovesItem, bpy.types.Operator):
    """Remove a stop from the list; the vertex group is kept"""

    bl_idname = "convwass.remove_density_stop"
    bl_label = "Remove Stop"


class CONVWASS_OT_move_density_stop(_OnStops, MovesItem, bpy.types.Operator):
    """Move a group up or down the list, which is the order of the path; the frames stay in place"""

    bl_idname = "convwass.move_density_stop"
    bl_label = "Move Stop"

    def _swap(self, own: SidebarList, place: int, target: int) -> None:
        one, other = own.items[place], own.items[target]
        one.frame, other.frame = other.frame, one.frame
        super()._swap(own, place, target)


class CONVWASS_OT_clear_density_stops(_OnStops, ClearsList, bpy.types.Operator):
    """Clear the list of stops; the first and the second group are used instead"""

    bl_idname = "convwass.clear_density_stops"
    bl_label = "Clear Stops"


classes = (
    CONVWASS_OT_add_density_stop,
    CONVWASS_OT_remove_density_stop,
    CONVWASS_OT_move_density_stop,
    CONVWASS_OT_clear_density_stops,
)
