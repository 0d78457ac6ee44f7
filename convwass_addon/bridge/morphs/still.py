# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A picture of what a morph shows at the moment."""

from __future__ import annotations

import math
from pathlib import Path

import bpy
import numpy as np

from ...errors import InputError
from ..framing import broad_view, orbit
from ..studio import Studio, checked_output, opening, world_points

ELEVATION = math.radians(18.0)


def render_still(
    collection: bpy.types.Collection,
    path: str | Path,
    *,
    resolution: tuple[int, int] = (1280, 960),
    samples: int = 16,
) -> Path:
    """Write a PNG of all visible meshes of a collection, where they are.

    Parameters
    ----------
    collection : bpy.types.Collection
        A morph, or any other. Neither it nor the scene is changed.
    path : str or Path
        The PNG to write; replaced if it exists.
    resolution : (int, int)
        Width and height in pixels.
    samples : int
        Light paths per pixel.

    Returns
    -------
    Path
        The file, absolute.

    Raises
    ------
    InputError
        No folder to write into, a name without ``.png``, or nothing to see.
    ConvwassError
        Blender cannot render.
    """
    target = checked_output(path, ".png")
    objects = [
        obj for obj in collection.all_objects if obj.type == "MESH" and obj.data.vertices and not obj.hide_render
    ]
    if not objects:
        raise InputError("{name} shows nothing in renders; go to a frame in which it does.", name=collection.name)
    points = [world_points(obj) for obj in objects]
    view = broad_view(points, ELEVATION)
    with Studio() as studio:
        for obj in objects:
            studio.show(obj)
        reach = studio.build(points, view)
        studio.look(orbit(np.concatenate(points), [view], opening(resolution))[0], reach)
        studio.set_quality(resolution, samples)
        studio.render(target)
    return target
