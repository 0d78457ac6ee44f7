# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""One mesh with shape keys, from objects of the scene to an object of the scene."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
from mathutils import Matrix

from ...applications.morphs.computation import Computation
from ...applications.motions.guided_settings import GuidedSettings
from ...applications.one_mesh.key_paths import KeyPath, key_paths
from ...errors import ConvwassError, InputError
from ...geometry.alignment import aligned_meshes
from ...progress import UNINTERRUPTED, Control, Progress, Work
from ...sentence import Sentence
from ..handles import Handle
from ..morphs.animated_inputs import animation_notices
from ..morphs.morph_guides import guides_of_entries, guides_of_shapes
from ..morphs.morph_request import MorphRequest
from ..objects import frozen_copy, hide, triangle_mesh
from .shape_keys import animate_sliders, object_with_keys


class ShapeKeyJob:
    """One mesh on its way to other shapes. Everything but :meth:`steps` belongs on the main thread.

    Parameters
    ----------
    scene : bpy.types.Scene
        Where the object goes.
    depsgraph : bpy.types.Depsgraph
        For the inputs as modifiers leave them.
    inputs : sequence of bpy.types.Object
        The mesh, and the shapes that it is to take.
    request : MorphRequest
        What was asked for: `alignment`, `scaling`, `guides`, `key_error` and `frames` are heeded.
    coherence : float
        From 0.5 to 1.
    first_frame : int
        Scene frame in which the mesh begins to change.

    Raises
    ------
    InputError
        Inputs that have no faces, or are no meshes.
    """

    def __init__(
        self,
        scene: bpy.types.Scene,
        depsgraph: bpy.types.Depsgraph,
        inputs: Sequence[bpy.types.Object],
        request: MorphRequest,
        coherence: float,
        first_frame: int,
    ) -> None:
        self._names = [obj.name for obj in inputs]
        self._shapes = [triangle_mesh(obj, depsgraph) for obj in inputs]
        self._guides = guides_of_shapes(guides_of_entries(request.guides), inputs, self._shapes, depsgraph)
        laid = aligned_meshes(self._shapes, request.alignment, request.scaling, self._names)
        self._shapes = laid.meshes
        self._settings = GuidedSettings(coherence=coherence)
        self._accuracy, self._frames, self._first = request.key_error / 100.0, request.frames, first_frame
        self._scene = Handle.of("scenes", scene)
        self._inputs = [Handle.of("objects", obj) for obj in inputs]
        self.notices = [*animation_notices(inputs, scene.frame_current), *_applied(inputs[0])]
        mesh = frozen_copy(inputs[0], depsgraph)
        if laid.moves is not None:
            mesh.transform(Matrix(laid.moves[0].matrix))
        self._mesh = Handle.of("meshes", mesh)
        self.paths: list[KeyPath] = []

    def steps(self, control: Control = UNINTERRUPTED, how: Computation | None = None) -> Work[None]:
        """Find the way; it touches nothing of Blender, and is not divided among workers."""
        self.paths = yield from key_paths(
            self._shapes, self._names, self._accuracy, self._settings, self._guides, control
        )

    def write(self, report: Progress[object]) -> None:
        """Leave the file as it is until the end."""

    def discard(self) -> None:
        """Remove what was prepared."""
        mesh = self._mesh.find()
        if mesh is not None and not mesh.users:
            bpy.data.meshes.remove(mesh)

    @property
    def span(self) -> tuple[float, float]:
        """First and last scene frame of the animation."""
        return (self._first, self._first + self._frames * len(self.paths))

    def finish(self, hide_inputs: bool) -> bpy.types.Object:
        """Make the object, and hide the inputs if that is asked for.

        Raises
        ------
        ConvwassError
            The first shape or the scene is gone, or the mesh that was copied has been removed by undo.
        """
        source, mesh, scene = self._inputs[0].find(), self._mesh.find(), self._scene.find()
        if source is None or mesh is None or scene is None:
            raise ConvwassError("The first shape was deleted, or undone, while its keys were made; start again.")
        obj = object_with_keys(source, mesh, self.paths, scene)
        animate_sliders(obj, [path.name for path in self.paths], self._first, self._frames)
        if hide_inputs:
            hide((shape for handle in self._inputs if (shape := handle.find()) is not None), scene)
        return obj


def _applied(obj: bpy.types.Object) -> list[Sentence]:
    """Say what of an object is applied to the copy that gets the keys."""
    keys = obj.type == "MESH" and obj.data.shape_keys is not None
    if not (obj.modifiers or keys):
        return []
    return [Sentence("The modifiers and shape keys of {name} are applied to the copy.", {"name": obj.name})]


def refuse_one_mesh(objects: Sequence[bpy.types.Object]) -> None:
    """Refuse shapes that cannot share one mesh by their kind; raises InputError."""
    for obj in objects:
        if obj.type != "MESH":
            raise InputError("{name} is no mesh; shape keys need meshes. Convert it first.", name=obj.name)
