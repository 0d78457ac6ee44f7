# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Write outlines as filled strokes of a Grease Pencil drawing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray

from ...geometry.fitting import BezierRing
from ...geometry.outlines import FlatRegion
from ...geometry.ring_nesting import keyholed

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
    color : (float, float, float, float) or None
        Replaces the color of the material; None for that color.
    """

    regions: tuple[tuple[BezierRing, ...], ...]
    slot: int
    color: tuple[float, float, float, float] | None = None


def new_drawing_data(name: str) -> bpy.types.ID:
    """Create Grease Pencil data, whose collection changed in Blender 5.0."""
    kind = bpy.data.grease_pencils_v3 if hasattr(bpy.data, "grease_pencils_v3") else bpy.data.grease_pencils
    return kind.new(name)


def fill_material(name: str, color: Sequence[float]) -> bpy.types.Material:
    """Create a material that fills strokes with a scene linear RGBA color and draws no lines."""
    material = bpy.data.materials.new(name)
    bpy.data.materials.create_gpencil_data(material)
    own = material.grease_pencil
    own.fill_color = own.color = color
    material.diffuse_color = color
    if bpy.app.version < (5, 2, 0):
        # Later versions set this per stroke.
        own.show_fill, own.show_stroke = True, False
    return material


def write_fills(drawing: object, fills: Sequence[Fill], place: NDArray[np.float64]) -> None:
    """Draw overlapping fills in an empty drawing.

    From Blender 5.2, strokes are Bezier curves, and holes are strokes of the same fill. Before, every stroke is filled
    separately, so strokes are polygons with cuts to their holes.

    Parameters
    ----------
    drawing : bpy.types.GreasePencilDrawing
        The drawing of a keyframe.
    fills : sequence of Fill
        From bottom to top.
    place : (4, 4)
        Transform from the plane of the fills to object space.
    """
    write = _write_curves if bpy.app.version >= (5, 2, 0) else _write_polygons
    write(drawing, fills, place)


def _write_curves(drawing: object, fills: Sequence[Fill], place: NDArray[np.float64]) -> None:
    rings = [(ring, fill) for fill in fills for region in fill.regions for ring in region]
    if not rings:
        return
    regions = [region for fill in fills for region in fill.regions]
    numbers = [number for number, region in enumerate(regions, start=1) for _ in region]
    drawing.add_strokes([len(ring.points) for ring, _ in rings])
    drawing.set_types(type="BEZIER")
    for name, places in (
        ("position", [ring.points for ring, _ in rings]),
        ("handle_left", [ring.left for ring, _ in rings]),
        ("handle_right", [ring.right for ring, _ in rings]),
    ):
        _write(drawing, name, "FLOAT_VECTOR", "vector", _in_space(np.concatenate(places), place))
    kinds = np.where(np.concatenate([ring.corners for ring, _ in rings]), _FREE, _ALIGNED)
    for name in ("handle_type_left", "handle_type_right"):
        _write(drawing, name, "INT8", "value", kinds)
    for stroke, (_, fill), number in zip(drawing.strokes, rings, numbers, strict=True):
        _finish(stroke, fill)
        stroke.fill_id, stroke.hide_stroke = number, True
    drawing.tag_positions_changed()


def _write_polygons(drawing: object, fills: Sequence[Fill], place: NDArray[np.float64]) -> None:
    rings = [(_polygon(region), fill) for fill in fills for region in fill.regions]
    if not rings:
        return
    drawing.add_strokes([len(ring) for ring, _ in rings])
    _write(drawing, "position", "FLOAT_VECTOR", "vector", _in_space(np.concatenate([r for r, _ in rings]), place))
    for stroke, (_, fill) in zip(drawing.strokes, rings, strict=True):
        _finish(stroke, fill)
    drawing.tag_positions_changed()


def _polygon(region: tuple[BezierRing, ...]) -> NDArray[np.float64]:
    sampled = [ring.sampled(_STEPS) for ring in region]
    outer, *holes = sampled
    return keyholed(FlatRegion(outer, tuple(holes)))


def _finish(stroke: object, fill: Fill) -> None:
    stroke.cyclic = True
    stroke.material_index = fill.slot
    if fill.color is not None:
        stroke.fill_color = fill.color


def _in_space(points: NDArray[np.float64], place: NDArray[np.float64]) -> NDArray[np.float64]:
    return points @ place[:3, :2].T + place[:3, 3]


def _write(drawing: object, name: str, kind: str, key: str, values: NDArray) -> None:
    attribute = drawing.attributes.get(name) or drawing.attributes.new(name, kind, "POINT")
    attribute.data.foreach_set(key, np.ascontiguousarray(values, np.int32 if key == "value" else np.float32).ravel())


def polygon_ring(ring: NDArray[np.float64]) -> BezierRing:
    """Convert a closed polygon, (n, 2), to straight Bezier segments."""
    third = (np.roll(ring, -1, axis=0) - ring) / 3.0
    left = ring - np.roll(third, 1, axis=0)
    return BezierRing(ring, left, ring + third, np.ones(len(ring), bool), 0.0)
