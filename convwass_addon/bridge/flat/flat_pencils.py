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
from ...geometry.algebra.affine import transformed_points
from ...sentence import Sentence
from ..element_values import element_values, write_floats
from .flat_rings import FlatRings
from .flat_splines import cubic_points
from .pencil_looks import ShownDrawing, fill_color, is_drawn, line_of

# Blender's curve type for Bezier curves, and points per segment.
_BEZIER, _STEPS = 2, 16
# Largest difference of a transform from none that single precision makes.
_UNMOVED = 1e-5


def pencil_rings(obj: bpy.types.Object, evaluated: bpy.types.Object) -> FlatRings:
    """Read the filled strokes of a drawing at the current frame as polygons.

    Raises
    ------
    InputError
        No stroke is filled.
    """
    rings, lines, fills = [], [], []
    numbers: dict[tuple[int, int], int] = {}
    colors: list[tuple[float, ...]] = []
    leaves_lines_out = False
    for number, shown in enumerate(_shown_drawings(evaluated)):
        for index, stroke in enumerate(shown.drawing.strokes):
            material = _material_of(obj, stroke)
            if not is_drawn(material):
                continue
            line = line_of(material, stroke, shown)
            fill = _fill_of(material, stroke, index)
            if fill is None or len(stroke.points) < 3:
                leaves_lines_out |= line is not None
                continue
            if (number, fill) not in numbers:
                numbers[number, fill] = len(colors)
                # Its first stroke gives a fill its color.
                color = obj.color if material is None else material.grease_pencil.fill_color
                colors.append(fill_color(color, stroke, shown))
            rings.append(transformed_points(_points_of(stroke), shown.place))
            lines.append(line)
            fills.append(numbers[number, fill])
    if not rings:
        raise InputError(
            "{name} has no filled stroke at this frame; fill its strokes, or close and fill them again.", name=obj.name
        )
    notice = Sentence("Blends leave out the strokes of {name} that are not filled.", {"name": obj.name})
    return FlatRings(
        rings,
        np.array(evaluated.matrix_world, dtype=np.float64),
        "non-zero",
        notice=notice if leaves_lines_out else None,
        fills=tuple(fills),
        colors=tuple(colors[fill] for fill in fills),
        lines=tuple(lines),
    )


def freeze_drawing(
    obj: bpy.types.Object, evaluated: bpy.types.Object, move: NDArray[np.float64], first_frame: int
) -> None:
    """Let the copy of a drawing show in every frame what the drawing shows now, moved in the world.

    What a location, a rotation and a scale cannot express is done to its strokes.

    Parameters
    ----------
    obj : bpy.types.Object
        The copy, without a parent, and with data of its own.
    evaluated : bpy.types.Object
        The evaluated drawing.
    move : (4, 4)
        World space.
    first_frame : int
        The copy is shown from this frame on.
    """
    world = np.array(evaluated.matrix_world, dtype=np.float64)
    obj.matrix_world = Matrix((move @ world).tolist())
    basis = np.array(obj.matrix_basis, dtype=np.float64)
    retimed = any(modifier.type == "GREASE_PENCIL_TIME" for modifier in obj.modifiers)
    for layer in obj.data.layers:
        layer.parent = None
        before = evaluated.data.layers.get(layer.name)
        if before is None:
            continue
        own = basis @ np.array(layer.matrix_local, dtype=np.float64)
        way = np.linalg.solve(own, move @ _place_of(before, world))
        drawings = _drawings_of(layer) if retimed else _kept_drawings(layer, before.current_frame(), first_frame)
        for drawing in drawings:
            if np.abs(way - np.eye(4)).max() > _UNMOVED:
                _transform(drawing, way)


def _kept_drawings(layer: object, shown: object | None, first_frame: int) -> list[object]:
    """Remove all keyframes of a layer but the one that is shown, from a first frame on; return what it draws then."""
    drawings = _drawings_of(layer)
    if len(drawings) < len(layer.frames):
        # In copies, Blender removes a drawing that several keyframes show with the first of them.
        return drawings
    number = None if shown is None else shown.frame_number
    for other in [frame.frame_number for frame in layer.frames if frame.frame_number != number]:
        layer.frames.remove(other)
    if number is not None and number > first_frame:
        layer.frames.move(number, first_frame)
    return _drawings_of(layer)


def _drawings_of(layer: object) -> list[object]:
    """Return the drawings of all keyframes of a layer, without duplicates."""
    drawings = (frame.drawing for frame in layer.frames)
    return list({drawing.as_pointer(): drawing for drawing in drawings if drawing is not None}.values())


def _transform(drawing: object, matrix: NDArray[np.float64]) -> None:
    """Transform the strokes of a drawing."""
    for attribute in (drawing.attributes.get(name) for name in ("position", "handle_left", "handle_right")):
        if attribute is not None and len(attribute.data):
            points = transformed_points(element_values(attribute.data, "vector", 3), matrix)
            write_floats(attribute.data, "vector", points)
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


def _shown_drawings(evaluated: bpy.types.Object) -> Iterator[ShownDrawing]:
    """Yield the visible layers that have a drawing at the current frame, from bottom to top."""
    world = np.array(evaluated.matrix_world, dtype=np.float64)
    for layer in evaluated.data.layers:
        frame = layer.current_frame()
        if not _is_hidden(layer) and frame is not None and frame.drawing is not None:
            yield ShownDrawing(frame.drawing, layer.opacity, _place_of(layer, world))


def _is_hidden(layer: bpy.types.GreasePencilLayer) -> bool:
    """Return whether a layer, or a group that contains it, is hidden."""
    member = layer
    while member is not None:
        if member.hide:
            return True
        member = member.parent_group
    return False


def _place_of(layer: object, world: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the transform of an evaluated layer to world space, (4, 4), which follows its parent if it has one."""
    parent = layer.parent
    own = np.array(layer.matrix_local, dtype=np.float64)
    if parent is None:
        return world @ own
    space = parent.matrix_world
    bone = parent.pose.bones.get(layer.parent_bone) if parent.pose is not None else None
    if bone is not None:
        space = space @ bone.matrix
    return np.array(space @ layer.matrix_parent_inverse, dtype=np.float64) @ own


def _material_of(obj: bpy.types.Object, stroke: object) -> bpy.types.Material | None:
    """Return the material of a stroke if it is one for strokes."""
    slots = obj.material_slots
    material = slots[stroke.material_index].material if stroke.material_index < len(slots) else None
    return None if material is None or material.grease_pencil is None else material


def _fill_of(material: bpy.types.Material | None, stroke: object, index: int) -> int | None:
    """Return the fill that a stroke belongs to, or None if it is not filled."""
    if hasattr(stroke, "fill_id"):
        # From Blender 5.2, strokes with the same nonzero id are filled together.
        return stroke.fill_id or None
    return index if material is not None and material.grease_pencil.show_fill else None
