# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The two objects of a soft map, the poll methods of its operators, and the stored map."""

from __future__ import annotations

from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass

import bpy

from ..applications.soft_maps.surface_maps import PointMap
from ..bridge.active import active_object
from ..bridge.soft_maps.soft_map_bytes import MappedSide, StoredSoftMap
from ..bridge.soft_maps.soft_map_store import MapState, has_soft_map, map_state, stored_soft_map
from ..errors import InputError
from ..sentence import Sentence
from .background import is_idle
from .mesh_targets import out_of_edit_mode, selected_vertices

# Other modes hold on to the mesh.
_MODES = frozenset({"OBJECT", "PAINT_WEIGHT", "PAINT_VERTEX", "EDIT_MESH", "POSE"})


class OnMapObjects:
    """Base of operators on the source and target chosen in the panel."""

    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        own = context.scene.convwass_soft_map
        # The panel only offers meshes, but scripts can set other objects, and objects can get other data.
        if not all(obj is not None and obj.type == "MESH" for obj in (own.source, own.target)):
            cls.poll_message_set("Choose a source and a target")
            return False
        if not (own.source.users_scene and own.target.users_scene):
            cls.poll_message_set("The source or the target has been deleted; choose another one")
            return False
        if context.mode not in _MODES:
            cls.poll_message_set("Go to Object Mode first")
            return False
        return is_idle(cls, context)


class OnStoredMap(OnMapObjects):
    """Base of operators on the stored map between the two objects."""

    @classmethod
    def poll(cls, context):
        if not super().poll(context):
            return False
        if mapped_objects(context) is None:
            cls.poll_message_set("Compute the soft map first")
            return False
        return True


@dataclass(frozen=True)
class StoredWay:
    """A stored map and its objects.

    Attributes
    ----------
    source, target : bpy.types.Object
        Source and target when the map was computed; the source stores it.
    stored : StoredSoftMap
        The map.
    """

    source: bpy.types.Object
    target: bpy.types.Object
    stored: StoredSoftMap

    def point_map(self, receiver: bpy.types.Object) -> PointMap:
        """Return the map that gives a point of the other object for every vertex of the receiver."""
        return self.stored.found.forward if receiver == self.source else self.stored.found.backward

    def side(self, obj: bpy.types.Object) -> MappedSide:
        """Return the stored data of one of the meshes."""
        return self.stored.source if obj == self.source else self.stored.target


def mapped_objects(context: bpy.types.Context) -> tuple[bpy.types.Object, bpy.types.Object] | None:
    """Return source and target of the stored map between the chosen objects, or None.

    Its direction may differ from the current choice. Fast enough for a panel.
    """
    own = context.scene.convwass_soft_map
    ways = ((own.source, own.target), (own.target, own.source))
    return next((way for way in ways if None not in way and has_soft_map(*way)), None)


def current_way(context: bpy.types.Context) -> StoredWay:
    """Read the map between the two objects.

    Raises
    ------
    InputError
        There is no map, it is damaged, or the vertices or faces of a mesh have changed since.
    """
    own = context.scene.convwass_soft_map
    source, target = mapped_objects(context) or (own.source, own.target)
    way = StoredWay(source, target, stored_soft_map(source, target))
    for obj in (source, target):
        if map_state(obj, way.side(obj)) is MapState.OTHER:
            raise InputError(
                "The vertices or faces of {object} have changed since its soft map was computed; compute it again.",
                object=obj.name,
            )
    return way


def reshaped_notices(way: StoredWay) -> list[Sentence]:
    """Return notices about meshes that were reshaped since."""
    reshaped = [obj for obj in {way.source, way.target} if map_state(obj, way.side(obj)) is MapState.RESHAPED]
    return [
        Sentence(
            "{object} was reshaped since its soft map was computed; compute it again if it does not fit.",
            {"object": obj.name},
        )
        for obj in sorted(reshaped, key=lambda obj: obj.name)
    ]


def one_selected(obj: bpy.types.Object) -> int:
    """Return the only selected vertex; raises InputError unless exactly one is selected."""
    selected = selected_vertices(obj)
    if len(selected) != 1:
        raise InputError(
            "Select one vertex of {object} in Edit Mode; {count} are selected now.",
            object=obj.name,
            count=len(selected),
        )
    return selected[0]


def edit_mode_left(context: bpy.types.Context) -> AbstractContextManager[None]:
    """Leave Edit Mode temporarily, for all objects in it."""
    active = active_object(context)
    return nullcontext() if active is None else out_of_edit_mode(context, active)
