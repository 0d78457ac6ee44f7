# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The frame range of a scene that is given a new animation."""

from __future__ import annotations

import math

import bpy


def play_whole(scene: bpy.types.Scene, first: float, last: float) -> None:
    """Let the scene play an animation from `first` to `last`, and nothing else."""
    scene.frame_end = math.ceil(last)
    scene.frame_start = math.floor(first)


def play_among_others(scene: bpy.types.Scene, first: float, last: float) -> None:
    """Let the scene play an animation from `first` to `last` besides what it plays already."""
    play_whole(scene, min(first, scene.frame_start), max(last, scene.frame_end))


def play_from_start(scene: bpy.types.Scene, first: float, last: float) -> None:
    """Let the scene end with an animation that begins where the scene does; others lengthen it where needed."""
    fit = play_whole if first == scene.frame_start else play_among_others
    fit(scene, first, last)
