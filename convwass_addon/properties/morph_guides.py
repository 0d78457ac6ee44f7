# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The guides of morphs, stored in the scene: corresponding points of the shapes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from ..bridge.morphs.inputs.morph_guides import NamedGuide
from ..bridge.object_names import object_of, unique_name
from ..bridge.soft_maps.pair_labels import LabeledVertex, PairLabels
from ..bridge.vertex_places import Place, has_vertex, vertex_now
from ..sentence import Sentence
from .registration import registration
from .vertex_places import PlaceProperties


class CONVWASS_PG_guide_point(PlaceProperties, bpy.types.PropertyGroup):
    """A vertex of a shape."""

    object: PointerProperty(name="Shape", description="Object that the point is on", type=bpy.types.Object)
    vertex: IntProperty(name="Vertex", description="Number of the vertex when it was chosen", min=0)

    @property
    def vertex_now(self) -> int | None:
        """The vertex that is there now, or None; see :func:`.vertex_places.vertex_now`."""
        return vertex_now(self.object, self.vertex, self.place)

    def put(self, obj: bpy.types.Object, vertex: int, place: Place | None = None) -> None:
        """Set the vertex, and where it was; by default, where it is."""
        self.object, self.vertex = obj, vertex
        if place is None and has_vertex(obj, vertex):
            place = Place.of(obj, vertex)
        if place is not None:
            self.place = place


class CONVWASS_PG_guide(bpy.types.PropertyGroup):
    """Corresponding points of several shapes."""

    label: StringProperty(name="Label", description="Name of the point, such as nose")
    points: CollectionProperty(name="Points", description="One point per shape", type=CONVWASS_PG_guide_point)
    enabled: BoolProperty(name="Enabled", description="Whether this guide is used", default=True)

    @property
    def there(self) -> list[CONVWASS_PG_guide_point]:
        """The points without those on deleted objects."""
        # Objects deleted in the viewport still exist as long as a pointer refers to them.
        return [point for point in self.points if point.object is not None and point.object.users_scene]

    @property
    def vertices(self) -> dict[bpy.types.Object, int | None]:
        """The vertices by object that are now at the points, without those on deleted objects."""
        return {point.object: point.vertex_now for point in self.there}

    @property
    def named(self) -> NamedGuide:
        """The guide by names of objects, as it was chosen, without points on deleted objects."""
        points = {unique_name(point.object): point for point in self.there}
        places = {name: point.place for name, point in points.items() if point.count}
        return NamedGuide(self.label, {name: point.vertex for name, point in points.items()}, places)

    @property
    def problem(self) -> Sentence | None:
        """Why the guide cannot be used, or None."""
        there = self.there
        if len(there) < 2:
            return Sentence("Needs a point on another shape")
        return next((_lost(point) for point in there if point.vertex_now is None), None)

    def place(self, obj: bpy.types.Object, vertex: int, place: Place | None = None) -> None:
        """Set the point on an object, replacing an existing one; by default, its vertex was where it is."""
        point = next((point for point in self.points if point.object == obj), None) or self.points.add()
        point.put(obj, vertex, place)


class CONVWASS_PG_guides(bpy.types.PropertyGroup):
    """Guides of the morphs of a scene."""

    items: CollectionProperty(name="Guides", description="Corresponding points of the shapes", type=CONVWASS_PG_guide)
    active: IntProperty(name="Active Guide", description="The guide that the buttons next to the list act on", min=0)
    show_labels: BoolProperty(
        name="Show Numbers",
        description="Show the number of each guide at its points in the viewport",
        default=True,
    )

    @property
    def named(self) -> list[NamedGuide]:
        """The enabled guides with points on at least two shapes."""
        found = []
        for number, guide in enumerate(self.items, start=1):
            named = guide.named
            if guide.enabled and len(named.points) > 1:
                # Messages refer to a guide without a label by its number in the panel.
                found.append(replace(named, name=named.name or str(number)))
        return found

    def holder(self, obj: bpy.types.Object, vertex: int) -> int | None:
        """Return the number, from 1, of the guide that uses a vertex of an object, or None."""
        numbers = (number for number, guide in enumerate(self.items, start=1) if guide.vertices.get(obj) == vertex)
        return next(numbers, None)

    def add(self, guide: NamedGuide) -> None:
        """Add a guide to the list, without points on objects that no longer exist."""
        self._add(guide, _objects(guide, ()))

    def take(self, guides: Sequence[NamedGuide], inputs: Sequence[bpy.types.Object]) -> None:
        """Add the guides of a morph that are not on the list yet, on its inputs if these have the names."""
        known = [item.vertices for item in self.items]
        for guide in guides:
            objects = _objects(guide, inputs)
            now = {obj: vertex_now(obj, guide.points[name], guide.places.get(name)) for name, obj in objects.items()}
            if now not in known:
                self._add(guide, objects)

    def renew(self) -> None:
        """Store which vertices are now at the points, and where, for the next time that some are deleted."""
        for point in [point for item in self.items for point in item.there]:
            vertex = point.vertex_now
            if vertex is not None:
                point.put(point.object, vertex)

    def _add(self, guide: NamedGuide, objects: Mapping[str, bpy.types.Object]) -> None:
        item = self.items.add()
        item.label = guide.name
        for name, obj in objects.items():
            item.place(obj, guide.points[name], guide.places.get(name))
        self.active = len(self.items) - 1


def _lost(point: CONVWASS_PG_guide_point) -> Sentence:
    """Return why there is no vertex at a point any more."""
    name = point.object.name
    if has_vertex(point.object, point.vertex):
        return Sentence("The point on {name} was deleted", {"name": name})
    return Sentence("{name} no longer has a vertex {vertex}", {"name": name, "vertex": point.vertex})


def _objects(guide: NamedGuide, inputs: Sequence[bpy.types.Object]) -> dict[str, bpy.types.Object]:
    """Return the objects of a guide that exist by name.

    Objects that came into the file later may have the names of the inputs, so the inputs come first.
    """
    found = {name: object_of(name, inputs) or object_of(name, bpy.data.objects) for name in guide.points}
    return {name: obj for name, obj in found.items() if obj is not None}


def labeled_guides(context: bpy.types.Context) -> list[LabeledVertex]:
    """Return the points that show a number in the viewport."""
    own = context.scene.convwass_guides
    if not own.show_labels:
        return []
    return [
        LabeledVertex(point.object, vertex, number)
        for number, guide in enumerate(own.items, start=1)
        if guide.enabled
        for point in guide.points
        if point.object is not None and (vertex := point.vertex_now) is not None
    ]


register, unregister = registration(
    (CONVWASS_PG_guide_point, CONVWASS_PG_guide, CONVWASS_PG_guides),
    ((bpy.types.Scene, "convwass_guides", CONVWASS_PG_guides),),
    (PairLabels(labeled_guides),),
)
