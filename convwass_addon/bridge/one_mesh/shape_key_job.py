# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Morph one mesh into other shapes with shape keys."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import replace

import bpy
import numpy as np
from numpy.typing import NDArray

from ...applications.morphs.computation import USUAL_COMPUTATION, Computation
from ...applications.morphs.morph_settings import MorphSettings
from ...applications.motions.guided_settings import GuidedSettings
from ...applications.one_mesh.key_paths import KeyDemands, KeyPath, key_paths
from ...errors import InputError
from ...geometry.solids.alignment import AlignedMeshes, aligned_meshes
from ...progress import UNINTERRUPTED, Control, Work
from ..morphs.inputs.morph_guides import guides_of_entries, guides_of_shapes
from ..morphs.morph_request import MorphRequest
from ..objects import triangle_mesh
from ..surfaces import same_vertices
from .key_basis import KeyBasis
from .key_job import KeyJob
from .records import key_records
from .rest_mesh import armature_last
from .shape_keys import object_with_keys
from .texture_looks import remember_shape


class ShapeKeyJob(KeyJob):
    """Computes shape keys. All methods except :meth:`steps` must be called on the main thread.

    Parameters
    ----------
    inputs : sequence of bpy.types.Object
        The mesh, and the shapes to morph it into.
    request : MorphRequest
        `alignment`, `scaling`, `guides`, `basis`, `key_error`, `symmetric` and `frames` are used.
    settings : MorphSettings
        `coherence`, from 0.5 to 1, and for a new basis `resolution` are used.
    first_frame : int
        Scene frame at which the morph starts.

    Raises
    ------
    InputError
        An input has no faces, or is not a mesh; or the first one is to be symmetric but is not.
    """

    def __init__(
        self, inputs: Sequence[bpy.types.Object], request: MorphRequest, settings: MorphSettings, first_frame: int
    ) -> None:
        super().__init__(inputs, replace(request, two_meshes=False), settings, first_frame)
        depsgraph = bpy.context.evaluated_depsgraph_get()
        # Poses of one mesh are compared before the modifiers that the mesh with the keys keeps.
        poses = [obj for obj in inputs[1:] if obj.type == "MESH" and same_vertices(obj.data, inputs[0].data)]
        with ExitStack() as hidden:
            for obj in (inputs[0], *poses):
                hidden.enter_context(armature_last(obj))
            self._notice_instances(inputs, depsgraph)
            others = [triangle_mesh(obj, depsgraph) for obj in inputs[1:]]
            basis = KeyBasis.of(inputs[0], depsgraph, request.basis, settings.resolution)
            self._bases.append(basis)
            self._shapes = [basis.shape, *others]
            try:
                self._guides = guides_of_shapes(guides_of_entries(request.guides), inputs, self._shapes, depsgraph)
                laid = aligned_meshes(self._shapes, request.alignment, request.scaling, self._names)
                symmetry = basis.rest.symmetry(inputs[0]) if request.symmetric else None
            except InputError:
                self.discard()
                raise
        self._shapes = laid.meshes
        self._move = None if laid.moves is None else laid.moves[0]
        self._placements = placements(laid)
        self._settings = GuidedSettings(coherence=settings.coherence)
        self._demands = KeyDemands(request.key_error / 100.0, symmetry, settings.on_floor)
        self.notices.extend(basis.rest.notices)
        self.paths: list[KeyPath] = []

    def steps(self, control: Control = UNINTERRUPTED, computation: Computation = USUAL_COMPUTATION) -> Work[None]:
        """Compute the paths of the vertices without accessing Blender's data; not parallelized over workers."""
        self.paths = yield from key_paths(
            self._shapes, self._names, self._demands, self._settings, self._guides, control
        )

    def _remember(self, obj: bpy.types.Object, sliders: Sequence[str]) -> None:
        """Store the shapes that still exist on an object with sliders to them."""
        shapes = [handle.find() for handle in self._inputs[1:]]
        for slider, shape, placement in zip(sliders, shapes, self._placements, strict=True):
            if shape is not None:
                remember_shape(obj, slider, shape, placement)

    @property
    def span(self) -> tuple[float, float]:
        """First and last scene frame of the animation."""
        return (self._first, self._first + self._frames * len(self.paths))

    def finish(self, hide_inputs: bool) -> list[bpy.types.Object]:
        """Create the object, and hide the inputs if requested.

        Raises
        ------
        ConvwassError
            The first shape or the scene was deleted, or the copied mesh was removed by undo.
        """
        scene, (source,), (mesh,) = self._found()
        (basis,) = self._bases
        paths = [replace(path, positions=basis.key_coordinates(path.positions, self._move)) for path in self.paths]
        obj = object_with_keys(source, mesh, paths, scene, basis.rest.modifiers)
        sliders = [record["name"] for record in key_records(obj)[-len(self.paths) :]]
        self._remember(obj, sliders)
        self._complete(obj, sliders, scene, hide=hide_inputs)
        return [obj]


def placements(laid: AlignedMeshes) -> list[NDArray[np.float64]]:
    """Return for every shape but the first the transform to where the first one reaches it in the scene, (4, 4)."""
    if laid.moves is None:
        return [np.eye(4) for _ in laid.meshes[1:]]
    own, *others = (np.array(move.matrix, dtype=np.float64) for move in laid.moves)
    return [np.linalg.solve(own, other) for other in others]


def refuse_one_mesh(objects: Sequence[bpy.types.Object]) -> None:
    """Raise InputError for objects that cannot share a mesh."""
    for obj in objects:
        if obj.type != "MESH":
            raise InputError("{name} is not a mesh; shape keys require meshes. Convert it first.", name=obj.name)
