# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Set the frame range of a scene for a new animation."""

from __future__ import annotations

import math

import bpy


def play_whole(scene: bpy.types.Scene, first: float, last: float) -> None:
    """Set the frame range of the scene to `first` ... `last`."""
    scene.frame_end = math.ceil(last)
    scene.frame_start = math.floor(first)


def play_among_others(scene: bpy.types.Scene, first: float, last: float) -> None:
    """Extend the frame range of the scene to include `first` ... `last`."""
    play_whole(scene, min(first, scene.frame_start), max(last, scene.frame_end))
