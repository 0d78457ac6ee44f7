# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Write outlines as filled strokes of a Grease Pencil drawing, with lines along them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import count

import bpy
import numpy as np
from numpy.typing import NDArray

from ...geometry.plane.fitting import BezierRing
from ...geometry.plane.outlines import FlatRegion
from ...geometry.plane.ring_nesting import keyholed
from .pencil_looks import StrokeLine

# Points per curve segment if strokes are polygons.
_STEPS = 8
# Blender's handle types.
_FREE, _ALIGNED = 0, 3


@dataclass(frozen=True)
class Fill:
    """A filled area of one color.

    Attributes
    ----------
    regions : tuple of tuple of BezierRing
        An outer ring and its holes each, in the plane given by `place`.
    slot : int
        Index of the material.
    opacity : float
        Opacity, from 0 to 1.
    color : (float, float, float) or None
        Replaces the color of the material; None for that color.
    line : StrokeLine or None
        Drawn along the rings.
    """

    regions: tuple[tuple[BezierRing, ...], ...]
    slot: int
    opacity: float = 1.0
    color: tuple[float, float, float] | None = None
    line: StrokeLine | None = None


def new_drawing_data(name: str) -> bpy.types.ID:
    """Create Grease Pencil data, whose collection changed in Blender 5.0."""
    kind = bpy.data.grease_pencils_v3 if hasattr(bpy.data, "grease_pencils_v3") else bpy.data.grease_pencils
    return kind.new(name)


def fill_material(name: str, color: Sequence[float]) -> bpy.types.Material:
    """Create a material that fills strokes with a scene linear RGB color and draws no lines."""
    return _material(name, (*color[:3], 1.0), fills=True)


def line_material(name: str) -> bpy.types.Material:
    """Create a material that draws lines along strokes, in the colors of their points, and does not fill them."""
    return _material(name, (0.0, 0.0, 0.0, 1.0), fills=False)


def _material(name: str, color: tuple[float, ...], fills: bool) -> bpy.types.Material:
    material = bpy.data.materials.new(name)
    bpy.data.materials.create_gpencil_data(material)
    own = material.grease_pencil
    own.fill_color = own.color = material.diffuse_color = color
    if bpy.app.version < (5, 2, 0):
        # Later versions set this per stroke.
        own.show_fill, own.show_stroke = fills, not fills
    return material


def write_fills(drawing: object, fills: Sequence[Fill], place: NDArray[np.float64], line_slot: int) -> None:
    """Draw overlapping fills in an empty drawing.

    From Blender 5.2, strokes are Bezier curves, and holes are strokes of the same fill. Before, every stroke is filled
    separately, so strokes are polygons with cuts to their holes. Lines are strokes of their own, above their fill.

    Parameters
    ----------
    drawing : bpy.types.GreasePencilDrawing
        The drawing of a keyframe.
    fills : sequence of Fill
        From bottom to top.
    place : (4, 4)
        Transform from the plane of the fills to object space.
    line_slot : int
        Index of the material of lines; see :func:`line_material`.
    """
    is_curved = bpy.app.version >= (5, 2, 0)
    strokes = list(_curves(fills) if is_curved else _polygons(fills))
    if not strokes:
        return
    drawing.add_strokes([len(stroke.points) for stroke in strokes])
    _write(drawing, "position", "FLOAT_VECTOR", "vector", _in_space([stroke.points for stroke in strokes], place))
    if is_curved:
        _write_handles(drawing, [stroke.ring for stroke in strokes], place)
    _write_lines(drawing, strokes)
    for stroke, made in zip(strokes, drawing.strokes, strict=True):
        made.cyclic = True
        made.material_index = stroke.fill.slot if stroke.is_filled else line_slot
        if is_curved:
            made.fill_id, made.hide_stroke = stroke.number, stroke.is_filled
        if stroke.is_filled:
            made.fill_opacity = stroke.fill.opacity
            if stroke.fill.color is not None:
                # Where its opacity is 1, this color covers that of the material.
                made.fill_color = (*stroke.fill.color, 1.0)
    drawing.tag_positions_changed()


