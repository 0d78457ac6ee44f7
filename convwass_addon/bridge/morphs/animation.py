# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A short video of a morph, with a camera that slowly walks around it."""

from __future__ import annotations

import math
import tempfile
from pathlib import Path

import bpy
import numpy as np

from ...errors import InputError
from ...progress import UNINTERRUPTED, Control, Progress, Work
from ...sentence import Sentence
from ..framing import View, broad_view, orbit
from ..keyframes import is_shown
from ..studio import Studio, checked_output, opening, world_points
from ..video import write_video
from .stored import frame_objects, shown_frames

ELEVATION = math.radians(18.0)
POINTS_PER_SHAPE = 1500
"""How many vertices of a shape the camera is fitted to."""
PAUSE = 0.4
"""Seconds for which the first and the last shape are held."""


def render_animation(
    collection: bpy.types.Collection,
    path: str | Path,
    *,
    resolution: tuple[int, int] = (480, 360),
    samples: int = 8,
    step: int = 1,
    frames_per_second: int = 24,
    turn: float = math.radians(26.0),
    control: Control = UNINTERRUPTED,
) -> Work[Path]:
    """Write a morph along a path as an MP4 video (H.264).

    Parameters
    ----------
    collection : bpy.types.Collection
        The morph. Neither it nor the scene is changed.
    path : str or Path
        The MP4 to write; replaced if it exists.
    resolution : (int, int)
        Width and height in pixels, both even.
    samples : int
        Light paths per pixel.
    step : int
        Every how many frames of the morph one is shown; the last is always shown.
    frames_per_second : int
        Speed of the video.
    turn : float
        Radians by which the camera walks around the shapes.
    control : Control
        Ends the work when cancelled; nothing is written then.

    Yields
    ------
    Progress
        Before each frame.

    Returns
    -------
    Path
        The file, absolute.

    Raises
    ------
    InputError
        No folder to write into, a name without ``.mp4``, an odd width or height, or a collection that holds no
        morph along a path.
    ConvwassError
        Blender cannot render, or was built without video output.
    """
    target = checked_output(path, ".mp4")
    if any(side % 2 for side in resolution):
        raise InputError(
            "A video's width and height must be even numbers, not {width} x {height}.",
            width=resolution[0],
            height=resolution[1],
        )
    objects = frame_objects(collection)
    span = shown_frames(collection)
    if not span:
        raise InputError(
            "{name} holds no morph along a path; for a sheet make a contact sheet instead.", name=collection.name
        )
    frames = [*span[:-1:step], span[-1]]
    with Studio() as studio, tempfile.TemporaryDirectory(prefix="convwass-") as folder:
        copies = [studio.show(obj) for obj in objects]
        points = [_sample(obj) for obj in objects]
        view = broad_view(points, ELEVATION)
        depth = studio.build(points, view)
        studio.set_quality(resolution, samples)
        views = [View(view.azimuth + angle, view.elevation) for angle in _swing(turn, len(frames))]
        poses = orbit(np.concatenate(points), views, opening(resolution))
        pictures = [Path(folder) / f"{index:05d}.png" for index in range(len(frames))]
        for index, (frame, pose) in enumerate(zip(frames, poses, strict=True)):
            message = Sentence("Rendering frame {done} of {total}", {"done": index + 1, "total": len(frames)})
            yield Progress(index / (len(frames) + 1), message)
            control.check()
            for obj, copy in zip(objects, copies, strict=True):
                copy.hide_render = not is_shown(obj, frame)
            studio.look(pose, depth)
            studio.render(pictures[index])
        yield Progress(len(frames) / (len(frames) + 1), Sentence("Writing the video"))
        control.check()
        pause = round(PAUSE * frames_per_second)
        shown = [*pause * pictures[:1], *pictures, *pause * pictures[-1:]]
        write_video(shown, target, resolution, frames_per_second)
    yield Progress(1.0, Sentence("Wrote {name}", {"name": target.name}))
    return target


def _swing(turn: float, count: int) -> np.ndarray:
    """Return the camera's angles, (count,), about 0; it sets off and arrives gently."""
    return -turn / 2.0 * np.cos(np.linspace(0.0, math.pi, count))


def _sample(obj: bpy.types.Object) -> np.ndarray:
    """Return enough vertices of a shape to fit the camera to, world space, (n, 3)."""
    points = world_points(obj)
    return points[:: 1 + len(points) // POINTS_PER_SHAPE]
