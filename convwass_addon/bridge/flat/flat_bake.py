# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Write a flat morph to the scene as curves, meshes or drawings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal, Self

import bpy
import numpy as np
from mathutils import Matrix

from ...applications.morphs.layouts import Blend
from ...geometry.plane.outlines import ring_area
from ..handles import Handle, found
from ..morphs.bake import SHEET_SPACING, MorphBake, assign_default_material, check_frames
from ..morphs.inputs.frozen_inputs import FrozenInput
from ..objects import evaluated_mesh, is_sheared, place_mesh
from ..unused_data import remove_if_unused
from ..visibility import evaluated_object
from .flat_curves import FittedFrame, mesh_of, write_curves, write_rings
from .flat_moves import MovedFlat
from .flat_paint import assign_region_materials, assign_see_through_material, paint_mesh, unused_materials
from .flat_pencils import freeze_drawing
from .flat_rings import blended_style
from .planes import blended_plane

FlatKind = Literal["CURVE", "MESH", "DRAWING"]
"""The kind of the frames: curve objects, mesh objects, or drawings of a Grease Pencil object."""

# Data collections by object type.
_LISTS = {"FONT": "curves", "CURVE": "curves", "MESH": "meshes"}


class FlatBake(MorphBake):
    """A flat morph being written; see :class:`.bake.MorphBake`."""

    @classmethod
    def begin_flat(
        cls,
        inputs: Sequence[bpy.types.Object],
        blends: Sequence[Blend],
        settings: dict[str, object],
        first_frame: int,
        flats: Sequence[MovedFlat],
        kind: FlatKind,
    ) -> Self:
        """Create the collection, and copies of the inputs in their current state.

        Parameters
        ----------
        inputs, blends, settings, first_frame
            As for :meth:`.bake.MorphBake.begin`.
        flats : sequence of MovedFlat
            The inputs as they were read.
        kind : "CURVE", "MESH" or "DRAWING"
            The kind of the frames.

        Raises
        ------
        InputError
            Blender does not support the first or the last frame; nothing is created then.
        """
        check_frames(first_frame, blends)
        depsgraph = bpy.context.evaluated_depsgraph_get()
        start = min(first_frame, bpy.context.scene.frame_start)
        copies = [_frozen(obj, flat, kind, depsgraph, start) for obj, flat in zip(inputs, flats, strict=True)]
        shapes = [_described(*each) for each in zip(inputs, copies, flats, strict=True)]
        bake = cls._opened(inputs, shapes, blends, settings, first_frame)
        bake._copies = [Handle.of("objects", copy) for copy in copies]
        bake._flats, bake._kind = tuple(flats), kind
        bake._material = shared_material(inputs)
        bake._see_through = tuple(map(_is_see_through, inputs, flats))
        return bake

    _copies: list[Handle]
    _flats: tuple[MovedFlat, ...]
    _kind: FlatKind
    _material: Handle | None
    _see_through: tuple[bool, ...]

    def _made(self, frame: FittedFrame, name: str) -> bpy.types.Object:
        """Make the object of a frame; frames that equal an input are copies of it."""
        if frame.outline is None:
            obj = self._living(self._copies[frame.blend.source]).copy()
            obj.name = name
            if obj.type != "GREASEPENCIL":
                _assign_default(obj.data, self._see_through[frame.blend.source])
            return obj
        weights = frame.blend.weights
        curve = bpy.data.curves.new(name, "CURVE")
        style = blended_style([flat.style for flat in self._flats], weights)
        if self._kind == "MESH" and style.fill_mode == "NONE":
            style = replace(style, fill_mode="BOTH")
        obj = bpy.data.objects.new(name, curve)
        colors = [region.color for region in frame.regions]
        # Material slots must exist before splines can use them.
        self._assign_materials(obj, colors)
        write_curves(curve, frame.curves, style, frame.owners)
        if self._kind == "MESH":
            obj = _as_mesh_object(obj)
            if len(colors) > 1:
                paint_mesh(obj.data, colors)
        obj.matrix_world = Matrix(blended_plane([flat.plane for flat in self._flats], weights).matrix)
        return obj

    def _assign_materials(self, obj: bpy.types.Object, colors: Sequence[Sequence[float]]) -> None:
        """Assign the colors of the regions, else the material shared by all inputs, else the material of all frames."""
        if len(colors) > 1:
            assign_region_materials(obj, colors)
            return
        material = self._material.find() if self._material is not None else None
        if material is not None:
            obj.data.materials.append(material)
        _assign_default(obj.data, any(self._see_through))

    def _sheet_location(self, blend: Blend) -> np.ndarray:
        """Return the position of a frame on a sheet, (3,): columns along the plane's X, rows against its Y."""
        planes = [flat.plane for flat in self._flats]
        step = SHEET_SPACING * max(shape.longest_side for shape in self._inputs)
        column, row = blend.place
        middles = np.array([shape.foot for shape in self._inputs])
        x, y = planes[0].axes[:, 0], planes[0].axes[:, 1]
        away = middles[0] - np.asarray(blend.weights) @ middles + step * (column * x - row * y)
        if blend.source is not None and self._kind != "DRAWING":
            return np.array(self._living(self._copies[blend.source]).location) + away
        return blended_plane(planes, blend.weights).origin + away

    def _drop_unused(self) -> None:
        bpy.data.batch_remove(found(self._copies))
        # Removed first, so that the material below is seen as unused.
        remove_if_unused(found([shape.mesh for shape in self._inputs]))
        super()._drop_unused()
        bpy.data.batch_remove(unused_materials())