@dataclass(frozen=True)
class _Stroke:
    """A stroke to be drawn: its curve if it is one, its points, (n, 2), its fill, and the number of the filled region.

    The number is 0 for a line.
    """

    ring: BezierRing | None
    points: NDArray[np.float64]
    fill: Fill
    number: int

    @property
    def is_filled(self) -> bool:
        return self.number > 0


def _curves(fills: Sequence[Fill]) -> Iterator[_Stroke]:
    """Yield the rings of all regions, and those with a line once more."""
    numbers = count(1)
    for fill in fills:
        for region, number in zip(fill.regions, numbers, strict=False):
            yield from (_Stroke(ring, ring.points, fill, number) for ring in region)
        if fill.line is not None:
            yield from (_Stroke(ring, ring.points, fill, 0) for region in fill.regions for ring in region)


def _polygons(fills: Sequence[Fill]) -> Iterator[_Stroke]:
    """Yield a polygon per region, with cuts to its holes, and those of its rings if they have a line."""
    for fill in fills:
        sampled = [[ring.sampled(_STEPS) for ring in region] for region in fill.regions]
        for outer, *holes in sampled:
            yield _Stroke(None, keyholed(FlatRegion(outer, tuple(holes))), fill, 1)
        if fill.line is not None:
            yield from (_Stroke(None, ring, fill, 0) for region in sampled for ring in region)


def _write_handles(drawing: object, rings: Sequence[BezierRing], place: NDArray[np.float64]) -> None:
    drawing.set_types(type="BEZIER")
    for name, places in (
        ("handle_left", [ring.left for ring in rings]),
        ("handle_right", [ring.right for ring in rings]),
    ):
        _write(drawing, name, "FLOAT_VECTOR", "vector", _in_space(places, place))
    kinds = np.where(np.concatenate([ring.corners for ring in rings]), _FREE, _ALIGNED).astype(np.int32)
    for name in ("handle_type_left", "handle_type_right"):
        _write(drawing, name, "INT8", "value", kinds)


def _write_lines(drawing: object, strokes: Sequence[_Stroke]) -> None:
    """Write radii and colors of the points of lines; those of fills do not matter."""
    lines = [None if stroke.is_filled else stroke.fill.line for stroke in strokes]
    if not any(lines):
        return
    sizes = [len(stroke.points) for stroke in strokes]
    table = np.array([(0.0,) * 5 if line is None else (line.radius, *line.color) for line in lines])
    radius, *color, opacity = np.repeat(table, sizes, axis=0).T
    _write(drawing, "radius", "FLOAT", "value", radius)
    _write(drawing, "opacity", "FLOAT", "value", opacity)
    _write(drawing, "vertex_color", "FLOAT_COLOR", "color", np.stack([*color, np.ones_like(radius)], axis=1))


def _in_space(points: Sequence[NDArray[np.float64]], place: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.concatenate(points) @ place[:3, :2].T + place[:3, 3]


def _write(drawing: object, name: str, kind: str, key: str, values: NDArray) -> None:
    attribute = drawing.attributes.get(name) or drawing.attributes.new(name, kind, "POINT")
    flat = np.ascontiguousarray(values, np.int32 if kind == "INT8" else np.float32).ravel()
    attribute.data.foreach_set(key, flat)


def polygon_ring(ring: NDArray[np.float64]) -> BezierRing:
    """Convert a closed polygon, (n, 2), to straight Bezier segments."""
    third = (np.roll(ring, -1, axis=0) - ring) / 3.0
    left = ring - np.roll(third, 1, axis=0)
    return BezierRing(ring, left, ring + third, np.ones(len(ring), bool), 0.0)
