# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The guides of morphs in a scene: points of the shapes that belong together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import bpy
from bpy.props import BoolProperty, CollectionProperty, IntProperty, PointerProperty, StringProperty

from ..bridge.morphs.morph_guides import NamedGuide
from ..bridge.soft_maps.pair_labels import LabeledVertex, PairLabels
from ..sentence import Sentence


class CONVWASS_PG_guide_point(bpy.types.PropertyGroup):
    """A vertex of a shape."""

    object: PointerProperty(name="Shape", description="Object that the point is on", type=bpy.types.Object)
    vertex: IntProperty(name="Vertex", description="Number of the vertex", min=0)


class CONVWASS_PG_guide(bpy.types.PropertyGroup):
    """Points of several shapes that belong together."""

    label: StringProperty(name="Label", description="What the points are, such as nose")
    points: CollectionProperty(name="Points", description="One point on each shape", type=CONVWASS_PG_guide_point)
    enabled: BoolProperty(name="Enabled", description="Whether this guide takes part", default=True)

    @property
    def named(self) -> NamedGuide:
        """The guide by the names of objects; points on objects that have been deleted are left out."""
        # Objects that are deleted in the viewport live on as long as something points at them.
        there = [point for point in self.points if point.object is not None and point.object.users_scene]
        return NamedGuide(self.label, {point.object.name: point.vertex for point in there})

    @property
    def problem(self) -> Sentence | None:
        """Why the guide cannot take part, if so."""
        points = self.named.points
        if len(points) < 2:
            return Sentence("Needs a point on another shape")
        for name, vertex in points.items():
            obj = bpy.data.objects[name]
            if obj.type != "MESH" or vertex >= len(obj.data.vertices):
                return Sentence("{name} has no vertex {vertex} any more", {"name": name, "vertex": vertex})
        return None

    def place(self, obj: bpy.types.Object, vertex: int) -> None:
        """Set the point on an object, in place of the one that may be there."""
        point = next((point for point in self.points if point.object == obj), None) or self.points.add()
        point.object, point.vertex = obj, vertex


class CONVWASS_PG_guides(bpy.types.PropertyGroup):
    """Guides of the morphs of a scene."""

    items: CollectionProperty(
        name="Guides", description="Points of the shapes that belong together", type=CONVWASS_PG_guide
    )
    active: IntProperty(name="Active Guide", description="The guide that buttons beside the list act on", min=0)
    show_labels: BoolProperty(
        name="Show Numbers",
        description="Write the number of each guide at its points in the viewport",
        default=True,
    )

    @property
    def named(self) -> list[NamedGuide]:
        """The guides that take part: with points on two shapes at least."""
        found = []
        for number, guide in enumerate(self.items, start=1):
            named = guide.named
            if guide.enabled and len(named.points) > 1:
                # Messages call a guide without a label by the number that the panel shows.
                found.append(replace(named, name=named.name or str(number)))
        return found

    def holder(self, name: str, vertex: int) -> int | None:
        """Return the number of the guide, from 1, that has a point at a vertex of an object; None for none."""
        numbers = (number for number, guide in enumerate(self.items, start=1) if guide.named.points.get(name) == vertex)
        return next(numbers, None)

    def add(self, guide: NamedGuide) -> None:
        """Put a guide on the list; its objects must exist."""
        item = self.items.add()
        item.label = guide.name
        for name, vertex in guide.points.items():
            item.place(bpy.data.objects[name], vertex)
        self.active = len(self.items) - 1

    def take(self, guides: Sequence[NamedGuide]) -> None:
        """Put guides on the list that it lacks."""
        known = [dict(guide.named.points) for guide in self.items]
        for guide in guides:
            if dict(guide.points) not in known:
                self.add(guide)


def labeled_guides(context: bpy.types.Context) -> list[LabeledVertex]:
    """Return the points that have a number in the viewport."""
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


_classes = (CONVWASS_PG_guide_point, CONVWASS_PG_guide, CONVWASS_PG_guides)
_register_classes, _unregister_classes = bpy.utils.register_classes_factory(_classes)
_labels = PairLabels(labeled_guides)


def register() -> None:
    """Add the guides to scenes, and draw their numbers."""
    _register_classes()
    bpy.types.Scene.convwass_guides = PointerProperty(type=CONVWASS_PG_guides)
    _labels.register()


def unregister() -> None:
    """Take both away."""
    _labels.unregister()
    del bpy.types.Scene.convwass_guides
    _unregister_classes()
