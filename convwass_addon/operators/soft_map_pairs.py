# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of corresponding vertices: edit it, or fill it from names and selections."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import IntProperty, StringProperty

from ..bridge.soft_maps.map_pairs import FoundPairs, MapPair, pairs_from_empties, pairs_from_groups
from ..errors import InputError
from ..properties.soft_maps import CONVWASS_PG_soft_map, FromGroupsProperties
from ..sentence import first_names
from .lists import ClearsList, RemovesItem, SidebarList
from .mesh_targets import selected_vertices
from .reporting import reporting_errors
from .soft_map_pick import PicksPair, require_free
from .soft_map_targets import OnMapObjects, one_selected


class CONVWASS_OT_add_map_pair(PicksPair, OnMapObjects, bpy.types.Operator):
    """Add a pair: in Edit Mode the selected vertex of each object; in Object Mode click on both objects in turn, until Esc"""  # noqa: E501

    bl_idname = "convwass.add_map_pair"
    bl_label = "Add Pair"

    label: StringProperty(name="Label", description="Name of the point, such as nose", options={"SKIP_SAVE"})
    source_vertex: IntProperty(
        name="Source Vertex",
        description="Number of a vertex of the source; -1 for the selected one",
        default=-1,
        min=-1,
        options={"SKIP_SAVE"},
    )
    target_vertex: IntProperty(
        name="Target Vertex",
        description="Number of a vertex of the target; -1 for the selected one",
        default=-1,
        min=-1,
        options={"SKIP_SAVE"},
    )

    @reporting_errors
    def execute(self, context):
        own = context.scene.convwass_soft_map
        pair = MapPair(self.label, *self._vertices(own))
        _require_new(own, pair)
        _add(own, pair)
        return {"FINISHED"}

    def _vertices(self, own: CONVWASS_PG_soft_map) -> tuple[int, int]:
        """Return the two vertices; raises InputError if the choice is ambiguous."""
        if own.source == own.target and self.source_vertex < 0 and self.target_vertex < 0:
            return _both_selected(own.source)
        given = ((own.source, self.source_vertex), (own.target, self.target_vertex))
        for obj, vertex in given:
            if vertex >= len(obj.data.vertices):
                raise InputError(
                    "There is no vertex {vertex}; {name} has {count} vertices.",
                    vertex=vertex,
                    name=obj.name,
                    count=len(obj.data.vertices),
                )
        first, second = (vertex if vertex >= 0 else one_selected(obj) for obj, vertex in given)
        return first, second


def _both_selected(obj: bpy.types.Object) -> tuple[int, int]:
    """Return the two selected vertices of an object mapped to itself, or a single vertex in the middle twice.

    Raises
    ------
    InputError
        The number of selected vertices is neither one nor two.
    """
    selected = selected_vertices(obj)
    if len(selected) not in (1, 2):
        raise InputError(
            "Select two vertices of {object} that mirror each other, or one in the middle; {count} are selected now.",
            object=obj.name,
            count=len(selected),
        )
    return selected[0], selected[-1]


def _require_new(own: CONVWASS_PG_soft_map, pair: MapPair) -> None:
    """Raise InputError if a vertex is already in a pair."""
    require_free(own, pair.source, is_source=True)
    require_free(own, pair.target, is_source=False)


def _add(own: CONVWASS_PG_soft_map, pair: MapPair) -> None:
    item = own.pairs.add()
    item.label, item.source_vertex, item.target_vertex = pair.name, pair.source, pair.target
    own.active_pair = max(len(own.pairs) - 1, 0)


