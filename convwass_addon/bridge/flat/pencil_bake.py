# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Write a flat morph to the scene as a Grease Pencil object with one drawing per frame."""

from __future__ import annotations

import bpy
import numpy as np
from mathutils import Matrix

from ...applications.flat.flat_frames import ColoredOutline
from ...applications.flat.flat_pieces import filled_by, layers_of
from ...geometry.plane.fitting import fitted_polygons
from ...geometry.plane.ring_nesting import outline_of
from ..edited_materials import remember_made
from ..handles import Handle, found
from ..morphs.bake import alone_in
from ..morphs.looks.materials import mark_as_frames
from ..unused_data import remove_if_unused
from .flat_bake import FlatBake, mean_color
from .flat_curves import FittedFrame
from .flat_strokes import Fill, fill_material, line_material, new_drawing_data, polygon_ring, write_fills
from .pencil_looks import StrokeLine, mean_line
from .planes import blended_plane

_LAYER = "Morph"
_LINES = "Lines"
# Error of an input's drawing, relative to its extent.
_ERROR = 1e-4


class PencilBake(FlatBake):
    """A flat morph being drawn: one object with a keyframe per blend of a path, otherwise one object per blend."""

    _drawing: Handle | None = None
    _inks: list[list[Handle]] | None = None
    _line_ink: Handle | None = None

    def _shown_object(self, frame: FittedFrame, index: int) -> bpy.types.Object:
        """Draw a frame of a path; the first frame creates the object."""
        if frame.blend.frame is None:
            return super()._shown_object(frame, index)
        collection = self._living(self._collection)
        if self._drawing is None:
            obj = self._new_object(collection.name, self._flats[0].plane.matrix)
            self._drawing = alone_in(collection, obj, frame.blend)
        obj = self._living(self._drawing)
        number = self._scene_frame(index)
        # A drawing is not shown before its first keyframe.
        self._draw(obj, frame, number if index else min(number, self._living(self._scene).frame_start))
        return obj

    def _made(self, frame: FittedFrame, name: str) -> bpy.types.Object:
        """Create an object with one drawing, in the plane of the blend."""
        obj = self._new_object(name, blended_plane([flat.plane for flat in self._flats], frame.blend.weights).matrix)
        self._draw(obj, frame, self._stored.first_frame)
        return obj

    def _new_object(self, name: str, place: np.ndarray) -> bpy.types.Object:
        data = new_drawing_data(name)
        # Fills should not be affected by lights.
        data.layers.new(_LAYER).use_lights = False
        for ink in (*(ink for inks in self._materials() for ink in inks), self._line_ink):
            if ink is not None:
                data.materials.append(self._living(ink))
        obj = bpy.data.objects.new(name, data)
        obj.matrix_world = Matrix(place)
        return obj

    def _materials(self) -> list[list[Handle]]:
        """Return a material for every color of every input; created on the first call, with one for lines if needed."""
        if self._inks is None:
            self._inks = []
            for shape, flat in zip(self._inputs, self._flats, strict=True):
                layers = layers_of(flat.shape)
                self._inks.append([_ink(fill_material(shape.name, flat.shape.colors[layer[0]])) for layer in layers])
            if any(any(flat.lines or ()) for flat in self._flats):
                self._line_ink = _ink(line_material(_LINES))
        return self._inks

    def _draw(self, obj: bpy.types.Object, frame: FittedFrame, number: int) -> None:
        plane = blended_plane([flat.plane for flat in self._flats], frame.blend.weights)
        place = np.linalg.inv(np.array(obj.matrix_basis, dtype=np.float64)) @ plane.matrix
        drawing = obj.data.layers[_LAYER].frames.new(number).drawing
        fills = self._fills_of_input(frame.blend.source) if frame.outline is None else self._fills_of_blend(frame)
        write_fills(drawing, fills, place, sum(map(len, self._materials())))

    def _fills_of_input(self, source: int) -> list[Fill]:
        """Layers of an input with their own materials, from bottom to top."""
        flat, first = self._flats[source], self._first_slot(source)
        shape = flat.shape
        error = _ERROR * float(np.ptp(np.concatenate(shape.rings), axis=0).max())
        fills = []
        for number, layer in enumerate(layers_of(shape)):
            outline = fitted_polygons(outline_of(filled_by(shape, layer)), error)
            regions = tuple(tuple(polygon_ring(ring) for ring in region.rings) for region in outline.regions)
            opacity = float(shape.colors[layer[0], 3])
            fills.append(Fill(regions, first + number, opacity, line=flat.line(layer)))
        return fills

    def _fills_of_blend(self, frame: FittedFrame) -> list[Fill]:
        """Regions of a blend, with the materials of the nearest input and their own colors.

        Solid viewports show the materials, everything else the colors.
        """
        weights = np.asarray(frame.blend.weights)
        nearest = int(np.argmax(weights))
        slot = self._first_slot(nearest)
        if not frame.regions:
            *color, opacity = (float(value) for value in weights @ np.array([mean_color(flat) for flat in self._flats]))
            line = mean_line([flat.line(np.arange(len(flat.shape.rings))) for flat in self._flats], weights)
            return [Fill(frame.grouped(frame.outline, 0), slot, opacity, tuple(color), line)]
        return [
            Fill(
                frame.grouped(region.outline, number),
                slot + region.layers[nearest],
                region.color[3],
                region.color[:3],
                self._line_of_region(region, weights),
            )
            for number, region in enumerate(frame.regions)
        ]

    def _line_of_region(self, region: ColoredOutline, weights: np.ndarray) -> StrokeLine | None:
        """Return the mean of the lines along the layers that a region comes from."""
        lines = [
            self._flats[index].line(layers_of(self._flats[index].shape)[layer])
            for index, layer in region.layers.items()
        ]
        return mean_line(lines, [weights[index] for index in region.layers])

    def _first_slot(self, source: int) -> int:
        return sum(len(inks) for inks in self._materials()[:source])

    def _show_in_time(self, collection: bpy.types.Collection, frames: dict[int, bpy.types.Object]) -> None:
        """Do nothing: keyframes already show the drawings in time."""

    def _drop_unused(self) -> None:
        super()._drop_unused()
        inks = [ink for inks in self._inks or [] for ink in inks]
        remove_if_unused(found([*inks, self._line_ink] if self._line_ink is not None else inks))


def _ink(material: bpy.types.Material) -> Handle:
    """Mark a new material as one of frames, and return its handle."""
    mark_as_frames(material)
    remember_made(material)
    return Handle.of("materials", material)
