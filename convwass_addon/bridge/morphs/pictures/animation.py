# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Render a short video of a morph with a camera that moves slowly around it."""

from __future__ import annotations

import math
import tempfile
from pathlib import Path

import bpy
import numpy as np

from ....errors import InputError
from ....progress import Progress, Work
from ....sentence import Sentence
from ...studio.framing import View, broad_view, orbit
from ...studio.rendered_scene import Studio, checked_output, opening, world_points
from ...studio.video import write_video
from ...visibility import shown_at
from ..stored import frame_objects, shown_frames

ELEVATION = math.radians(18.0)
POINTS_PER_SHAPE = 1500
"""Number of vertices per shape used to place the camera."""
FRAMES_PER_SECOND = 24
PAUSE = 0.4
"""Duration in seconds for which the first and last shape are held."""
TURN = math.radians(26.0)
"""Angle by which the camera moves around the shapes."""


def render_animation(
    collection: bpy.types.Collection,
    path: str | Path,
    *,
    resolution: tuple[int, int] = (480, 360),
    samples: int = 8,
) -> Work[Path]:
    """Render a morph along a path to an MP4 video (H.264).

    Parameters
    ----------
    collection : bpy.types.Collection
        The morph; neither it nor the scene is changed.
    path : str or Path
        The MP4 to write; replaced if it exists.
    resolution : (int, int)
        Width and height in pixels, both even.
    samples : int
        Light paths per pixel.

    Yields
    ------
    Progress
        Before each rendered frame.

    Returns
    -------
    Path
        The file, absolute.

    Raises
    ------
    InputError
        The folder does not exist, the name does not end in ``.mp4``, or the collection contains no morph along a path.
    ConvwassError
        Blender cannot render, or lacks video output.
    """
    target = checked_output(path, ".mp4")
    objects = frame_objects(collection)
    span = shown_frames(collection)
    if not span:
        raise InputError(
            "{name} contains no morph along a path; for a sheet, make a contact sheet instead.", name=collection.name
        )
    seen = shown_at(objects, span)
    with Studio() as studio, tempfile.TemporaryDirectory(prefix="convwass-") as folder:
        copies = [studio.show(obj) for obj in objects]
        points = [_sample(obj) for obj in objects]
        view = broad_view(points, ELEVATION)
        depth = studio.build(points, view)
        studio.set_quality(resolution, samples)
        views = [View(view.azimuth + angle, view.elevation) for angle in _swing(len(span))]
        poses = orbit(np.concatenate(points), views, opening(resolution))
        pictures = [Path(folder) / f"{index:05d}.png" for index in range(len(span))]
        for index, (now, pose) in enumerate(zip(seen, poses, strict=True)):
            message = Sentence("Rendering frame {done} of {total}", {"done": index + 1, "total": len(span)})
            yield Progress(index / (len(span) + 1), message)
            for obj, copy in zip(objects, copies, strict=True):
                copy.hide_render = obj not in now
            studio.look(pose, depth)
            studio.render(pictures[index])
        yield Progress(len(span) / (len(span) + 1), Sentence("Writing the video"))
        pause = round(PAUSE * FRAMES_PER_SECOND)
        shown = [*pause * pictures[:1], *pictures, *pause * pictures[-1:]]
        write_video(shown, target, resolution, FRAMES_PER_SECOND)
    yield Progress(1.0, Sentence("Wrote {name}", {"name": target.name}))
    return target


def _swing(count: int) -> np.ndarray:
    """Return the camera's angles, (count,), around 0, with a smooth start and end."""
    return -TURN / 2.0 * np.cos(np.linspace(0.0, math.pi, count))


def _sample(obj: bpy.types.Object) -> np.ndarray:
    """Return enough vertices of a shape to place the camera, world space, (n, 3)."""
    points = world_points(obj)
    return points[:: 1 + len(points) // POINTS_PER_SHAPE]
