# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Write a morph to the scene frame by frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import bpy
import numpy as np

from ...applications.morphs.diagnostics import Diagnostic, diagnose
from ...applications.morphs.layouts import Blend
from ...applications.morphs.morph_problem import MorphFrame
from ...errors import ConvwassError, InputError
from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.meshes.polygons import Polygons
from ...geometry.solids.alignment import RigidMove
from ..animation_time import show_time, times_per_second
from ..handles import Handle, found
from ..keyframes import FrameRange, key_visibility
from ..object_names import library_of
from ..objects import write_mesh
from ..render_settings import take_render_settings
from ..shape_sources import OBJECTS, shape_sources
from ..unused_data import remove_if_unused
from ..visibility import is_in, layers_with
from .changes import signature, store_signatures
from .inputs.frozen_inputs import FrozenInput, frozen_inputs
from .inputs.hidden_inputs import hide_shapes
from .looks.materials import MATERIAL_NAME, morph_material
from .removal import remove_bake, remove_objects
from .stored import (
    ALONE_KEY,
    FIRST_FRAMES,
    FRAME_KEY,
    INDEX_KEY,
    WEIGHTS_KEY,
    StoredMorph,
    store,
    store_diagnostics,
    summary,
)

SHEET_SPACING = 1.3
"""Distance between neighbors in a sheet, in sizes of the largest input."""


@dataclass(frozen=True)
class _Finished:
    obj: Handle
    record: dict[str, object]


@dataclass(frozen=True)
class _Hidden:
    """An input hidden by previews in a view layer, and whether it was selected there."""

    obj: Handle
    layer: str
    selected: bool


