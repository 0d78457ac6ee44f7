# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A base class for drawing over the 3D viewport, and a function that draws discs."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Generic, TypeVar

import bpy
import gpu
from gpu_extras.batch import batch_for_shader
from mathutils import Vector

_CORNERS = 20

Wanted = TypeVar("Wanted")


class ViewportOverlay(Generic[Wanted]):
    """Draws over 3D viewports that show overlays, while it is registered.

    Parameters
    ----------
    wanted : callable
        ``wanted(context)`` returns the items to draw.
    """

    def __init__(self, wanted: Callable[[bpy.types.Context], Wanted]) -> None:
        self._wanted = wanted
        self._handle: object | None = None

    def register(self) -> None:
        """Start drawing."""
        if self._handle is None:
            self._handle = bpy.types.SpaceView3D.draw_handler_add(self._draw_if_shown, (), "WINDOW", "POST_PIXEL")

    def unregister(self) -> None:
        """Stop drawing."""
        if self._handle is not None:
            bpy.types.SpaceView3D.draw_handler_remove(self._handle, "WINDOW")
            self._handle = None

    def _draw_if_shown(self) -> None:
        context = bpy.context
        if context.space_data.overlay.show_overlays:
            self._draw(self._wanted(context), context)

    # Implemented by subclasses.

    def _draw(self, wanted: Wanted, context: bpy.types.Context) -> None:
        raise NotImplementedError


def fill_discs(centers: Sequence[Vector], radius: float, color: tuple[float, ...]) -> None:
    """Fill discs in one draw call, because there may be hundreds.

    Parameters
    ----------
    centers : sequence of mathutils.Vector
        In pixels of the region.
    radius : float
        In pixels.
    color : tuple of float
        Red, green, blue and opacity.
    """
    angles = [2.0 * math.pi * corner / _CORNERS for corner in range(_CORNERS)]
    rim = [Vector((radius * math.cos(angle), radius * math.sin(angle))) for angle in angles]
    points = [center + corner for center in centers for corner in rim]
    fan = [(0, corner, corner + 1) for corner in range(1, _CORNERS - 1)]
    triangles = [
        tuple(first + corner for corner in triangle) for first in range(0, len(points), _CORNERS) for triangle in fan
    ]
    shader = gpu.shader.from_builtin("UNIFORM_COLOR")
    shader.uniform_float("color", color)
    batch_for_shader(shader, "TRIS", {"pos": points}, indices=triangles).draw(shader)
