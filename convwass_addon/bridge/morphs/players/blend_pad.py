# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A sheet of blends as a pad: an Empty is dragged in a square or triangle, and one object shows the blend there.

Geometry Nodes read the position of the Empty, so a file does not need the add-on, and keys on the Empty animate the
blend.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import bpy
import numpy as np

from ....applications.live.pad_places import pad_height
from ....applications.morphs.layouts import Blend, grid_blends, triangle_blends
from ....errors import InputError
from ....geometry.arrays.bounds import bounds_of
from ...element_values import vectors_of
from ...nodes.node_inputs import node_input
from ...nodes.node_math import joined, math_node, new_node, pick, switch
from ...nodes.node_trees import GroupInput, add_inputs
from ...pad_handles import pad_handle, pad_labels, pad_lines
from ...render_settings import take_render_settings
from ...rendered_maps import take_color_name
from ...sequence import MODIFIER, frame_group, nearest, object_info, output, table_object
from ..fields.mixed_frames import DETAIL, INTERPOLATE
from ..fields.sheet_mixture import SheetLattice, mixed_sheet, sheet_columns
from ..fields.stored_fields import StoredFields
from ..frame_switch import FrameSwitch
from ..looks.frame_colors import colored, made_for, seen_materials
from ..stand_ins import adopt, collections_for_stand_ins, hide_frames, require_none
from ..stored import frame_objects, frame_weights, interpolates, stored_morph
from .pad_inputs import HANDLE, HANDLE_VELOCITY, PAD

if TYPE_CHECKING:
    from ..fields.field_sampling import SampledFields

SIDE = 1.5
"""Length of a side of the pad, relative to the largest shape."""

GAP = 0.5
"""Distance between the pad and the shown blend, relative to the largest shape."""

TEXT = 0.07
"""Height of the names at the corners, relative to the side of the pad."""

COPY = 0.22
"""Size of the shapes at the corners, relative to the side of the pad."""

PLACE_KEY = "convwass_place"
"""Custom property of the lattice of a pad and of its blend: the location where it was made."""


@dataclass(frozen=True)
class BlendPad:
    """Result of `make_blend_pad`.

    Attributes
    ----------
    pad : bpy.types.Object
        The visible lattice with one vertex per blend; parent of all objects except `result`.
    handle : bpy.types.Object
        The Empty to drag.
    result : bpy.types.Object
        Shows the blend.
    """

    pad: bpy.types.Object
    handle: bpy.types.Object
    result: bpy.types.Object


@dataclass(frozen=True)
class _Sheet:
    """A sheet of blends and the layout of its pad."""

    names: list[str]
    """Names of the inputs."""
    frames: list[bpy.types.Object]
    blends: list[Blend]
    """One blend per frame object."""
    corners: list[int]
    """The frame of each unchanged input."""
    feet: np.ndarray
    """Center of the underside of each input, local space of its frame, (k, 3)."""
    size: float
    """Size of the largest input."""
    points: np.ndarray
    """Position of each blend in local space of the pad, (n, 3); the origin is the center of the corners."""

    @property
    def side(self) -> float:
        return SIDE * self.size

    @property
    def lattice(self) -> SheetLattice:
        count, last = len(self.names), round(max(blend.place[1] for blend in self.blends))
        return SheetLattice(self.points[0], self.side / last, pad_height(count), last, count == 3)

    @property
    def weights(self) -> np.ndarray:
        return np.array([blend.weights for blend in self.blends])


def make_blend_pad(collection: bpy.types.Collection, *, between: str = "NEAREST") -> BlendPad:
    """Sample fields if the pad is to interpolate `between` blends, and run :func:`build_blend_pad`."""
    require_sheet(collection)
    sampled = _sampled(collection) if interpolates(collection, between) else None
    return build_blend_pad(collection, sampled=sampled)


