# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Read what materials read of a scene: its time."""

from __future__ import annotations

from dataclasses import dataclass

import bpy


@dataclass(frozen=True)
class SceneValues:
    """What materials read of a scene.

    Attributes
    ----------
    frame, subframe : int, float
        Its current frame, and the fraction of a frame since then.
    frame_map_old, frame_map_new : int
        Its time remapping.
    """

    frame: int
    subframe: float
    frame_map_old: int
    frame_map_new: int

    @classmethod
    def of(cls, scene: bpy.types.Scene) -> SceneValues:
        """Read what materials can read of a scene."""
        render = scene.render
        return cls(scene.frame_current, scene.frame_subframe, render.frame_map_old, render.frame_map_new)

    def write_to(self, scene: bpy.types.Scene) -> None:
        """Let materials read the same time of another scene."""
        scene.render.frame_map_old, scene.render.frame_map_new = self.frame_map_old, self.frame_map_new
        scene.frame_set(self.frame, subframe=self.subframe)
