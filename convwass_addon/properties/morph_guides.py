# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The guides of morphs, stored in the scene: corresponding points of the shapes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import bpy
from bpy.props import BoolProperty, CollectionProperty, IntProperty, PointerProperty, StringProperty

from ..bridge.morphs.morph_guides import NamedGuide
from ..bridge.object_names import object_of, unique_name
from ..bridge.soft_maps.pair_labels import LabeledVertex, PairLabels
from ..sentence import Sentence
from .registration import registration


class CONVWASS_PG_guide_point(bpy.types.PropertyGroup):
    """A vertex of a shape."""

    object: PointerProperty(name="Shape", description="Object that the point is on", type=bpy.types.Object)
    vertex: IntProperty(name="Vertex", description="Number of the vertex", min=0)


class CONVWASS_PG_guide(bpy.types.PropertyGroup):
    """Corresponding points of several shapes."""

    label: StringProperty(name="Label", description="Name of the point, such as nose")
    points: CollectionProperty(name="Points", description="One point per shape", type=CONVWASS_PG_guide_point)
    enabled: BoolProperty(name="Enabled", description="Whether this guide is used", default=True)

    @property
    def vertices(self) -> dict[bpy.types.Object, int]:
        """The vertices by object, without those on deleted objects."""
        # Objects deleted in the viewport still exist as long as a pointer refers to them.
        there = [point for point in self.points if point.object is not None and point.object.users_scene]
        return {point.object: point.vertex for point in there}

    @property
    def named(self) -> NamedGuide:
        """The guide by names of objects, without points on deleted objects."""
        return NamedGuide(self.label, {unique_name(obj): vertex for obj, vertex in self.vertices.items()})

    @property
    def problem(self) -> Sentence | None:
        """Why the guide cannot be used, or None."""
        vertices = self.vertices
        if len(vertices) < 2:
            return Sentence("Needs a point on another shape")
        for obj, vertex in vertices.items():
            if obj.type != "MESH" or vertex >= len(obj.data.vertices):
                return Sentence("{name} no longer has a vertex {vertex}", {"name": obj.name, "vertex": vertex})
        return None

    def place(self, obj: bpy.types.Object, vertex: int) -> None:
        """Set the point on an object, replacing an existing one."""
        point = next((point for point in self.points if point.object == obj), None) or self.points.add()
        point.object, point.vertex = obj, vertex


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
        self._add(guide.name, _vertices(guide, ()))

    def take(self, guides: Sequence[NamedGuide], inputs: Sequence[bpy.types.Object]) -> None:
        """Add the guides of a morph that are not on the list yet, on its inputs if these have the names."""
        known = [item.vertices for item in self.items]
        for guide in guides:
            vertices = _vertices(guide, inputs)
            if vertices not in known:
                self._add(guide.name, vertices)

    def _add(self, label: str, vertices: Mapping[bpy.types.Object, int]) -> None:
        item = self.items.add()
        item.label = label
        for obj, vertex in vertices.items():
            item.place(obj, vertex)
        self.active = len(self.items) - 1


def _vertices(guide: NamedGuide, inputs: Sequence[bpy.types.Object]) -> dict[bpy.types.Object, int]:
    """Return the vertices of a guide by object, without points on objects that no longer exist.

    Objects that came into the file later may have the names of the inputs, so the inputs come first.
    """
    found = {name: object_of(name, inputs) or object_of(name, bpy.data.objects) for name in guide.points}
    return {found[name]: vertex for name, vertex in guide.points.items() if found[name] is not None}


def labeled_guides(context: bpy.types.Context) -> list[LabeledVertex]:
    """Return the points that show a number in the viewport."""
    own = context.scene.convwass_guides
    if not own.show_labels:
        return []
    return [
        LabeledVertex(point.object, point.vertex, number)
        for number, guide in enumerate(own.items, start=1)
        if guide.enabled
        for point in guide.points
        if point.object is not None
    ]


register, unregister = registration(
    (CONVWASS_PG_guide_point, CONVWASS_PG_guide, CONVWASS_PG_guides),
    ((bpy.types.Scene, "convwass_guides", CONVWASS_PG_guides),),
    (PairLabels(labeled_guides),),
)
