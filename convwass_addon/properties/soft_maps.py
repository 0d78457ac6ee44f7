# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of soft maps, as each scene has its own: two objects, pairs of vertices, what to transfer."""

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

TRANSFERRED = (
    ("GROUPS", "Vertex Groups", "Weights of vertex groups"),
    ("KEYS", "Shape Keys", "What shape keys do, turned and stretched as the map turns and stretches the surface"),
    ("UVS", "UV Maps", "UV maps with their seams"),
    ("COLORS", "Color Attributes", "Colors of vertices or of face corners"),
)
"""What can be carried over, as items of an enum."""

DIRECTIONS = (
    ("FORWARD", "Source to Target", "The target gets what the source has; on one object what is left goes right"),
    ("BACKWARD", "Target to Source", "The source gets what the target has; on one object what is right goes left"),
)
"""Ways along a map, as items of an enum."""


class SoftMapProperties:
    """What a soft map is asked for."""

    vertices: IntProperty(
        name="Vertices",
        description="The map is solved on meshes of about so many vertices, and then taken to all of them",
        default=SoftMapSettings.vertices,
        min=50,
        soft_min=200,
        soft_max=2000,
        max=4000,
    )
    tau: FloatProperty(
        name="Tau",
        description="How much what points look like counts against smoothness of the map",
        default=SoftMapSettings.tau,
        min=0.0,
        soft_max=100.0,
        max=1e6,
    )
    sharpness: FloatProperty(
        name="Sharpness",
        description="How much of the blur is taken out of the map; 0 is the map as published",
        default=SoftMapSettings.sharpness,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
    )
    sweeps: IntProperty(
        name="Sweeps",
        description="Most times that the image of every vertex is made anew",
        default=SoftMapSettings.sweeps,
        min=1,
        soft_max=50,
        max=1000,
    )
    symmetric: BoolProperty(
        name="Both Ways",
        description="Solve both directions together, so that they agree; takes twice as long",
        default=SoftMapSettings.symmetric,
    )
    use_groups: BoolProperty(
        name="Use Equal Groups",
        description="Let painted vertex groups of the same name on both objects tell points apart",
        default=False,
    )
    group_weight: FloatProperty(
        name="Weight of Groups",
        description="How much painted groups count against all else that tells points apart",
        default=SoftMapSettings.group_weight,
        min=0.0,
        soft_max=10.0,
        max=100.0,
    )

    def soft_map_settings(self) -> SoftMapSettings:
        """Return the settings of the application; raises InputError where they make no sense."""
        names = ("vertices", "tau", "sharpness", "sweeps", "symmetric", "group_weight")
        return SoftMapSettings(**{name: getattr(self, name) for name in names})


class TransferProperties:
    """What a transfer is asked for."""

    what: EnumProperty(
        name="What",
        description="What is transferred",
        items=TRANSFERRED,
        default={"GROUPS"},
        options={"ENUM_FLAG"},
    )
    direction: EnumProperty(name="Direction", description="Which way along the map", items=DIRECTIONS)
    existing: EnumProperty(
        name="Existing",
        description="What to do with groups, keys and others that the receiving object has already; locked vertex "
        "groups and locked shape keys always stay",
        items=(
            ("REPLACE", "Replace", "Write what is transferred over those of the same name; others stay"),
            ("KEEP", "Keep", "Leave what is there, and transfer the rest"),
        ),
    )
    limit: IntProperty(
        name="Limit",
        description="Most deforming groups of a vertex: of more the largest weights stay; 0 for all of them",
        default=4,
        min=0,
        soft_max=8,
        max=1000,
    )
    normalize: BoolProperty(
        name="Normalize",
        description="Let the weights of deforming groups add up to 1 at every vertex, with those of locked groups",
        default=True,
    )
    flip_names: BoolProperty(
        name="Flip Names",
        description="Write vertex groups and shape keys under the name of the other side, as from Arm.L to Arm.R; the "
        "map of an object to itself always does",
        default=False,
    )


class FromGroupsProperties:
    """Which vertex groups mark vertices."""

    pattern: StringProperty(
        name="Pattern",
        description="Names of the groups that count, with * and ? for what may stand there",
        default="*",
    )
    largest: FloatProperty(
        name="Largest",
        description="Share of the vertices that a group may have; larger ones are left out, as they mark no point",
        default=0.05,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
    )


def threshold_property() -> object:
    """Return the property of the confidence below which a map is repaired."""
    return FloatProperty(
        name="Threshold",
        description="Images of vertices with less confidence are filled in from their neighbors",
        default=0.3,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
    )


def _is_mesh(_settings: bpy.types.PropertyGroup, obj: bpy.types.Object) -> bool:
    return obj.type == "MESH"


class CONVWASS_PG_map_pair(bpy.types.PropertyGroup):
    """A vertex of the source and one of the target that belong together."""

    label: StringProperty(name="Label", description="What the two vertices are, such as nose")
    source_vertex: IntProperty(
        name="Source Vertex", description="Number of a vertex of the source; -1 for none yet", default=-1, min=-1
    )
    target_vertex: IntProperty(
        name="Target Vertex", description="Number of a vertex of the target; -1 for none yet", default=-1, min=-1
    )
    enabled: BoolProperty(name="Enabled", description="Whether this pair takes part", default=True)

    @property
    def is_complete(self) -> bool:
        """Whether both vertices are there."""
        return self.source_vertex >= 0 and self.target_vertex >= 0


class CONVWASS_PG_soft_map(SoftMapProperties, TransferProperties, FromGroupsProperties, bpy.types.PropertyGroup):
    """Settings of the soft maps of a scene."""

    source: PointerProperty(
        name="Source",
        description="Object that the map leads from, and is stored with",
        type=bpy.types.Object,
        poll=_is_mesh,
    )
    target: PointerProperty(
        name="Target", description="Object that the map leads to", type=bpy.types.Object, poll=_is_mesh
    )
    pairs: CollectionProperty(
        name="Pairs", description="Vertices of both objects that belong together", type=CONVWASS_PG_map_pair
    )
    active_pair: IntProperty(name="Active Pair", description="The pair that buttons beside the list act on", min=0)
    show_labels: BoolProperty(
        name="Show Numbers",
        description="Write the number of each pair at its two vertices in the viewport",
        default=True,
    )
    threshold: threshold_property()

    @property
    def used_pairs(self) -> list[CONVWASS_PG_map_pair]:
        """The pairs that take part."""
        return [pair for pair in self.pairs if pair.enabled and pair.is_complete]


def labeled_vertices(context: bpy.types.Context) -> list[LabeledVertex]:
    """Return the vertices that have a number in the viewport."""
    own = context.scene.convwass_soft_map
    if not own.show_labels:
        return []
    found = []
    for number, pair in enumerate(own.pairs, start=1):
        for obj, vertex in ((own.source, pair.source_vertex), (own.target, pair.target_vertex)):
            if obj is not None and pair.enabled:
                found.append(LabeledVertex(obj, vertex, number))
    return found


_classes = (CONVWASS_PG_map_pair, CONVWASS_PG_soft_map)
_register_classes, _unregister_classes = bpy.utils.register_classes_factory(_classes)
_labels = PairLabels(labeled_vertices)


def register() -> None:
    """Add the settings to scenes, and draw the numbers of pairs."""
    _register_classes()
    bpy.types.Scene.convwass_soft_map = PointerProperty(type=CONVWASS_PG_soft_map)
    _labels.register()


def unregister() -> None:
    """Take both away."""
    _labels.unregister()
    del bpy.types.Scene.convwass_soft_map
    _unregister_classes()
