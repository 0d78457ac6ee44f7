# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbered labels at corresponding vertices, drawn over the 3D viewport on both objects."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import blf
import bmesh
import bpy
import gpu
from bpy_extras.view3d_utils import location_3d_to_region_2d
from mathutils import Vector

from ..viewport_overlay import ViewportOverlay, fill_discs

# Pixels at a UI scale of 1.
_TEXT_SIZE, _RADIUS, _DOT = 12.0, 10.0, 3.0
# Opacity of labels on the far side.
_FAINT = 0.35
_INK = (0.05, 0.05, 0.05)
# Hues that are distinguishable with color blindness: Okabe and Ito, "Color Universal Design", 2008.
_COLORS = (
    (0.90, 0.62, 0.0),
    (0.34, 0.71, 0.91),
    (0.0, 0.62, 0.45),
    (0.94, 0.89, 0.26),
    (0.84, 0.37, 0.0),
    (0.8, 0.47, 0.65),
)


@dataclass(frozen=True)
class LabeledVertex:
    """A vertex with a label.

    Attributes
    ----------
    obj : bpy.types.Object
        Its object.
    vertex : int
        Vertex index; labels of missing vertices are not drawn.
    number : int
        Text of the label.
    """

    obj: bpy.types.Object
    vertex: int
    number: int


@dataclass(frozen=True)
class Label:
    """A label in space.

    Attributes
    ----------
    number : int
        Text of the label.
    point : mathutils.Vector
        Position in world space.
    normal : mathutils.Vector
        Surface normal, of any length.
    """

    number: int
    point: Vector
    normal: Vector

    def faces(self, view: bpy.types.RegionView3D) -> bool:
        """Return whether the front of the surface is visible."""
        inverse = view.view_matrix.inverted()
        toward = inverse.translation - self.point if view.is_perspective else inverse.col[2].to_3d()
        return self.normal.dot(toward) >= 0.0


class PairLabels(ViewportOverlay[Sequence[LabeledVertex]]):
    """Draws labels while it is registered.

    Parameters
    ----------
    wanted : callable
        ``wanted(context)`` returns the vertices to label.
    """

    def _draw(self, wanted: Sequence[LabeledVertex], context: bpy.types.Context) -> None:
        for label in labels_of(wanted, context.view_layer.depsgraph):
            _draw_label(label, context)


def labels_of(vertices: Sequence[LabeledVertex], depsgraph: bpy.types.Depsgraph) -> list[Label]:
    """Return labels at the positions of their vertices after modifiers and edits; hidden objects have none."""
    return [label for label in (_label(vertex, depsgraph) for vertex in vertices) if label is not None]


def _label(labeled: LabeledVertex, depsgraph: bpy.types.Depsgraph) -> Label | None:
    obj, number = labeled.obj, labeled.vertex
    if obj.type != "MESH" or not 0 <= number < len(obj.data.vertices) or not obj.visible_get():
        return None
    evaluated = obj.evaluated_get(depsgraph)
    matrix = evaluated.matrix_world
    if obj.data.is_editmode:
        edited = bmesh.from_edit_mesh(obj.data)
        if number >= len(edited.verts):
            return None
        edited.verts.ensure_lookup_table()
        vertex = edited.verts[number]
    else:
        # If modifiers change the vertices, the original position is used.
        is_kept = len(evaluated.data.vertices) == len(obj.data.vertices)
        vertex = (evaluated.data if is_kept else obj.data).vertices[number]
    normal = matrix.to_3x3().inverted_safe().transposed() @ vertex.normal
    return Label(labeled.number, matrix @ vertex.co, normal)


def _draw_label(label: Label, context: bpy.types.Context) -> None:
    region, view = context.region, context.region_data
    place = location_3d_to_region_2d(region, view, label.point)
    if place is None:
        return
    scale = context.preferences.system.ui_scale
    opacity = 1.0 if label.faces(view) else _FAINT
    color = (*_COLORS[(label.number - 1) % len(_COLORS)], opacity)
    center = place + Vector((_RADIUS, _RADIUS)) * 1.2 * scale
    gpu.state.blend_set("ALPHA")
    fill_discs([place], (_DOT + 1.0) * scale, (*_INK, opacity))
    fill_discs([place], _DOT * scale, color)
    fill_discs([center], (_RADIUS + 1.0) * scale, (*_INK, opacity))
    fill_discs([center], _RADIUS * scale, color)
    gpu.state.blend_set("NONE")
    _write(str(label.number), center, _TEXT_SIZE * scale, (*_INK, opacity))


def _write(text: str, center: Vector, size: float, color: tuple[float, ...]) -> None:
    font = 0
    blf.size(font, size)
    blf.color(font, *color)
    width, height = blf.dimensions(font, text)
    blf.position(font, center.x - width / 2, center.y - height / 2, 0)
    blf.draw(font, text)
