# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Read what materials read of a scene: its time and its properties."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import bpy

from .nodes.shown_nodes import nodes_of
from .object_values import Color, shown_property, write_properties


@dataclass(frozen=True)
class SceneValues:
    """What materials read of a scene.

    Attributes
    ----------
    frame, subframe : int, float
        Its current frame, and the fraction of a frame since then.
    frame_map_old, frame_map_new : int
        Its time remapping.
    properties : dict of str to (r, g, b, a)
        Its properties that Attribute nodes of the type View Layer read, as these show them.
    """

    frame: int
    subframe: float
    frame_map_old: int
    frame_map_new: int
    properties: Mapping[str, Color]

    @classmethod
    def of(
        cls,
        scene: bpy.types.Scene,
        view_layer: bpy.types.ViewLayer,
        materials: Sequence[bpy.types.Material | None],
    ) -> SceneValues:
        """Read what some materials can read of a scene and of one of its view layers."""
        names = {node.attribute_name for node in nodes_of(materials) if _reads_scene(node)}
        blocks = view_layer, scene, scene.world
        return cls(
            scene.frame_current,
            scene.frame_subframe,
            scene.render.frame_map_old,
            scene.render.frame_map_new,
            {name: shown_property(blocks, name) for name in sorted(names)},
        )

    def write_to(self, scene: bpy.types.Scene) -> None:
        """Let materials read the same time and properties of another scene, in all of its view layers."""
        for view_layer in scene.view_layers:
            write_properties(view_layer, self.properties)
        scene.render.frame_map_old, scene.render.frame_map_new = self.frame_map_old, self.frame_map_new
        scene.frame_set(self.frame, subframe=self.subframe)


def _reads_scene(node: bpy.types.Node) -> bool:
    return node.type == "ATTRIBUTE" and node.attribute_type == "VIEW_LAYER" and bool(node.attribute_name)
