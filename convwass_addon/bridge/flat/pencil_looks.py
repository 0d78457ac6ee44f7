# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Colors and lines of evaluated Grease Pencil strokes, as materials, strokes and layers determine them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import bpy
import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class StrokeLine:
    """The line along a stroke.

    Attributes
    ----------
    radius : float
        Mean over the points, scene units.
    color : (float, float, float, float)
        Red, green, blue, opacity, linear.
    """

    radius: float
    color: tuple[float, float, float, float]

    def scaled(self, factor: float) -> StrokeLine:
        """Return the line of a shape scaled by a factor."""
        return replace(self, radius=factor * self.radius)


@dataclass(frozen=True)
class ShownDrawing:
    """A drawing as it is shown.

    Attributes
    ----------
    drawing : bpy.types.GreasePencilDrawing
        The strokes, evaluated.
    opacity : float
        Opacity of the layer; its tint and radius offset are part of the evaluated strokes.
    place : (4, 4)
        Transform of the layer to world space.
    """

    drawing: bpy.types.GreasePencilDrawing
    opacity: float
    place: NDArray[np.float64]

    def has(self, name: str) -> bool:
        """Return whether strokes have an attribute; before Blender 5.2, an opacity that they lack reads as 0, not 1."""
        return self.drawing.attributes.get(name) is not None


def is_drawn(material: bpy.types.Material | None) -> bool:
    """Return whether strokes with a material are visible."""
    return material is None or not material.grease_pencil.hide


def has_painted_fill(material: bpy.types.Material) -> bool:
    """Return whether a material fills strokes with a gradient or an image."""
    return material.grease_pencil is not None and material.grease_pencil.fill_style != "SOLID"


def fill_color(color: Sequence[float], stroke: object, shown: ShownDrawing) -> tuple[float, float, float, float]:
    """Return the color that fills a stroke, linear with opacity, from the `color` of its material."""
    opacity = stroke.fill_opacity if shown.has("fill_opacity") else 1.0
    return _combined(color, stroke.fill_color, opacity * shown.opacity)


def line_of(material: bpy.types.Material | None, stroke: object, shown: ShownDrawing) -> StrokeLine | None:
    """Return the line along a stroke, or None if nothing of it is visible."""
    if material is None or not _shows_line(material, stroke):
        return None
    points = stroke.points
    vertex_color = np.mean([tuple(point.vertex_color) for point in points], axis=0)
    opacity = float(np.mean([point.opacity for point in points])) if shown.has("opacity") else 1.0
    # Blender scales radii like a vector along the diagonal of the axes.
    scale = float(np.linalg.norm(shown.place[:3, :3].sum(axis=1))) / np.sqrt(3.0)
    radius = scale * float(np.mean([point.radius for point in points]))
    color = _combined(material.grease_pencil.color, vertex_color, opacity * shown.opacity)
    return StrokeLine(radius, color) if radius > 0 and color[3] > 0 else None


def mean_line(lines: Iterable[StrokeLine | None], weights: Sequence[float]) -> StrokeLine | None:
    """Return the weighted mean of the lines of some shapes; where a shape has none, lines become thinner.

    Colors are means over the shapes that have a line.
    """
    drawn = [(line, weight) for line, weight in zip(lines, weights, strict=True) if line is not None and weight > 0]
    if not drawn:
        return None
    shares = np.array([weight for _, weight in drawn])
    color = shares @ np.array([line.color for line, _ in drawn]) / shares.sum()
    radius = float(shares @ np.array([line.radius for line, _ in drawn]))
    return StrokeLine(radius, tuple(float(value) for value in color))


def _shows_line(material: bpy.types.Material, stroke: object) -> bool:
    # From Blender 5.2, this is set per stroke.
    return not stroke.hide_stroke if hasattr(stroke, "hide_stroke") else material.grease_pencil.show_stroke


def _combined(color: Sequence[float], over: Sequence[float], opacity: float) -> tuple[float, float, float, float]:
    """Lay the color of a stroke over that of its material, both with opacity; multiply the latter's opacity."""
    mixed = (1.0 - over[3]) * np.array(color[:3]) + over[3] * np.array(over[:3])
    return (*(float(value) for value in mixed), float(color[3] * opacity))
