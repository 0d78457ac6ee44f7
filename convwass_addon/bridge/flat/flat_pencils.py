# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Convert filled Grease Pencil strokes to polygons."""

from __future__ import annotations

from collections.abc import Iterator

import bpy
import numpy as np
from mathutils import Matrix
from numpy.typing import NDArray

from ...errors import InputError
from ...geometry.affine import transformed_points
from ..element_values import element_values
from ..objects import is_sheared
from .flat_rings import FlatRings
from .flat_splines import cubic_points

# Blender's curve type for Bezier curves, and points per segment.
_BEZIER, _STEPS = 2, 16


def pencil_rings(obj: bpy.types.Object, evaluated: bpy.types.Object) -> FlatRings:
    """Read the filled strokes of a drawing at the current frame as polygons.

    Raises
    ------
    InputError
        No stroke is filled.
    """
    matrix = np.array(evaluated.matrix_world, dtype=np.float64)
    rings, slots, fills = [], [], []
    known: dict[tuple[int, int], int] = {}
    for number, (own, drawing) in enumerate(_drawings(evaluated.data)):
        place = matrix @ own
        for index, stroke in enumerate(drawing.strokes):
            fill = _fill_of(obj, stroke, index)
            if fill is None or len(stroke.points) < 3:
                continue
            points = _points_of(stroke)
            rings.append(transformed_points(points, place))
            slots.append(stroke.material_index)
            fills.append(known.setdefault((number, fill), len(known)))
    if not rings:
        raise InputError(
            "{name} has no filled stroke at this frame; fill its strokes, or close and fill them again.", name=obj.name
        )
    return FlatRings(rings, matrix, "non-zero", None, tuple(slots), fills=tuple(fills))


def place_drawing(obj: bpy.types.Object, matrix: Matrix) -> None:
    """Place a drawing in the world; what a location, a rotation and a scale cannot express is done to its strokes.

    Parameters
    ----------
    obj : bpy.types.Object
        A Grease Pencil object without a parent, and with data of its own.
    matrix : Matrix
        The world matrix.
    """
    obj.matrix_world = matrix
    if not is_sheared(matrix):
        return
    plain, wanted = (np.array(own, dtype=np.float64) for own in (obj.matrix_basis, matrix))
    shear, done = np.linalg.solve(plain, wanted), set()
    for layer in obj.data.layers:
        own = np.array(layer.matrix_local, dtype=np.float64)
        # Several keyframes may show one drawing.
        drawings = {frame.drawing.as_pointer(): frame.drawing for frame in layer.frames if frame.drawing is not None}
        for key in drawings.keys() - done:
            _transform(drawings[key], np.linalg.solve(own, shear @ own))
        done |= drawings.keys()


def _transform(drawing: object, matrix: NDArray[np.float64]) -> None:
    """Transform the strokes of a drawing."""
    for attribute in (drawing.attributes.get(name) for name in ("position", "handle_left", "handle_right")):
        if attribute is not None and len(attribute.data):
            points = transformed_points(element_values(attribute.data, "vector", 3), matrix)
            attribute.data.foreach_set("vector", points.astype(np.float32).ravel())
    drawing.tag_positions_changed()


def _points_of(stroke: object) -> NDArray[np.float64]:
    """Points of a stroke, (n, 3); Bezier curves are sampled."""
    points = np.array([tuple(point.position) for point in stroke.points], dtype=np.float64)
    if stroke.curve_type != _BEZIER:
        return points
    left, right = (
        np.array([tuple(getattr(point, name).position) for point in stroke.points], dtype=np.float64)
        for name in ("handle_left", "handle_right")
    )
    t = (np.arange(_STEPS) / _STEPS)[:, None, None]
    controls = np.stack([points, right, np.roll(left, -1, axis=0), np.roll(points, -1, axis=0)])
    curve = cubic_points(controls, t)
    return curve.swapaxes(0, 1).reshape(-1, 3)


def _drawings(data: bpy.types.ID) -> Iterator[tuple[NDArray[np.float64], object]]:
    """Yield the drawing and the transform, (4, 4), of every visible layer."""
    for layer in data.layers:
        frame = layer.current_frame()
        if not layer.hide and frame is not None and frame.drawing is not None:
            yield np.array(layer.matrix_local, dtype=np.float64), frame.drawing


def _fill_of(obj: bpy.types.Object, stroke: object, index: int) -> int | None:
    """Return the fill that a stroke belongs to, or None if it is not filled."""
    if hasattr(stroke, "fill_id"):
        # From Blender 5.2, strokes with the same nonzero id are filled together.
        return stroke.fill_id or None
    slots = obj.material_slots
    material = slots[stroke.material_index].material if stroke.material_index < len(slots) else None
    filled = material is not None and material.grease_pencil is not None and material.grease_pencil.show_fill
    return index if filled else None
