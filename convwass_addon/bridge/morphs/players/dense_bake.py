# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Bake what a player shows to frames at any frame rate: a morph to export or edit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import bpy
import numpy as np
from numpy.typing import NDArray

from ....applications.live.weight_layouts import path_weights
from ....errors import InputError
from ....progress import UNINTERRUPTED, Control, Progress, Work
from ....sentence import Sentence
from ...animation_time import show_time
from ...handles import Handle, found
from ...keyframes import FrameRange, key_visibility
from ...linked_data import is_linked
from ...objects import evaluated_mesh, place_mesh, take_own_materials
from ...scene_context import in_scene
from ..inputs.hidden_inputs import copy_hidden, disable_player
from ..looks.frame_attributes import CARRIED_UV
from ..stand_ins import shown_morph
from ..stored import FRAME_KEY, INDEX_KEY, SAMPLED_FROM, WEIGHTS_KEY, store, stored_morph
from .player_inputs import last_value, morph_value, playback_item, shown_value


def sample_times(first: int, last: int, fps: float, rate: float) -> NDArray[np.float64]:
    """Return the scene frames, including fractions, at which a film of `rate` frames per second is sampled.

    Parameters
    ----------
    first, last : int
        Scene frames of the first sample and, if a sample falls there, of the last one.
    fps, rate : float
        Frames per second of the scene and of the film.
    """
    count = int(np.floor((last - first) * rate / fps + 1e-6)) + 1
    return first + np.arange(count) * fps / rate


def bake_player(player: bpy.types.Object, times: Sequence[float], first_frame: int) -> Work[bpy.types.Collection]:
    """Run a :class:`DenseBake` and return its morph; on an error, nothing is left of it."""
    bake = DenseBake(player, times, first_frame)
    try:
        yield from bake.steps()
        return bake.finish()
    except BaseException:
        bake.discard()
        raise


class DenseBake:
    """Makes a morph with a frame object for every time, shown in consecutive scene frames.

    Nothing is solved. Objects that use the player are not changed, so the player is kept, but hidden. Undo between two
    steps is detected. All methods must be called on the main thread.

    Parameters
    ----------
    player : bpy.types.Object
        A player of a path.
    times : sequence of float
        Scene frames, including fractions, at even distances.
    first_frame : int
        Scene frame of the first object.

    Raises
    ------
    InputError
        Fewer than two times.
    """

    def __init__(self, player: bpy.types.Object, times: Sequence[float], first_frame: int) -> None:
        if len(times) < 2:
            raise InputError("There is only one frame between the first key of {name} and the last.", name=player.name)
        self._player, self._source = Handle.of("objects", player), Handle.of("collections", shown_morph(player))
        self._scene = Handle.of("scenes", bpy.context.scene)
        self._times, self._first_frame = times, first_frame
        self._made: list[Handle] = []

    def steps(self, control: Control = UNINTERRUPTED) -> Work[None]:
        """Make the frames.

        Yields
        ------
        Progress
            After each frame.

        Raises
        ------
        InputError
            The player or the scene was deleted.
        """
        scene = _living(self._scene)
        before = scene.frame_current, scene.frame_subframe
        try:
            for number, time in enumerate(self._times):
                control.check()
                scene = _living(self._scene)
                with in_scene(scene):
                    show_time(scene, time)
                    self._made.append(Handle.of("objects", _frame(_living(self._player), number)))
                done = {"done": number + 1, "total": len(self._times)}
                yield Progress((number + 1) / len(self._times), Sentence("Frame {done} of {total}", done))
        finally:
            scene = self._scene.find()
            if scene is not None:
                scene.frame_set(before[0], subframe=before[1])

    def write(self, report: Progress[None]) -> None:
        """Do nothing; frames are put into the scene at the end."""

    def finish(self) -> bpy.types.Collection:
        """Put the frames into a new morph, which has the settings of the old one and `SAMPLED_FROM`, and return it.

        Raises
        ------
        InputError
            Player or frames were deleted.
        """
        player, source, scene = _living(self._player), _living(self._source), _living(self._scene)
        made, stored = found(self._made), stored_morph(source)
        if len(made) < len(self._made):
            raise _gone()
        collection = bpy.data.collections.new(f"{source.name} Frames")
        action = bpy.data.actions.new(collection.name)
        for number, obj in enumerate(made):
            collection.objects.link(obj)
            first = None if number == 0 else self._first_frame + number
            last = None if number == len(made) - 1 else self._first_frame + number
            key_visibility(obj, action, [FrameRange(first, last)])
        settings = {**stored.settings, SAMPLED_FROM: source.name}
        # The velocities are those of the player, but a frame may last for more or less time.
        per_second = stored.rate_in(scene) / float(self._times[1] - self._times[0])
        described = replace(
            stored,
            settings=settings,
            first_frame=self._first_frame,
            records=[{} for _ in made],
            per_second=per_second,
        )
        store(collection, described)
        copy_hidden(source, collection)
        places = (scene.collection, *bpy.data.collections)
        parents = [place for place in places if source in set(place.children) and not is_linked(place)]
        # A linked morph may be in collections that cannot take others.
        for parent in parents or [scene.collection]:
            parent.children.link(collection)
        disable_player(collection, player)
        return collection

    def discard(self) -> None:
        """Remove the frames made so far."""
        made = found(self._made)
        bpy.data.batch_remove([*made, *(obj.data for obj in made)])
        self._made = []


def _living(handle: Handle) -> bpy.types.ID:
    """Return the data-block of a handle; raises InputError if it was removed."""
    return handle.living(_gone())


def _gone() -> InputError:
    return InputError("The player or its frames were deleted or undone meanwhile; start again.")


def _frame(player: bpy.types.Object, number: int) -> bpy.types.Object:
    """Create an object from what a player shows now."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    evaluated = player.evaluated_get(depsgraph)
    mesh = evaluated_mesh(evaluated, depsgraph)
    take_own_materials(mesh, player)
    mesh.name = f"Frame {number + 1:04d}"
    obj = bpy.data.objects.new(mesh.name, mesh)
    place_mesh(obj, evaluated.matrix_world)
    weights = _weights(player)
    obj[INDEX_KEY], obj[FRAME_KEY], obj[WEIGHTS_KEY] = number, number, weights
    _activate_uv_map(mesh, int(np.argmax(weights)) + 1)
    return obj


def _activate_uv_map(mesh: bpy.types.Mesh, number: int) -> None:
    """Activate a UV map of the shape with a number, as in baked frames; nodes leave none active."""
    carried = CARRIED_UV.format(number, "")
    layers = sorted(mesh.uv_layers, key=lambda layer: not layer.name.startswith(carried))
    if layers:
        mesh.uv_layers.active = layers[0]
        layers[0].active_render = True


def _weights(player: bpy.types.Object) -> list[float]:
    """Return the weights of the shapes in what a player shows now."""
    last = last_value(player)
    value = shown_value(float(morph_value(player).get()), playback_item(player), last)
    return path_weights(value, last + 1).tolist()