def _frozen(
    obj: bpy.types.Object, flat: MovedFlat, kind: FlatKind, depsgraph: bpy.types.Depsgraph, start: int
) -> bpy.types.Object:
    """Copy an input in its current state, as an object of the same type or as a mesh, which takes a shear.

    Drawings are shown from a start frame on.
    """
    if obj.type == "EMPTY" or (obj.type == "GREASEPENCIL" and kind == "MESH"):
        copy = _of_rings(obj, flat)
        return _as_mesh_object(copy) if kind == "MESH" else copy
    with evaluated_object(obj, depsgraph) as evaluated:
        place = Matrix(flat.move.tolist()) @ evaluated.matrix_world
        if kind == "MESH" or obj.type == "MESH" or (obj.type != "GREASEPENCIL" and is_sheared(place)):
            mesh = evaluated_mesh(evaluated, depsgraph)
            copy = bpy.data.objects.new(obj.name, mesh)
            place_mesh(copy, place)
        else:
            copy = _own_copy(obj)
            if obj.type == "GREASEPENCIL":
                freeze_drawing(copy, evaluated, flat.move, start)
            else:
                copy.matrix_world = place
    copy.color = obj.color
    return copy


def _own_copy(obj: bpy.types.Object) -> bpy.types.Object:
    """Copy an object with its data and modifiers, without parent, constraints and animation."""
    copy = obj.copy()
    copy.data = obj.data.copy()
    for block in (copy, copy.data):
        block.animation_data_clear()
    copy.parent = None
    copy.constraints.clear()
    copy.delta_location = copy.delta_rotation_euler = (0.0, 0.0, 0.0)
    copy.delta_rotation_quaternion = (1.0, 0.0, 0.0, 0.0)
    copy.delta_scale = (1.0, 1.0, 1.0)
    copy.hide_render = copy.hide_viewport = False
    return copy


def _of_rings(obj: bpy.types.Object, flat: MovedFlat) -> bpy.types.Object:
    """Make a curve object from the outlines read from an input."""
    curve = bpy.data.curves.new(obj.name, "CURVE")
    write_rings(curve, flat.shape.rings, flat.style)
    copy = bpy.data.objects.new(obj.name, curve)
    copy.matrix_world = Matrix(flat.plane.matrix)
    copy.color = mean_color(flat)
    return copy


def _as_mesh_object(obj: bpy.types.Object) -> bpy.types.Object:
    """Replace a curve object that is not in a scene yet by a mesh object."""
    name, mesh, place, color = obj.name, mesh_of(obj), obj.matrix_basis.copy(), tuple(obj.color)
    # Removed first, so that its name is free.
    bpy.data.batch_remove([obj, obj.data])
    other = bpy.data.objects.new(name, mesh)
    other.matrix_basis, other.color = place, color
    return other


def _described(obj: bpy.types.Object, copy: bpy.types.Object, flat: MovedFlat) -> FrozenInput:
    points = np.concatenate(flat.shape.rings)
    low, high = points.min(axis=0), points.max(axis=0)
    middle = flat.plane.origin + flat.plane.axes[:, :2] @ ((low + high) / 2.0)
    data = Handle.of(_LISTS.get(copy.type, "") or _pencil_list(), copy.data)
    return FrozenInput(Handle.of("objects", obj), obj.name, mean_color(flat), data, float((high - low).max()), middle)


def _pencil_list() -> str:
    """Return the name of the collection of Grease Pencil data, which changed in Blender 5.0."""
    return "grease_pencils_v3" if hasattr(bpy.data, "grease_pencils_v3") else "grease_pencils"


def mean_color(flat: MovedFlat) -> tuple[float, ...]:
    """Mean color of an input, weighted by the areas of its rings."""
    areas = np.abs([ring_area(ring) for ring in flat.shape.rings])
    return tuple(float(value) for value in areas @ flat.shape.colors / areas.sum())


def _assign_default(data: bpy.types.ID, is_see_through: bool) -> None:
    """Assign the material of all frames, or the one with opacity, to data without material."""
    if is_see_through and not any(data.materials):
        data.materials.clear()
        assign_see_through_material(data)
    assign_default_material(data)


def _is_see_through(obj: bpy.types.Object, flat: MovedFlat) -> bool:
    """Return whether materials of an input are transparent; without any, its color does not make it so in renders."""
    return any(slot.material for slot in obj.material_slots) and bool((flat.shape.colors[:, 3] < 1.0).any())


def shared_material(inputs: Sequence[bpy.types.Object]) -> Handle | None:
    """Return the material that all inputs share, if there is exactly one."""
    used = [{slot.material for slot in obj.material_slots if slot.material} for obj in inputs]
    common = set.intersection(*used)
    if len(common) != 1 or any(len(own) != 1 for own in used) or any(obj.type == "GREASEPENCIL" for obj in inputs):
        return None
    return Handle.of("materials", common.pop())
