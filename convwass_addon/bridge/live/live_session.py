# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A live morph: reads the handle, shows the blend there, and improves it in a background thread."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import bpy
import numpy as np

from ...applications.background import BackgroundJob
from ...applications.live.live_blends import FADE, LiveBlends
from ...applications.live.live_settings import LiveSettings
from ...applications.live.live_shapes import LiveShape, LiveShapes
from ...applications.live.pad_places import pad_weights
from ...applications.morphs.appearance import Appearance
from ...applications.morphs.morph_settings import MorphSettings
from ...applications.system_errors import error_to_tell
from ...errors import Cancelled, InputError
from ...geometry.meshes.mesh import TriangleMesh
from ...sentence import Sentence
from ..morphs.found_motions import FOUND_MOTIONS
from ..morphs.inputs.shape_reading import ReadShapes, read_shapes
from ..morphs.looks.frame_attributes import COLOR
from ..morphs.looks.materials import attribute_material
from ..objects import write_mesh
from ..shape_sources import OBJECTS, ShapeSource, shape_sources
from .input_watch import InputWatch
from .leftovers import watch_undo
from .live_colors import KEPT_MATERIAL, are_alike, read_colors, write_colors
from .live_scene import LiveScene
from .running import running_live, set_running

# Seconds without movement before the blend is solved completely, and without edits before inputs are read; seconds
# between checks of the inputs.
_REST, _QUIET, _LOOK = 0.4, 0.3, 0.25


@dataclass(frozen=True)
class LiveRequest:
    """Settings of a live morph.

    Attributes
    ----------
    settings : MorphSettings
        Settings of the morph.
    live : LiveSettings
        Resolution and memory.
    options : mapping
        As for :func:`.shape_reading.read_shapes`.
    """

    settings: MorphSettings
    live: LiveSettings
    options: Mapping[str, object]