class MorphBake:
    """A morph being written: `begin`, then `add` for each frame, then `finish` or `discard`.

    Until `finish`, nothing outside the morph's collection changes, except that previews hide the inputs in the
    viewport. Undo between two calls is detected.
    """

    @classmethod
    def begin(
        cls,
        inputs: Sequence[bpy.types.Object],
        blends: Sequence[Blend],
        settings: dict[str, object],
        first_frame: int,
        moves: Sequence[RigidMove] | None = None,
    ) -> MorphBake:
        """Create the collection at the top level of the current scene, and copies of the inputs in their current state.

        Parameters
        ----------
        inputs : sequence of bpy.types.Object
            The shapes, including hidden ones; for shapes of several objects, the Empty that represents them.
        blends : sequence of Blend
            All frames that may be added.
        settings : dict
            Settings to store: numbers, strings, booleans, None and lists of these.
        first_frame : int
            Scene frame of the blend with frame 0.
        moves : sequence of RigidMove, optional
            Transforms of the copied inputs, one per input.

        Raises
        ------
        InputError
            Blender does not support the first or the last frame, or an input has no faces; nothing is created then.
        """
        check_frames(first_frame, blends)
        grouping = settings.get("grouping", OBJECTS)
        shapes = frozen_inputs(shape_sources(inputs, grouping), moves or [None] * len(inputs))
        return cls._opened(inputs, shapes, blends, settings, first_frame)

    @classmethod
    def _opened(
        cls,
        inputs: Sequence[bpy.types.Object],
        shapes: list[FrozenInput],
        blends: Sequence[Blend],
        settings: dict[str, object],
        first_frame: int,
    ) -> Self:
        """Create the collection with the description of the morph."""
        joint = " to " if blends[0].frame is not None else " and "
        collection = bpy.data.collections.new("Morph " + joint.join(shape.name for shape in shapes))
        bpy.context.scene.collection.children.link(collection)
        libraries = [library_of(obj) for obj in inputs]
        names, per_second = [obj.name for obj in inputs], times_per_second(bpy.context.scene)
        stored = StoredMorph(names, settings, first_frame, [], libraries, per_second)
        bake = cls(collection, shapes, blends, stored)
        store(collection, bake._stored)
        # Inputs that are followed are others in every frame.
        followed = settings.get("follow") == "FOLLOW"
        grouping = settings.get("grouping", OBJECTS)
        store_signatures(collection, [] if followed else list(map(signature, shape_sources(inputs, grouping))))
        return bake

    def show_copies(self, meshes: Sequence[bpy.types.Mesh]) -> None:
        """Show these copies of the inputs, one each, where frames are inputs."""
        copies = zip(self._inputs, meshes, strict=True)
        self._inputs = [replace(own, shown=Handle.of("meshes", mesh)) for own, mesh in copies]

    def __init__(
        self, collection: bpy.types.Collection, shapes: list[FrozenInput], blends: Sequence[Blend], stored: StoredMorph
    ) -> None:
        self._scene = Handle.of("scenes", bpy.context.scene)
        self._collection = Handle.of("collections", collection)
        self._inputs = shapes
        self._blends = tuple(blends)
        self._stored = stored
        self._finished: dict[int, _Finished] = {}
        self._previews: dict[int, Handle] = {}
        self._hidden: list[_Hidden] = []
        self._action: Handle | None = None
        self._brings_material = MATERIAL_NAME not in bpy.data.materials

    @property
    def scene(self) -> bpy.types.Scene:
        """The scene of the morph; raises ConvwassError if it was removed."""
        return self._living(self._scene)

    @property
    def collection(self) -> bpy.types.Collection:
        """The morph; raises ConvwassError if it was removed."""
        return self._living(self._collection)

    @property
    def inputs(self) -> list[FrozenInput]:
        """What is kept of the inputs."""
        return list(self._inputs)

    @property
    def frozen(self) -> list[bpy.types.Mesh]:
        """Copies of the inputs, shown by frames; no frame may use them yet."""
        return [self._living(shape.mesh) for shape in self._inputs]

    def add(self, frame: MorphFrame) -> bpy.types.Object:
        """Make the object of a finished frame; a preview or an earlier version of the frame is reused.

        In a path, it is only visible in its frame; the first one also before, the last one also after the path. In a
        sheet, it is placed in its column (along +X) and row (downwards), corrected for the positions of the inputs. A
        single blend stays at the position of the barycenter.

        Raises
        ------
        ConvwassError
            The collection was removed, for example by undo.
        """
        self._living(self._collection)
        index = self._blends.index(frame.blend)
        before = self._previews.pop(index, None)
        if before is None and index in self._finished:
            before = self._finished[index].obj
        obj = self._object_showing(frame, index, before)
        self._finished[index] = _Finished(Handle.of("objects", obj), frame.record)
        return obj

    def preview(self, frame: MorphFrame) -> None:
        """Show a preview of a frame, or improve it.

        `add` replaces previews, `finish` removes the remaining ones.

        Raises
        ------
        ConvwassError
            The collection was removed, for example by undo.
        """
        index = self._blends.index(frame.blend)
        if not self._previews and not self._finished:
            self._hide_behind_previews()
        obj = self._object_showing(frame, index, self._previews.get(index))
        self._previews[index] = Handle.of("objects", obj)

    def _object_showing(self, frame: MorphFrame, index: int, before: Handle | None) -> bpy.types.Object:
        """Let the object from before show a frame, or a new one if there is none any more."""
        obj = None if before is None else before.find()
        if obj is None:
            return self._shown_object(frame, index)
        if frame.mesh is not None:
            self._write(obj.data, frame.mesh)
        return obj

    def keep_previews(self) -> bool:
        """Keep the previews as frames if nothing else is finished; return whether there are any."""
        if self._finished or not self._previews:
            return False
        for index, handle in self._previews.items():
            record = {"weights": self._blends[index].weights, "preview": True}
            self._finished[index] = _Finished(handle, record)
        self._previews.clear()
        return True

    @property
    def _input_objects(self) -> list[Handle]:
        """The objects of all inputs."""
        return [own for shape in self._inputs for own in shape.objects]

    def _hide_behind_previews(self) -> None:
        """Hide the inputs in the viewport, since they would overlap with previews."""
        scene = self._living(self._scene)
        for handle in self._input_objects:
            obj = handle.find()
            for layer in layers_with(obj, [scene]) if obj is not None else ():
                if not obj.hide_get(view_layer=layer):
                    self._hidden.append(_Hidden(handle, layer.name, obj.select_get(view_layer=layer)))
                    obj.hide_set(True, view_layer=layer)

    def _show_inputs(self) -> None:
        """Show the inputs that were hidden by previews."""
        scene = self._scene.find()
        for hidden in self._hidden:
            obj = hidden.obj.find()
            layer = None if scene is None else scene.view_layers.get(hidden.layer)
            if obj is not None and layer is not None and is_in(layer, obj):
                obj.hide_set(False, view_layer=layer)
                obj.select_set(hidden.selected, view_layer=layer)
        self._hidden.clear()

    def _shown_object(self, frame: MorphFrame, index: int) -> bpy.types.Object:
        """Create an object with its position and keyframes."""
        collection = self._living(self._collection)
        obj = self._made(frame, f"Morph {index + 1:04d}")
        collection.objects.link(obj)
        obj.color = np.average([shape.color for shape in self._inputs], axis=0, weights=frame.blend.weights)
        take_render_settings(obj, found(self._input_objects))
        obj[WEIGHTS_KEY] = [float(weight) for weight in frame.blend.weights]
        obj[INDEX_KEY] = index
        if frame.blend.frame is not None:
            obj[FRAME_KEY] = frame.blend.frame
            key_visibility(obj, self._living_action(collection.name), [self._shown(index, range(len(self._blends)))])
        elif len(self._blends) > 1:
            obj.location = self._sheet_location(frame.blend)
        return obj

    def _made(self, frame: MorphFrame, name: str) -> bpy.types.Object:
        """Create the object of a frame with a material."""
        if frame.mesh is None:
            own = self._inputs[frame.blend.source]
            data = self._living(own.shown or own.mesh)
        else:
            data = bpy.data.meshes.new(name)
            self._write(data, frame.mesh)
        assign_default_material(data)
        return bpy.data.objects.new(name, data)

    def _write(self, data: bpy.types.Mesh, mesh: TriangleMesh) -> None:
        """Write the surface of a frame, with the requested kind of faces."""
        quads = self._stored.settings.get("faces") == "QUADS"
        write_mesh(data, mesh, Polygons.of_quads(mesh) if quads else None)

    def finish(self, hide_inputs: bool, dropped: Sequence[Diagnostic] = ()) -> bpy.types.Collection:
        """Store the settings, show the first frame, and return the collection.

        After an early stop, the finished frames are kept as a morph: each is visible until the next existing one, the
        last one to the end.

        Parameters
        ----------
        hide_inputs : bool
            Hide the inputs in viewport and render, since the morph shows them.
        dropped : sequence of Diagnostic
            Diagnostics of materials that frames do not show.

        Raises
        ------
        ConvwassError
            No frame is finished (everything is discarded then), or the collection was removed.
        """
        collection, scene = self._living(self._collection), self._living(self._scene)
        self._drop_previews()
        frames = {index: obj for index, done in self._finished.items() if (obj := done.obj.find()) is not None}
        if not frames:
            self.discard()
            raise ConvwassError("No frame was finished, so there is no morph to keep.")
        if self._blends[0].frame is not None:
            self._show_in_time(collection, frames)
            show_time(scene, self._stored.first_frame)
        bpy.context.view_layer.update()
        records = [
            {"weights": list(self._blends[index].weights), **summary(self._finished[index].record)}
            for index in sorted(frames)
        ]
        store(collection, replace(self._stored, records=records))
        numbers = [
            index + 1 if self._blends[index].frame is None else self._scene_frame(index) for index in sorted(frames)
        ]
        figures = [self._finished[index].record for index in sorted(frames)]
        notes = diagnose(figures, self._stored.settings, [shape.name for shape in self._inputs], numbers, dropped)
        store_diagnostics(collection, notes)
        self._drop_unused()
        shown = found(self._input_objects)
        hide_shapes(collection, shown if hide_inputs else (), scene)
        return collection

    @property
    def span(self) -> tuple[float, float] | None:
        """First and last scene frame of the finished frames; None for a sheet, a single blend or nothing."""
        numbers = [self._scene_frame(index) for index in self._finished if self._blends[index].frame is not None]
        return (min(numbers), max(numbers)) if numbers else None

    def _show_in_time(self, collection: bpy.types.Collection, frames: dict[int, bpy.types.Object]) -> None:
        """Show every object of a path until the next existing one."""
        for index, obj in frames.items():
            key_visibility(obj, self._living_action(collection.name), [self._shown(index, frames)])

    def discard(self) -> None:
        """Remove everything this bake has made."""
        collection = self._collection.find()
        if collection:
            remove_bake(collection)
        self._drop_previews()
        remove_objects(found([done.obj for done in self._finished.values()]))
        self._drop_unused()

    def _living(self, handle: Handle) -> bpy.types.ID:
        """Return the data-block of a handle; raises ConvwassError if it was removed."""
        return handle.living(ConvwassError("The morph was undone or deleted during the bake; bake it again."))

    def _living_action(self, name: str) -> bpy.types.Action:
        """Return the action of all visibility keys; created on the first call."""
        if self._action is None:
            self._action = Handle.of("actions", bpy.data.actions.new(name))
        return self._living(self._action)

    def _scene_frame(self, index: int) -> int:
        return self._stored.first_frame + self._blends[index].frame

    def _shown(self, index: int, indices: Sequence[int] | dict[int, object]) -> FrameRange:
        """Return the frames in which an object is visible, given the existing `indices`."""
        own, others = self._scene_frame(index), [self._scene_frame(other) for other in indices]
        first = None if own == min(others) else own
        following = min((other for other in others if other > own), default=None)
        return FrameRange(first, None if following is None else following - 1)

    def _sheet_location(self, blend: Blend) -> np.ndarray:
        """Return the position of a frame on a sheet, (3,)."""
        step = SHEET_SPACING * max(shape.longest_side for shape in self._inputs)
        column, row = blend.place
        feet = np.array([shape.foot for shape in self._inputs])
        return feet[0] - np.asarray(blend.weights) @ feet + step * np.array([column, 0.0, -row])

    def _drop_previews(self) -> None:
        """Remove the previews of unfinished frames, and show the inputs again."""
        self._show_inputs()
        objects = found(list(self._previews.values()))
        for obj in objects:
            if obj.animation_data and obj.animation_data.action:
                # The action is still used by the finished frames.
                obj.animation_data.action.slots.remove(obj.animation_data.action_slot)
        remove_objects(objects)
        self._previews.clear()

    def _drop_unused(self) -> None:
        """Remove prepared data that no frame uses."""
        handles = [self._action, *(copy for shape in self._inputs for copy in (shape.mesh, shape.shown))]
        spare = [handle.find() for handle in handles if handle is not None]
        if self._brings_material:
            spare.append(bpy.data.materials.get(MATERIAL_NAME))
        remove_if_unused(spare)


