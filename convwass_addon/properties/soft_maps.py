# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of soft maps, stored in the scene: two objects, pairs of vertices, what to transfer."""

from __future__ import annotations

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from ..applications.soft_maps.soft_map_settings import SoftMapSettings
from ..bridge.soft_maps.pair_labels import LabeledVertex, PairLabels
from ..bridge.soft_maps.soft_map_requests import MapRequest, TransferRequest
from ..bridge.vertex_places import Place, has_vertex, vertex_now
from .from_schema import values_of, with_properties
from .registration import registration
from .vertex_places import CONVWASS_PG_vertex_place

TRANSFERRED = (
    ("GROUPS", "Vertex Groups", "Weights of vertex groups"),
    ("KEYS", "Shape Keys", "Deformations of shape keys, rotated and stretched with the surface"),
    ("UVS", "UV Maps", "UV maps with their seams"),
    ("COLORS", "Color Attributes", "Colors of vertices or of face corners"),
)
"""The kinds of data to transfer, as items of an enum."""


@with_properties(MapRequest)
@with_properties(SoftMapSettings)
class SoftMapProperties:
    """Properties of a soft map."""

    def soft_map_settings(self) -> SoftMapSettings:
        """Return the settings of the application; raises InputError if they are invalid."""
        return SoftMapSettings(**values_of(self, SoftMapSettings))


@with_properties(TransferRequest)
class TransferProperties:
    """Properties of a transfer."""

    what: EnumProperty(
        name="What",
        description="Data to transfer",
        items=TRANSFERRED,
        default={"GROUPS"},
        options={"ENUM_FLAG"},
    )


class FromGroupsProperties:
    """Properties for finding pairs from vertex groups."""

    pattern: StringProperty(
        name="Pattern",
        description="Pattern for the names of the groups; * and ? are wildcards",
        default="*",
    )
    largest: FloatProperty(
        name="Largest",
        description="Largest share of the vertices that a group may have; larger groups do not mark a point and are "
        "ignored",
        default=0.05,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
    )


def threshold_property() -> object:
    """Return the property for the confidence threshold of a repair."""
    return FloatProperty(
        name="Threshold",
        description="Vertices with a confidence below this get an image interpolated from their neighbors",
        default=0.3,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
    )


def _is_mesh(_settings: bpy.types.PropertyGroup, obj: bpy.types.Object) -> bool:
    return obj.type == "MESH"


def _place(obj: bpy.types.Object | None, vertex: int) -> Place | None:
    return Place.of(obj, vertex) if obj is not None and has_vertex(obj, vertex) else None


def _place_source(pair: CONVWASS_PG_map_pair, _context: bpy.types.Context) -> None:
    pair.source_place.place = _place(pair.id_data.convwass_soft_map.source, pair.source_vertex)


def _place_target(pair: CONVWASS_PG_map_pair, _context: bpy.types.Context) -> None:
    pair.target_place.place = _place(pair.id_data.convwass_soft_map.target, pair.target_vertex)


class CONVWASS_PG_map_pair(bpy.types.PropertyGroup):
    """A vertex of the source and the corresponding vertex of the target."""

    label: StringProperty(name="Label", description="Name of the point, such as nose")
    source_vertex: IntProperty(
        name="Source Vertex",
        description="Vertex number on the source; -1 if not set",
        default=-1,
        min=-1,
        update=_place_source,
    )
    target_vertex: IntProperty(
        name="Target Vertex",
        description="Vertex number on the target; -1 if not set",
        default=-1,
        min=-1,
        update=_place_target,
    )
    enabled: BoolProperty(name="Enabled", description="Whether this pair is used", default=True)
    source_place: PointerProperty(name="Source Vertex", type=CONVWASS_PG_vertex_place)
    target_place: PointerProperty(name="Target Vertex", type=CONVWASS_PG_vertex_place)

    @property
    def is_complete(self) -> bool:
        """Whether both vertices are set."""
        return self.source_vertex >= 0 and self.target_vertex >= 0


def _place_sources(own: CONVWASS_PG_soft_map, context: bpy.types.Context) -> None:
    for pair in own.pairs:
        _place_source(pair, context)


def _place_targets(own: CONVWASS_PG_soft_map, context: bpy.types.Context) -> None:
    for pair in own.pairs:
        _place_target(pair, context)


class CONVWASS_PG_soft_map(SoftMapProperties, TransferProperties, FromGroupsProperties, bpy.types.PropertyGroup):
    """Settings of the soft maps in a scene."""

    source: PointerProperty(
        name="Source",
        description="Object that the map starts from; it stores the map",
        type=bpy.types.Object,
        poll=_is_mesh,
        update=_place_sources,
    )
    target: PointerProperty(
        name="Target",
        description="Object that the map leads to",
        type=bpy.types.Object,
        poll=_is_mesh,
        update=_place_targets,
    )
    pairs: CollectionProperty(
        name="Pairs", description="Corresponding vertices of both objects", type=CONVWASS_PG_map_pair
    )
    active_pair: IntProperty(name="Active Pair", description="The pair that the buttons next to the list act on", min=0)
    show_labels: BoolProperty(
        name="Show Numbers",
        description="Show the number of each pair at its two vertices in the viewport",
        default=True,
    )
    threshold: threshold_property()

    @property
    def used_pairs(self) -> list[CONVWASS_PG_map_pair]:
        """The enabled, complete pairs."""
        return [pair for pair in self.pairs if pair.enabled and pair.is_complete]

    def vertices_now(self, pair: CONVWASS_PG_map_pair) -> tuple[int | None, int | None]:
        """Return the vertices that are now where those of a pair were chosen; see :func:`.vertex_places.vertex_now`."""
        ends = (
            (self.source, pair.source_vertex, pair.source_place),
            (self.target, pair.target_vertex, pair.target_place),
        )
        return tuple(None if obj is None else vertex_now(obj, vertex, then.place) for obj, vertex, then in ends)

    def renew(self) -> None:
        """Store which vertices are now at the pairs, and where, for the next time that some are deleted."""
        for pair in self.pairs:
            source, target = self.vertices_now(pair)
            if source is not None:
                pair.source_vertex = source
            if target is not None:
                pair.target_vertex = target

    def swap(self) -> None:
        """Swap source and target, in all pairs too."""
        places = [(pair.target_place.place, pair.source_place.place) for pair in self.pairs]
        self.source, self.target = self.target, self.source
        for pair, swapped in zip(self.pairs, places, strict=True):
            pair.source_vertex, pair.target_vertex = pair.target_vertex, pair.source_vertex
            # The vertices of now may be others.
            pair.source_place.place, pair.target_place.place = swapped


def labeled_vertices(context: bpy.types.Context) -> list[LabeledVertex]:
    """Return the vertices that show a number in the viewport."""
    own = context.scene.convwass_soft_map
    if not own.show_labels:
        return []
    found = []
    for number, pair in enumerate(own.pairs, start=1):
        for obj, vertex in zip((own.source, own.target), own.vertices_now(pair), strict=True):
            if vertex is not None and pair.enabled:
                found.append(LabeledVertex(obj, vertex, number))
    return found


register, unregister = registration(
    (CONVWASS_PG_vertex_place, CONVWASS_PG_map_pair, CONVWASS_PG_soft_map),
    ((bpy.types.Scene, "convwass_soft_map", CONVWASS_PG_soft_map),),
    (PairLabels(labeled_vertices),),
)
