# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Frame objects of a morph, and the node group that shows one of them by its index."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import bpy

from ..nodes.index_switch import chosen, index_switch
from ..sequence import object_info

_OUTPUTS = {"Geometry": "GEOMETRY", "Transform": "MATRIX", "Color": "RGBA"}


@dataclass(frozen=True)
class FrameSwitch:
    """Frame objects that nodes choose from.

    Attributes
    ----------
    frames : sequence of bpy.types.Object
        The frame objects, at least one.
    group : bpy.types.NodeTree
        Their node group.
    """

    frames: Sequence[bpy.types.Object]
    group: bpy.types.NodeTree

    @classmethod
    def of(cls, name: str, frames: Sequence[bpy.types.Object]) -> FrameSwitch:
        """Create the node group of a player or pad with this name."""
        return cls(frames, index_switch(f"{name} Frames", _OUTPUTS, frames, _seen))

    def at(self, tree: bpy.types.NodeTree, index: bpy.types.NodeSocket) -> bpy.types.NodeOutputs:
        """Return the *Geometry* of the frame object at an index in local space, its *Transform* and its *Color*."""
        return chosen(tree, self.group, index)


def _seen(tree: bpy.types.NodeTree, frame: bpy.types.Object) -> tuple[object, ...]:
    info = object_info(tree, frame).outputs
    return info["Geometry"], info["Transform"], tuple(frame.color)