def build_blend_pad(collection: bpy.types.Collection, *, sampled: SampledFields | None) -> BlendPad:
    """Create a pad from a sheet of four or three shapes, and hide the sheet's own objects.

    The blend at the Empty is shown at the position of the first shape; the pad is to its left, upright like the sheet.
    Outside of the pad, the blend at its edge is shown.

    Parameters
    ----------
    collection : bpy.types.Collection
        A finished sheet in the layout grid or triangle.
    sampled : SampledFields or None
        Fields of the blends, with which the pad mixes the three around the Empty; without them, and for flat shapes,
        it shows the nearest one.

    Returns
    -------
    BlendPad

    Raises
    ------
    InputError
        As `require_sheet`.
    """
    require_none(collection)
    sheet = _read_sheet(collection)
    fields = None if sampled is None else _stored(collection, sheet, sampled)
    parts = bpy.data.collections.new(collection.name.replace("Morph", "Blend Pad", 1))
    for parent in collections_for_stand_ins(collection):
        parent.children.link(parts)
    pad = _linked(parts, _pad(sheet))
    # The right and lower edges.
    corner = np.array([sheet.points[:, 0].max(), 0.0, sheet.points[:, 2].min()])
    pad.location = sheet.feet[0] - (GAP + 0.5) * np.array([sheet.size, 0.0, 0.0]) - corner
    pad[PLACE_KEY] = pad.location
    # The initial position is the center.
    handle = _linked(parts, pad_handle("Blend Handle", 0.06 * sheet.side, sheet.points, pad))
    texts = pad_labels(sheet.names, sheet.points[sheet.corners], TEXT * sheet.side, pad)
    for drawn in (*texts, _copies(sheet, pad)):
        _linked(parts, drawn)
    result = _linked(parts, _result(sheet, pad, handle, fields))
    result.location = sheet.feet[0]
    result[PLACE_KEY] = result.location
    shown = [obj.modifiers[MODIFIER].node_group for obj in parts.objects if MODIFIER in obj.modifiers]
    adopt(collection, [parts, *parts.objects, *(block for tree in shown for block in made_for(tree))])
    hide_frames(collection)
    return BlendPad(pad, handle, result)


def require_sheet(collection: bpy.types.Collection) -> None:
    """Raise InputError if no pad can be created for a morph; its frames need not be meshes.

    Raises
    ------
    InputError
        Not a sheet, a sheet whose bake was stopped, or another object already shows it.
    """
    require_none(collection)
    require_all_blends(collection)


def require_all_blends(collection: bpy.types.Collection) -> None:
    """Raise InputError if the frames of a morph, which a pad may show already, are no sheet or not all of it."""
    _sheet_blends(collection, frame_objects(collection))


def _linked(parent: bpy.types.Collection, obj: bpy.types.Object) -> bpy.types.Object:
    parent.objects.link(obj)
    return obj


def _read_sheet(collection: bpy.types.Collection) -> _Sheet:
    """Find the blends of the frame objects, and the size of the shapes."""
    frames, names = frame_objects(collection), stored_morph(collection).inputs
    blends = _sheet_blends(collection, frames)
    corners = [next(place for place, blend in enumerate(blends) if blend.source == i) for i in range(len(names))]
    bounds = [bounds_of(vectors_of(frames[corner].data.vertices)) for corner in corners]
    feet = np.array([[*((low + high) / 2.0)[:2], low[2]] for low, high in bounds])
    size = max(float((high - low).max()) for low, high in bounds)
    last = max(blend.place[1] for blend in blends)
    places = np.array([blend.place for blend in blends]) / last
    down = pad_height(len(names)) * places[:, 1]
    points = SIDE * size * np.stack([places[:, 0], np.zeros(len(blends)), -down], axis=1)
    return _Sheet(names, frames, blends, corners, feet, size, points - points[corners].mean(axis=0))


def _sheet_blends(collection: bpy.types.Collection, frames: list[bpy.types.Object]) -> list[Blend]:
    """Return the blend of every frame object; raises InputError if they are not a complete sheet."""
    blends = _layout(frame_weights(frames) if frames else np.empty((0, 0)))
    if blends is None:
        raise InputError(
            "{name} is not a complete sheet of four shapes in a grid or three in a triangle; bake one with that "
            "layout, to its end.",
            name=collection.name,
        )
    return blends


def _layout(weights: np.ndarray) -> list[Blend] | None:
    """Return the blends of the sheet with these weights (n, k) in this order, or None if there is none."""
    count, shapes = weights.shape
    if shapes == 4:
        steps = math.isqrt(count)
        blends = grid_blends(4, steps) if steps >= 2 else []
    elif shapes == 3:
        steps = (math.isqrt(8 * count + 1) - 1) // 2
        blends = triangle_blends(3, steps) if steps >= 2 else []
    else:
        return None
    expected = np.array([blend.weights for blend in blends])
    return blends if expected.shape == weights.shape and np.allclose(expected, weights, atol=1e-6) else None


def _pad(sheet: _Sheet) -> bpy.types.Object:
    """Draw the lattice of the blends, with an edge between neighbors."""
    spans = np.linalg.norm(sheet.points[:, None] - sheet.points[None], axis=2)
    step = spans[spans > 0].min()
    edges = np.argwhere(np.triu((spans > 0) & (spans < 1.01 * step)))
    return pad_lines("Blend Pad", sheet.points, edges.tolist())