class _FromNames(OnMapObjects):
    """Base of operators that make pairs from equal names."""

    @reporting_errors
    def execute(self, context):
        own = context.scene.convwass_soft_map
        found = self._found(context, own)
        if not found.pairs:
            raise self._nothing(own, found)
        new, added = [pair for pair in found.pairs if _is_new(own, pair)], []
        for pair in new:
            # Two new ones may be nearest to the same vertex.
            if _is_new(own, pair):
                _add(own, pair)
                added.append(pair)
        text = rpt_("{:d} pairs added").format(len(added))
        left_out = [*found.left_out, *(pair.name for pair in new if pair not in added)]
        if left_out:
            text += "; " + rpt_("ignored: {:s}").format(first_names(left_out))
        self.report({"INFO"}, text)
        return {"FINISHED"} if added else {"CANCELLED"}


def _is_new(own: CONVWASS_PG_soft_map, pair: MapPair) -> bool:
    try:
        _require_new(own, pair)
    except InputError:
        return False
    return True


class CONVWASS_OT_map_pairs_from_groups(FromGroupsProperties, _FromNames, bpy.types.Operator):
    """Add a pair for every small vertex group that both objects have, at the center of each; with one object as source and target, for groups such as Hand.L and Hand.R"""  # noqa: E501

    bl_idname = "convwass.map_pairs_from_groups"
    bl_label = "Pairs from Groups"

    def _found(self, context: bpy.types.Context, own: CONVWASS_PG_soft_map) -> FoundPairs:
        return pairs_from_groups(
            own.source, own.target, context.evaluated_depsgraph_get(), self.pattern or "*", self.largest
        )

    def _nothing(self, own: CONVWASS_PG_soft_map, found: FoundPairs) -> InputError:
        return InputError(
            "{source} and {target} have no small vertex groups of the same name; paint some around single points.",
            source=own.source.name,
            target=own.target.name,
        )


class CONVWASS_OT_map_pairs_from_empties(_FromNames, bpy.types.Operator):
    """Add a pair for every two Empties of the same name, such as Nose and Nose.001, one on each object: parented to it, or nearest to it"""  # noqa: E501

    bl_idname = "convwass.map_pairs_from_empties"
    bl_label = "Pairs from Empties"

    def _found(self, context: bpy.types.Context, own: CONVWASS_PG_soft_map) -> FoundPairs:
        return pairs_from_empties(own.source, own.target, context.evaluated_depsgraph_get(), context.scene.objects)

    def _nothing(self, own: CONVWASS_PG_soft_map, found: FoundPairs) -> InputError:
        return InputError(
            "There are no two Empties of the same name, one on {source} and one on {target}; place some, such as Nose "
            "and Nose.001.",
            source=own.source.name,
            target=own.target.name,
        )


class _OnPairs(OnMapObjects):
    @classmethod
    def poll(cls, context):
        if not context.scene.convwass_soft_map.pairs:
            cls.poll_message_set("The list of pairs is empty")
            return False
        return True

    def _list(self, context: bpy.types.Context) -> SidebarList:
        return SidebarList(context.scene.convwass_soft_map, "pairs", "active_pair")


class CONVWASS_OT_remove_map_pair(_OnPairs, RemovesItem, bpy.types.Operator):
    """Remove a pair from the list"""

    bl_idname = "convwass.remove_map_pair"
    bl_label = "Remove Pair"


class CONVWASS_OT_clear_map_pairs(_OnPairs, ClearsList, bpy.types.Operator):
    """Clear the list of pairs"""

    bl_idname = "convwass.clear_map_pairs"
    bl_label = "Clear Pairs"


class CONVWASS_OT_swap_map_objects(OnMapObjects, bpy.types.Operator):
    """Swap source and target, in all pairs too; a stored map works in both directions"""

    bl_idname = "convwass.swap_map_objects"
    bl_label = "Swap Source and Target"

    def execute(self, context):
        context.scene.convwass_soft_map.swap()
        return {"FINISHED"}


classes = (
    CONVWASS_OT_add_map_pair,
    CONVWASS_OT_map_pairs_from_groups,
    CONVWASS_OT_map_pairs_from_empties,
    CONVWASS_OT_remove_map_pair,
    CONVWASS_OT_clear_map_pairs,
    CONVWASS_OT_swap_map_objects,
)
