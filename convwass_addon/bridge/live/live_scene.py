# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The temporary objects of a live morph: a shape, and a pad with a handle. None is saved with the file."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import bpy
import numpy as np

from ...geometry.arrays.bounds import common_bounds
from ..handles import Handle
from ..objects import write_triangles
from ..shape_sources import ShapeSource
from ..visibility import is_in
from .leftovers import LIVE_KEY, remove_live_objects
from .live_colors import show_colors
from .live_pad import LivePad

if TYPE_CHECKING:
    from ...applications.live.live_shapes import LiveShape
    from ...geometry.meshes.mesh import TriangleMesh


class LiveScene:
    """Creates, shows and removes the objects of a live morph.

    Parameters
    ----------
    scene : bpy.types.Scene
        Scene of the objects.
    view_layer : bpy.types.ViewLayer
        View layer in which inputs are hidden and the handle is selected.
    sources : sequence of ShapeSource
        The shapes.
    meshes : sequence of TriangleMesh
        Meshes of the shapes in world space.
    """

    def __init__(
        self,
        scene: bpy.types.Scene,
        view_layer: bpy.types.ViewLayer,
        sources: Sequence[ShapeSource],
        meshes: Sequence[TriangleMesh],
    ) -> None:
        collection = bpy.data.collections.new("Live Morph")
        scene.collection.children.link(collection)
        # Renders show the inputs, as saved files do; hidden in renders, these could stay so.
        collection.hide_render = True
        mesh = bpy.data.meshes.new("Live Morph")
        first = sources[0].parts[0]
        for slot in first.material_slots:
            mesh.materials.append(slot.material)
        shape = bpy.data.objects.new("Live Morph", mesh)
        shape.color = first.color
        collection.objects.link(shape)
        bounds = np.array([own.bounds for own in meshes])
        size = float((bounds[:, 1] - bounds[:, 0]).max())
        self.pad = LivePad(collection, [source.name for source in sources], common_bounds(bounds), size)
        for block in (collection, *collection.objects, *(obj.data for obj in collection.objects if obj.data)):
            block.is_runtime_data = True
        self._collection, self._shape = Handle.of("collections", collection), Handle.of("objects", shape)
        self._layer = view_layer.name
        self._scene = Handle.of("scenes", scene)
        inputs = list(dict.fromkeys(obj for source in sources for obj in (source.root, *source.parts)))
        self._selected = [Handle.of("objects", obj) for obj in inputs if obj.select_get(view_layer=view_layer)]
        active = view_layer.objects.active
        self._active = None if active is None else Handle.of("objects", active)
        visible = [obj for obj in inputs if is_in(view_layer, obj) and not obj.hide_get(view_layer=view_layer)]
        self._hidden = [Handle.of("objects", obj) for obj in visible]
        collection[LIVE_KEY] = "\n".join(str(handle.uid) for handle in self._hidden)
        self.hide_inputs()
        if is_in(view_layer, self.pad.handle):
            self.pad.handle.select_set(True, view_layer=view_layer)
            view_layer.objects.active = self.pad.handle

    @property
    def shape(self) -> bpy.types.Object | None:
        """The object that shows the blend; None if it was deleted."""
        return self._shape.find()

    @property
    def is_there(self) -> bool:
        """Return whether the scene and the objects still exist; undo or the user may remove them."""
        return None not in (self._scene.find(), self.shape, self.pad.handle, self.pad.pad)

    def show(self, blend: LiveShape) -> None:
        """Show a blend, unless its mesh is being edited."""
        shape = self.shape
        if shape is not None and not shape.data.is_editmode:
            write_triangles(shape.data, blend.mesh)
            if blend.colors is not None:
                show_colors(shape.data, blend.colors, in_solid=blend.is_solved)
            shape.location = blend.center

    def hide_inputs(self) -> None:
        """Hide the inputs in the viewport, because the blend replaces them."""
        self._set_hidden(True)

    def show_inputs(self) -> None:
        """Show the inputs that were visible before."""
        self._set_hidden(False)

    def _set_hidden(self, hidden: bool) -> None:
        layer = self._view_layer()
        for handle in self._hidden if layer is not None else ():
            obj = handle.find()
            if obj is not None and is_in(layer, obj):
                obj.hide_set(hidden, view_layer=layer)

    def _view_layer(self) -> bpy.types.ViewLayer | None:
        scene = self._scene.find()
        return None if scene is None else scene.view_layers.get(self._layer)

    def remove(self) -> None:
        """Remove all objects, show the inputs, and restore the selection."""
        self.show_inputs()
        remove_live_objects(self._collection.find())
        layer = self._view_layer()
        if layer is None:
            return
        for handle in self._selected:
            obj = handle.find()
            if obj is not None and is_in(layer, obj):
                obj.select_set(True, view_layer=layer)
        active = None if self._active is None else self._active.find()
        if active is not None and is_in(layer, active):
            layer.objects.active = active
