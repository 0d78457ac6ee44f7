# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Convert closed splines of curve and text objects to polygons."""

from __future__ import annotations

import unicodedata
from collections.abc import Iterable, Mapping, Sequence

import bpy
import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...geometry.algebra.affine import transformed_points
from ...sentence import Sentence
from ..element_values import element_values, write_floats
from .flat_kinds import TOUCHING
from .flat_rings import CurveStyle, FlatRings

# Points per curve segment. A circle of four segments with 24 points each has a relative area error of 1 - sin(x) / x, x
# = 2 pi / 96: 0.07 %.
_LEAST_STEPS, _MOST_STEPS = 24, 64
# What Blender adds to the number of a character for the spline of its underline.
_UNDERLINE = 1000
# A character that no font defines.
_NOBODYS = "\ue001"
# Characters up to this code are available in almost all fonts.
_LATIN = 255

_Sign = tuple[tuple[float, ...], ...]
"""Outline points of a glyph."""


def curve_rings(obj: bpy.types.Object, evaluated: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> FlatRings:
    """Read the closed splines of a curve or text object, with modifiers that are applied to its control points.

    Parameters
    ----------
    obj, evaluated : bpy.types.Object
        Original and evaluated object.
    depsgraph : bpy.types.Depsgraph
        The dependency graph of `evaluated`.

    Raises
    ------
    InputError
        The text is empty or has characters missing in its font, or there are no closed splines.
    """
    is_text = obj.type == "FONT"
    if is_text:
        check_text(obj, evaluated, depsgraph)
    try:
        curve = evaluated.to_curve(depsgraph, apply_modifiers=True)
        splines = list(curve.splines)
        matrix = np.array(evaluated.matrix_world, dtype=np.float64)
        found = [(spline, sampled_spline(spline)) for spline in splines]
        closed = [(spline, ring) for spline, ring in found if ring is not None and len(ring) >= 3]
        style = style_of(obj.data, matrix)
        letters = tuple(_letter_of(spline) for spline, _ in closed) if is_text else None
        slots = tuple(spline.material_index for spline, _ in closed)
    finally:
        evaluated.to_curve_clear()
    if not closed:
        raise _nothing_closed(obj.name, len(found))
    notice = None
    if len(closed) < len(found):
        values = {"name": obj.name, "count": len(found) - len(closed)}
        notice = Sentence("{name}: {count} open splines are ignored, since they fill no area.", values)
    rings = [transformed_points(ring, matrix) for _, ring in closed]
    return FlatRings(rings, matrix, "non-zero" if is_text else "even-odd", letters, slots, style, notice)


def check_text(obj: bpy.types.Object, evaluated: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> None:
    """Raise InputError if a text is empty or has characters missing in its font."""
    if not obj.data.body.strip():
        raise InputError("The text {name} is empty; type something into it.", name=obj.name)
    try:
        drawn = _drawn_signs(_glyphs(evaluated.to_curve(depsgraph).splines))
    finally:
        evaluated.to_curve_clear()
    _check_glyphs(obj, drawn)


def sampled_spline(spline: bpy.types.Spline) -> NDArray[np.float64] | None:
    """Points of a closed spline, (n, 3) in local space, or None if it is open.

    A spline that is not cyclic counts as closed if its ends touch.
    """
    if spline.type == "BEZIER":
        ring = _bezier_points(spline)
    elif spline.type == "POLY":
        ring = _vectors(spline.points, "co", 4)[:, :3]
    else:
        ring = _blenders_points(spline)
    if spline.use_cyclic_u:
        return ring
    extent = float(np.ptp(ring, axis=0).max())
    touches = extent > 0 and len(ring) > 3 and np.linalg.norm(ring[0] - ring[-1]) <= TOUCHING * extent
    return ring[:-1] if touches else None


def _bezier_points(spline: bpy.types.Spline) -> NDArray[np.float64]:
    points, left, right = (_vectors(spline.bezier_points, name, 3) for name in ("co", "handle_left", "handle_right"))
    controls = np.stack([points, right, np.roll(left, -1, axis=0), np.roll(points, -1, axis=0)])
    steps = int(np.clip(spline.resolution_u, _LEAST_STEPS, _MOST_STEPS))
    pieces = []
    for piece in range(len(points) if spline.use_cyclic_u else len(points) - 1):
        count = 1 if _is_straight(controls[:, piece]) else steps
        t = (np.arange(count) / count)[:, None]
        pieces.append(cubic_points(controls[:, piece], t))
    if not spline.use_cyclic_u:
        pieces.append(points[-1:])
    return np.concatenate(pieces)


def cubic_points(controls: NDArray[np.float64], t: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the points of Bezier curves with given control points, (4, ...), at t, from 0 to 1, which is broadcast."""
    a, b, c, d = controls
    return (1 - t) ** 3 * a + 3 * (1 - t) ** 2 * t * b + 3 * (1 - t) * t * t * c + t**3 * d


def _is_straight(controls: NDArray[np.float64]) -> bool:
    along = controls[3] - controls[0]
    away = np.cross(controls[1:3] - controls[0], along)
    return bool(np.abs(away).max() <= 1e-6 * max(float(along @ along), 1e-30))


def _blenders_points(spline: bpy.types.Spline) -> NDArray[np.float64]:
    """Points of other spline types, as evaluated by Blender."""
    curve = bpy.data.curves.new("", "CURVE")
    obj = bpy.data.objects.new("", curve)
    mesh = None
    try:
        curve.dimensions = "3D"
        own = curve.splines.new(spline.type)
        own.points.add(len(spline.points) - 1)
        for name, width in (("co", 4), ("weight", 1)):
            write_floats(own.points, name, _vectors(spline.points, name, width))
        own.order_u, own.resolution_u = spline.order_u, max(spline.resolution_u, _LEAST_STEPS)
        for name in ("use_cyclic_u", "use_endpoint_u", "use_bezier_u"):
            setattr(own, name, getattr(spline, name))
        mesh = bpy.data.meshes.new_from_object(obj)
        return _vectors(mesh.vertices, "co", 3)
    finally:
        bpy.data.batch_remove([obj, curve, *([mesh] if mesh else [])])


def _vectors(items: bpy.types.bpy_prop_collection, name: str, width: int) -> NDArray[np.float64]:
    return element_values(items, name, width).reshape(-1, width).astype(np.float64)


def style_of(curve: bpy.types.Curve, matrix: NDArray[np.float64]) -> CurveStyle:
    """Return the depth of a curve, in scene units, and its fill."""
    scales = np.linalg.norm(matrix[:3, :3], axis=0)
    across = float(np.sqrt(scales[0] * scales[1]))
    bevel = curve.bevel_depth if curve.bevel_mode == "ROUND" else 0.0
    # 3D curves are never filled, whatever their fill mode.
    mode = curve.fill_mode if curve.dimensions == "2D" else "NONE"
    return CurveStyle(
        float(curve.extrude * scales[2]), bevel * across, curve.offset * across, curve.bevel_resolution, mode
    )


def _glyphs(splines: Iterable[bpy.types.Spline]) -> list[bpy.types.Spline]:
    """Return the splines of a text without underlines."""
    return [spline for spline in splines if spline.type == "BEZIER"]


def _letter_of(spline: bpy.types.Spline) -> int:
    """Return the character that a spline of a text belongs to; underlines have other numbers."""
    return spline.character_index - (_UNDERLINE if spline.type == "POLY" else 0)


def _drawn_signs(splines: Sequence[bpy.types.Spline]) -> dict[int, _Sign]:
    """Glyph outlines of a text by character index."""
    grouped: dict[int, list[bpy.types.Spline]] = {}
    for spline in splines:
        grouped.setdefault(spline.character_index, []).append(spline)
    return {index: _shape_of(own) for index, own in grouped.items()}


def _check_glyphs(obj: bpy.types.Object, drawn: Mapping[int, _Sign]) -> None:
    """Raise InputError for characters missing in the font, which Blender omits or replaces by a box."""
    visible = [(index, sign) for index, sign in enumerate(obj.data.body) if _is_drawn(sign)]
    missing = [sign for index, sign in visible if index not in drawn or unicodedata.category(sign) in ("Co", "Cn")]
    if not missing and any(ord(sign) > _LATIN for _, sign in visible):
        box = _box_of(obj.data)
        missing = [sign for index, sign in visible if box is not None and drawn[index] == box]
    # Characters that overflow the text boxes are omitted deliberately.
    if missing and obj.data.overflow == "NONE":
        signs = " ".join(dict.fromkeys(missing))
        raise InputError(
            "The font of {name} has no {signs}; choose another font, or other letters.", name=obj.name, signs=signs
        )


def _is_drawn(sign: str) -> bool:
    # Combining marks and control characters may have no outline.
    return unicodedata.category(sign) not in ("Zs", "Zl", "Zp", "Cc", "Cf", "Mn", "Me")


def _box_of(text: bpy.types.TextCurve) -> _Sign | None:
    """Outline of the replacement glyph for missing characters, or None if there is none."""
    copy = text.copy()
    obj = bpy.data.objects.new("", copy)
    try:
        copy.body = _NOBODYS
        copy.follow_curve = None
        bpy.context.scene.collection.objects.link(obj)
        depsgraph = bpy.context.evaluated_depsgraph_get()
        found = obj.evaluated_get(depsgraph)
        splines = _glyphs(found.to_curve(depsgraph).splines)
        return _shape_of(splines) if splines else None
    finally:
        bpy.data.batch_remove([obj, copy])


def _shape_of(splines: Sequence[bpy.types.Spline]) -> _Sign:
    """Return outline points that identify a glyph, independent of its position."""
    points = [_vectors(spline.bezier_points, "co", 3) for spline in splines]
    low = np.min([own.min(axis=0) for own in points], axis=0)
    return tuple(tuple(np.round(own - low, 3).ravel().tolist()) for own in points)


def _nothing_closed(name: str, count: int) -> InputError:
    if count:
        return InputError(
            "{name} only has open splines, which fill no area; close them: in Edit Mode, Curve > Toggle Cyclic.",
            name=name,
        )
    return InputError("{name} has no splines; draw a closed curve.", name=name)
