# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Set the frame range of a scene for a new animation."""

from __future__ import annotations

import math

import bpy

from .animation_time import frame_of_time


def play_whole(scene: bpy.types.Scene, first: float, last: float) -> None:
    """Set the frame range of the scene to the times `first` ... `last`, and turn its preview range off.

    The window plays the preview range in place of the frame range; it stays set, so that it can be turned on again.
    If the animation begins before frame 0, where a frame range cannot, the preview range is set to it instead.
    """
    first, last = (frame_of_time(scene, time) for time in (first, last))
    _set_range(scene, first, last)
    scene.use_preview_range = first < 0
    if scene.use_preview_range:
        scene.frame_preview_end, scene.frame_preview_start = math.ceil(last), math.floor(first)


def play_among_others(scene: bpy.types.Scene, first: float, last: float) -> None:
    """Extend the frame range of the scene to include the times `first` ... `last`, but not its preview range."""
    first, last = (frame_of_time(scene, time) for time in (first, last))
    _set_range(scene, min(first, scene.frame_start), max(last, scene.frame_end))


def _set_range(scene: bpy.types.Scene, first: float, last: float) -> None:
    scene.frame_end = math.ceil(last)
    scene.frame_start = math.floor(first)