class LiveSession:
    """A live morph in a scene. All methods must be called on the main thread; a background thread computes.

    Parameters
    ----------
    context : bpy.types.Context
        Provides the scene and view layer.
    inputs : sequence of bpy.types.Object
        Two to four shapes.
    request : LiveRequest
        How.

    Attributes
    ----------
    message : Sentence
        About the current computation.
    fraction : float
        Finished share of it.
    is_frozen : bool
        Whether it has stopped, because an input was deleted or an error occurred.

    Raises
    ------
    InputError, ResourceError
        Another live morph is running, or inputs or settings are invalid; nothing is left in the scene.
    """

    def __init__(self, context: bpy.types.Context, inputs: Sequence[bpy.types.Object], request: LiveRequest) -> None:
        if running_live() is not None:
            raise InputError("Another live morph is running; end it first.")
        self._request = request
        self._read = read_shapes(inputs, context.evaluated_depsgraph_get(), request.settings, request.options)
        sources = self._sources_of(inputs)
        self._looks = self._looks_of(sources, self._read)
        self._blends = self._blends_of(self._read, self._looks)
        self.scene = LiveScene(context.scene, context.view_layer, sources, self._read.inputs.shapes)
        self.watch = InputWatch(sources)
        self.watch.register()
        self._job = BackgroundJob(self._blends.work)
        self.message = Sentence("Reading the shapes")
        self.fraction = 0.0
        self.is_frozen = self._ended = False
        self._place: tuple[float, float] | None = None
        now = time.monotonic()
        self._moved_at, self._looked_at, self._changed_at = now, now, None
        self._shown_version, self._changing_until = -1, now
        self._shown: LiveShape | None = None
        for handlers, own in self._handlers:
            handlers.append(own)
        watch_undo()
        set_running(self)

    def _sources_of(self, inputs: Sequence[bpy.types.Object]) -> list[ShapeSource]:
        return shape_sources(inputs, self._request.options.get("grouping", OBJECTS))

    def _looks_of(self, sources: Sequence[ShapeSource], read: ReadShapes) -> tuple[Appearance, ...]:
        return read_colors(sources, read.moves) if self._request.settings.carry else ()

    def _blends_of(self, read: ReadShapes, looks: tuple[Appearance, ...]) -> LiveBlends:
        request = self._request
        return LiveBlends(LiveShapes(read.inputs, looks), request.settings, request.live, motions=FOUND_MOTIONS)

    @property
    def count(self) -> int:
        """Number of shapes."""
        return len(self._read.inputs.names)

    @property
    def names(self) -> list[str]:
        """Names of the inputs when they were read."""
        return list(self._read.inputs.names)

    @property
    def objects(self) -> list[str]:
        """Names of the existing root objects of the inputs."""
        return [obj.name for obj in self.watch.roots]

    @property
    def weights(self) -> tuple[float, ...]:
        """Weights at the handle."""
        return self._blends.hand

    @property
    def notices(self) -> list[Sentence]:
        """Messages for the user."""
        return list(self._blends.notices)

    @property
    def has_failed(self) -> bool:
        """Return whether an error occurred before anything could be shown; the message gives the reason."""
        return self.is_frozen and self._shown is None

    @property
    def is_solved(self) -> bool:
        """Return whether the shown blend was solved completely."""
        return self._shown is not None and self._shown.is_solved

    @property
    def place(self) -> tuple[float, float]:
        """Position of the handle, across and up."""
        return self.scene.pad.place or (0.0, 0.0)

    def move_to(self, across: float, up: float) -> None:
        """Move the handle."""
        self.scene.pad.move_to(across, up)

    def tick(self) -> bool:
        """Read the handle, show the blend, and check the inputs and the thread.

        Returns
        -------
        bool
            Whether the live morph continues; False if undo or the user has removed its scene or its objects.
        """
        if not self.scene.is_there:
            return False
        now = time.monotonic()
        self._point(now)
        self._look_after_inputs(now)
        self._look_after_job()
        self._blends.settle()
        if not bpy.app.is_job_running("RENDER"):
            self._show(now)
        return True

    def _point(self, now: float) -> None:
        place = self.scene.pad.place
        if place != self._place:
            self._place, self._moved_at, self._changing_until = place, now, now + FADE
            self._blends.point(pad_weights(self.count, *place))
        if now - self._moved_at >= _REST:
            self._blends.rest()

    def _show(self, now: float) -> None:
        """Show the blend unless it is already shown."""
        if self._blends.version != self._shown_version:
            self._shown_version, self._changing_until = self._blends.version, now + 1.5 * FADE
        if now > self._changing_until:
            return
        found = self._blends.shown()
        if found is not None and found is not self._shown:
            self.scene.show(found)
            self._shown = found

    def _look_after_job(self) -> None:
        """Process the reports of the thread, and restart it if there is more to compute."""
        for report in self._job.poll():
            self.message, self.fraction = report.message, max(report.fraction, self.fraction)
        if not self._job.done or self.is_frozen:
            return
        error = self._job.error
        if error is not None and not isinstance(error, Cancelled):
            known = error_to_tell(error)
            if known is None:
                raise error
            self._freeze(known.sentence)
        elif self._blends.has_work:
            self._job = BackgroundJob(self._blends.work)
        else:
            self.message = Sentence("Ready")

    def _freeze(self, message: Sentence) -> None:
        self._job.cancel(0.0)
        self.is_frozen, self.message = True, message

    def _look_after_inputs(self, now: float) -> None:
        """Recompute the lattice if an input was edited; keep the existing blends if one was deleted."""
        if self.is_frozen or now - self._looked_at < _LOOK:
            return
        self._looked_at = now
        lost = self.watch.lost
        if lost:
            names = ", ".join(lost)
            self._freeze(Sentence("{names} was deleted; the live morph keeps the existing blends", {"names": names}))
        elif self.watch.may_have_changed:
            self.watch.note()
            self._changed_at = now
        elif self._changed_at is not None and now - self._changed_at >= _QUIET:
            self._changed_at = None
            self._refill()

    def _refill(self) -> None:
        """Read the inputs again, and restart if they have changed."""
        request = self._request
        try:
            depsgraph = bpy.context.evaluated_depsgraph_get()
            read = read_shapes(self.watch.roots, depsgraph, request.settings, request.options)
            looks = self._looks_of(self._sources_of(self.watch.roots), read)
            self.watch.note()
            if _are_same(read.inputs.shapes, self._read.inputs.shapes) and are_alike(looks, self._looks):
                return
            blends = self._blends_of(read, looks)
        except InputError as error:
            self._freeze(error.sentence)
            return
        self._job.cancel(0.0)
        self._read, self._looks, self._blends = read, looks, blends
        self._blends.point(pad_weights(self.count, *self.place))
        self._job = BackgroundJob(self._blends.work)
        self.fraction, self._shown_version, self._shown = 0.0, -1, None
        self.message = Sentence("The shapes have changed; blending again")

    def kept_shape(self, patience: float) -> bpy.types.Object | None:
        """Create an object from the visible blend, solved completely if that takes at most this many seconds.

        Returns
        -------
        bpy.types.Object or None
            In the scene's collection; None if nothing is shown yet.
        """
        until = time.monotonic() + patience
        self._blends.rest()
        shown = self._blends.shown()
        while not self.is_frozen and time.monotonic() < until and not (shown is not None and shown.is_solved):
            self._look_after_job()
            time.sleep(0.01)
            shown = self._blends.shown()
        if shown is None or not self.scene.is_there:
            return None
        live = self.scene.shape
        mesh = bpy.data.meshes.new("Blend")
        write_mesh(mesh, shown.mesh)
        if shown.colors is None:
            for material in live.data.materials:
                mesh.materials.append(material)
        else:
            write_colors(mesh, shown.colors)
            mesh.materials.append(attribute_material(KEPT_MATERIAL, COLOR))
        obj = bpy.data.objects.new("Blend", mesh)
        obj.location, obj.color = shown.center, live.color
        live.users_scene[0].collection.objects.link(obj)
        return obj

    def end(self) -> None:
        """Stop the thread and remove everything temporary."""
        if self._ended:
            return
        self._ended = True
        if running_live() is self:
            set_running(None)
        self._job.cancel(0.0)
        self.watch.unregister()
        for handlers, own in self._handlers:
            if own in handlers:
                handlers.remove(own)
        self.scene.remove()

    @property
    def _handlers(self) -> list[tuple[list[Callable[..., None]], Callable[..., None]]]:
        """Blender's lists of functions to call about saving, and what they are to call."""
        lists = bpy.app.handlers
        return [
            (lists.save_pre, self._before_saving),
            (lists.save_post, self._after_saving),
            (lists.save_post_fail, self._after_saving),
        ]

    def _before_saving(self, *_: object) -> None:
        """Show the inputs in the saved file, without the live morph."""
        self.scene.show_inputs()

    def _after_saving(self, *_: object) -> None:
        self.scene.hide_inputs()


def _are_same(meshes: Sequence[TriangleMesh], others: Sequence[TriangleMesh]) -> bool:
    return all(
        np.array_equal(own.vertices, other.vertices) and np.array_equal(own.faces, other.faces)
        for own, other in zip(meshes, others, strict=True)
    )