def _copies(sheet: _Sheet, pad: bpy.types.Object) -> bpy.types.Object:
    """Add small copies of the inputs next to their names."""
    tree = frame_group("Blend Corners")
    shown = []
    scale = COPY * sheet.side / sheet.size
    corners = [sheet.frames[corner] for corner in sheet.corners]
    for frame, corner, foot in zip(corners, sheet.corners, sheet.feet, strict=True):
        shift = -(2.6 * TEXT + COPY) if sheet.points[corner, 2] < 0.0 else 2.4 * TEXT
        lifted = sheet.points[corner] + np.array([0.0, 0.0, shift * sheet.side])
        inputs = {
            "Scale": (scale, scale, scale),
            "Translation": lifted - scale * foot,
            "Geometry": object_info(tree, frame).outputs["Geometry"],
        }
        small = new_node(tree, "GeometryNodeTransform", inputs)
        shown.append(colored(tree, small.outputs["Geometry"], tuple(frame.color), corners))
    output(tree, joined(tree, shown), 1)
    copies = table_object(tree.name, [(0.0, 0.0, 0.0)], tree, seen_materials(tree, corners))
    take_color_name(copies.data, [obj.data for obj in corners])
    copies.parent = pad
    copies.hide_render = copies.hide_select = True
    return copies


def _sampled(collection: bpy.types.Collection) -> SampledFields:
    """Sample the fields of the blends."""
    from ..fields.field_sampling import sampled_fields

    return sampled_fields(collection, frame_objects(collection))


def _stored(collection: bpy.types.Collection, sheet: _Sheet, sampled: SampledFields) -> StoredFields:
    """Store the fields of the blends."""
    from ..fields.field_sampling import store_fields

    columns = sheet_columns(sheet.frames, sheet.weights @ sheet.feet)
    return store_fields(collection, sheet.frames, sampled, sheet.points, columns)


def _result(
    sheet: _Sheet, pad: bpy.types.Object, handle: bpy.types.Object, fields: StoredFields | None
) -> bpy.types.Object:
    """Create the object that shows the blend at the Empty, with its foot at its origin."""
    tree = frame_group("Blend")
    _add_inputs(tree, fields is not None)
    inputs = tree.nodes.new("NodeGroupInput").outputs
    drawn = object_info(tree, inputs[PAD])
    place = _place_on(tree, drawn, object_info(tree, inputs[HANDLE]))
    index = nearest(tree, drawn.outputs["Geometry"], place)
    blends = FrameSwitch.of("Blend", sheet.frames)
    blend = blends.at(tree, index)
    shifts = [tuple(-foot) for foot in sheet.weights @ sheet.feet]
    moving = {"Geometry": blend["Geometry"], "Translation": pick(tree, "VECTOR", index, shifts)}
    moved = new_node(tree, "GeometryNodeTransform", moving)
    shown, color = moved.outputs["Geometry"], blend["Color"]
    if fields is not None:
        handle_velocity = inputs[HANDLE_VELOCITY]
        mixed = mixed_sheet(tree, fields, blends, sheet.lattice, place, inputs[DETAIL], handle_velocity)
        interpolates = math_node(tree, "GREATER_THAN", inputs[INTERPOLATE], mixed.is_shape)
        shown = switch(tree, "GEOMETRY", interpolates, shown, mixed.geometry)
        color = switch(tree, "RGBA", interpolates, color, mixed.color)
    output(tree, colored(tree, shown, color, sheet.frames), 1)
    shown = table_object(tree.name, [(0.0, 0.0, 0.0)], tree, seen_materials(tree, sheet.frames))
    take_color_name(shown.data, [obj.data for obj in sheet.frames])
    take_render_settings(shown, sheet.frames)
    for name, part in ((PAD, pad), (HANDLE, handle)):
        node_input(shown.modifiers[MODIFIER], name).set(part)
    return shown


def _add_inputs(tree: bpy.types.NodeTree, interpolates: bool) -> None:
    """Add the inputs of the modifier to the node group."""
    switches = (GroupInput(name, "Bool", True, "") for name in (INTERPOLATE, DETAIL))
    velocity = "Velocity of the handle in local space of the pad, for motion blur"
    mixing = (*switches, GroupInput(HANDLE_VELOCITY, "Vector", None, velocity))
    parts = (
        GroupInput(PAD, "Object", None, "Lattice with a vertex per blend"),
        GroupInput(HANDLE, "Object", None, "Its place on the pad selects the blend"),
    )
    add_inputs(tree, (*(mixing if interpolates else ()), *parts))


def _place_on(tree: bpy.types.NodeTree, pad: bpy.types.Node, handle: bpy.types.Node) -> bpy.types.NodeSocket:
    """Return the position of the Empty in local space of the pad, both given as nodes."""
    inverse = new_node(tree, "FunctionNodeInvertMatrix", {"Matrix": pad.outputs["Transform"]}).outputs["Matrix"]
    inputs = {"Vector": handle.outputs["Location"], "Transform": inverse}
    return new_node(tree, "FunctionNodeTransformPoint", inputs).outputs["Vector"]
