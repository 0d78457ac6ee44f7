# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Times of keys, which differ from the frames of a scene that uses *Time Stretching*."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import bpy
import numpy as np


def times_per_second(scene: bpy.types.Scene) -> float:
    """Return by how much the time of the animation rises in a second."""
    return time_of_frame(scene, scene.render.fps / scene.render.fps_base)


def time_of_frame(scene: bpy.types.Scene, frame: float) -> float:
    """Return the time of the animation in a frame of a scene."""
    # Whole times must stay whole; the product is exact.
    return frame * scene.render.frame_map_old / scene.render.frame_map_new


def frame_of_time(scene: bpy.types.Scene, time: float) -> float:
    """Return the frame of a scene, with its fraction, in which its animation is at a time."""
    return time * scene.render.frame_map_new / scene.render.frame_map_old


def show_time(scene: bpy.types.Scene, time: float) -> None:
    """Set the frame of a scene so that its animation is at a time."""
    frame = frame_of_time(scene, time)
    scene.frame_set(int(np.floor(frame)), subframe=float(frame % 1.0))


@contextmanager
def returning(scene: bpy.types.Scene) -> Iterator[None]:
    """Return to the current frame of a scene at the end of a block of code."""
    frame, subframe = scene.frame_current, scene.frame_subframe
    try:
        yield
    finally:
        scene.frame_set(frame, subframe=subframe)