def alone_in(collection: bpy.types.Collection, obj: bpy.types.Object, blend: Blend) -> Handle:
    """Add an object to a morph that shows all of its frames, beginning with a blend, and return its handle."""
    collection.objects.link(obj)
    obj[WEIGHTS_KEY] = [float(weight) for weight in blend.weights]
    obj[INDEX_KEY], obj[ALONE_KEY] = 0, True
    return Handle.of("objects", obj)


def check_frames(first_frame: int, blends: Sequence[Blend]) -> None:
    """Raise InputError if Blender does not support the first or the last frame of a morph."""
    if not FIRST_FRAMES[0] <= first_frame <= FIRST_FRAMES[1]:
        raise InputError(
            "The first frame must be between {first} and {last}, not {first_frame}.",
            first=FIRST_FRAMES[0],
            last=FIRST_FRAMES[1],
            first_frame=first_frame,
        )
    span = max((blend.frame for blend in blends if blend.frame is not None), default=0)
    if first_frame + span > FIRST_FRAMES[1]:
        raise InputError(
            "The morph would end at frame {frame}, after Blender's last one; let it start at {start} at the latest.",
            frame=first_frame + span,
            start=FIRST_FRAMES[1] - span,
        )


def assign_default_material(data: bpy.types.ID) -> None:
    """Assign the material shared by all frames to data without material."""
    if not any(data.materials):
        data.materials.clear()
        data.materials.append(morph_material())
