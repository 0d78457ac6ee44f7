# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What the jobs have in common that make shape keys of one mesh or of two."""

from __future__ import annotations

from collections.abc import Sequence

import bpy

from ...applications.morphs.morph_settings import MorphSettings
from ...errors import ConvwassError
from ...progress import Progress
from ...sentence import Sentence
from ..handles import Handle, found
from ..joined_shapes import has_instances
from ..morphs.changes import signature, store_signatures
from ..morphs.inputs.animated_inputs import animation_notices
from ..morphs.inputs.hidden_inputs import hide_shapes
from ..morphs.morph_request import MorphRequest
from ..morphs.stored import store
from ..object_copies import has_copies
from ..shape_sources import ShapeSource, shape_sources
from .key_basis import KeyBasis
from .own_space import own_space_notices
from .records import described_bake
from .rest_mesh import pose_notices
from .shape_keys import animate_sliders


class KeyJob:
    """Base of jobs that make shape keys in the current scene; they add the meshes that get keys to `_bases`.

    Parameters
    ----------
    inputs : sequence of bpy.types.Object
        The shapes, of which the first ones get keys.
    request : MorphRequest
        Stored for another bake; `frames` and `two_meshes` are used.
    settings : MorphSettings
        Stored, too.
    first_frame : int
        Scene frame at which the morph starts.
    """

    def __init__(
        self, inputs: Sequence[bpy.types.Object], request: MorphRequest, settings: MorphSettings, first_frame: int
    ) -> None:
        self._names = [obj.name for obj in inputs]
        self._stored = described_bake(inputs, request, settings, first_frame)
        self._signatures = list(map(signature, shape_sources(inputs)))
        self._frames, self._first = request.frames, first_frame
        self._scene = Handle.of("scenes", bpy.context.scene)
        self._inputs = [Handle.of("objects", obj) for obj in inputs]
        self._bases: list[KeyBasis] = []
        keyed = inputs[: 2 if request.two_meshes else 1]
        self.notices = [notice for obj in keyed for notice in (*pose_notices(obj), *own_space_notices(obj))]
        self.notices.extend(animation_notices(inputs))
        self.notices.extend(_notices_of_groups(shape_sources(inputs, request.grouping)))

    def _notice_instances(self, inputs: Sequence[bpy.types.Object], depsgraph: bpy.types.Depsgraph) -> None:
        """Add a notice for each shape that shows instances, which have no vertices of its mesh."""
        for obj in inputs:
            if has_instances(obj, depsgraph) or has_copies(obj):
                values = {"name": obj.name}
                self.notices.append(
                    Sentence("Instances that {name} shows are left out; realize them if they belong to it.", values)
                )

    def write(self, report: Progress[object]) -> None:
        """Do nothing: the file is only changed at the end."""

    def discard(self) -> None:
        """Remove the prepared copies."""
        for basis in self._bases:
            basis.discard()

    def _found(self) -> tuple[bpy.types.Scene, list[bpy.types.Object], list[bpy.types.Mesh]]:
        """Return the scene, the shapes that get keys and their copies; raises ConvwassError if one was removed."""
        scene, meshes = self._scene.find(), [basis.mesh.find() for basis in self._bases]
        sources = [handle.find() for handle in self._inputs[: len(meshes)]]
        if scene is None or None in sources or None in meshes:
            raise ConvwassError("A shape was deleted, or its creation undone, during the computation; start again.")
        return scene, sources, meshes

    def _complete(self, obj: bpy.types.Object, sliders: Sequence[str], scene: bpy.types.Scene, *, hide: bool) -> None:
        """Animate the sliders of the first object, store with it how it was made, and hide the shapes if requested."""
        animate_sliders(obj, sliders, self._first, self._frames)
        store(obj, self._stored)
        store_signatures(obj, self._signatures)
        hide_shapes(obj, found(self._inputs) if hide else (), scene)


def _notices_of_groups(sources: Sequence[ShapeSource]) -> list[Sentence]:
    """Return a notice for each shape of several objects, of which only one is used."""
    return [
        Sentence(
            "Of {name}, shape keys only use {object}; join its objects to one mesh to use all of them.",
            {"name": source.name, "object": source.root.name},
        )
        for source in sources
        if len(source.parts) > 1
    ]
