# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Morph two shapes of different topology with the meshes of both, one of which replaces the other on the way."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import bpy
import numpy as np
from mathutils import Matrix

from ...applications.morphs.computation import USUAL_COMPUTATION, Computation
from ...applications.morphs.morph_inputs import MorphInputs
from ...applications.morphs.morph_settings import MorphSettings
from ...applications.one_mesh.key_paths import KeyPath
from ...applications.one_mesh.swapped_meshes import SwappedMeshes, swapped_meshes
from ...errors import InputError
from ...geometry.solids.alignment import aligned_meshes
from ...progress import UNINTERRUPTED, Control, Work
from ..morphs.inputs.morph_guides import guides_of_entries, guides_of_shapes
from ..morphs.morph_request import MorphRequest
from .key_basis import KeyBasis
from .key_job import KeyJob
from .records import key_records
from .rest_mesh import armature_last
from .shape_key_job import placements
from .shape_keys import object_with_keys
from .swapped_objects import with_swap


class SwapJob(KeyJob):
    """Computes shape keys of two meshes. All methods except :meth:`steps` must be called on the main thread.

    Parameters
    ----------
    inputs : sequence of bpy.types.Object
        The two shapes.
    request : MorphRequest
        `alignment`, `scaling`, `guides`, `basis`, `key_error` and `frames` are used.
    settings : MorphSettings
        How the morph is made that the meshes follow.
    first_frame : int
        Scene frame at which the morph starts.

    Raises
    ------
    InputError
        Not two meshes with faces; symmetric keys are asked for; or the second one has an armature and is moved.
    """

    def __init__(
        self, inputs: Sequence[bpy.types.Object], request: MorphRequest, settings: MorphSettings, first_frame: int
    ) -> None:
        if len(inputs) != 2:
            raise InputError("Two Meshes needs two shapes; there are {count}.", count=len(inputs))
        if request.symmetric:
            raise InputError("Symmetric needs one mesh for both shapes; switch it or Two Meshes off.")
        super().__init__(inputs, replace(request, two_meshes=True), settings, first_frame)
        depsgraph = bpy.context.evaluated_depsgraph_get()
        with armature_last(inputs[0]), armature_last(inputs[1]):
            self._notice_instances(inputs, depsgraph)
            try:
                for obj in inputs:
                    self._bases.append(KeyBasis.of(obj, depsgraph, request.basis, settings.resolution))
                shapes = [basis.shape for basis in self._bases]
                guides = guides_of_shapes(guides_of_entries(request.guides), inputs, shapes, depsgraph)
                laid = aligned_meshes(shapes, request.alignment, request.scaling, self._names)
                if laid.moves is not None and self._bases[1].rest.modifiers:
                    raise InputError(
                        "{name} has an armature and cannot be moved; set Alignment and Scale to As Placed.",
                        name=self._names[1],
                    )
            except InputError:
                self.discard()
                raise
        self._shapes = MorphInputs.of(laid.meshes, self._names, guides=guides)
        self._moves = laid.moves or (None, None)
        (self._placement,) = placements(laid)
        # Meshes follow the matter of the blends, which is stored with the attributes that they carry.
        self._settings = replace(settings, carry=True)
        self._error = request.key_error / 100.0
        for basis in self._bases:
            self.notices.extend(basis.rest.notices)
        self.found: SwappedMeshes | None = None

    def steps(self, control: Control = UNINTERRUPTED, computation: Computation = USUAL_COMPUTATION) -> Work[None]:
        """Compute the morph and the paths of the vertices without accessing Blender's data."""
        self.found = yield from swapped_meshes(self._shapes, self._error, self._settings, control, computation)

    @property
    def paths(self) -> list[KeyPath]:
        """The paths of the meshes that move."""
        return self.found.paths

    @property
    def span(self) -> tuple[float, float]:
        """First and last scene frame of the animation."""
        return (self._first, self._first + self._frames)

    def finish(self, hide_inputs: bool) -> list[bpy.types.Object]:
        """Create both objects, and hide the inputs if requested.

        Raises
        ------
        ConvwassError
            A shape or the scene was deleted, or the copied meshes were removed by undo.
        """
        scene, sources, meshes = self._found()
        made, sliders = [], []
        for number, path in enumerate((self.found.first, self.found.second)):
            basis, move = self._bases[number], self._moves[number]
            own = [] if path is None else [replace(path, positions=basis.key_coordinates(path.positions, move))]
            made.append(object_with_keys(sources[number], meshes[number], own, scene, basis.rest.modifiers))
            sliders.append(None if path is None else key_records(made[number])[-1]["name"])
        if not np.allclose(self._placement, np.eye(4)):
            made[1].matrix_world = Matrix(self._placement)
        slider = with_swap(made[0], made[1], tuple(sliders), self._names[1], self.found.time)
        self._complete(made[0], [slider], scene, hide=hide_inputs)
        return made
