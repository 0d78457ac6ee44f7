# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Copies of the inputs of a bake."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import bpy
import numpy as np
from mathutils import Matrix

from ....geometry.solids.alignment import RigidMove
from ...element_values import element_values
from ...handles import Handle
from ...joined_shapes import current_shapes, joined_shape
from ...object_values import ObjectValues
from ...objects import MESHED, frozen_copy
from ...rendered_maps import put_rendered_first
from ...shape_sources import ShapeSource
from ...unused_data import removed_on_errors
from ..looks.materials import input_color


@dataclass(frozen=True)
class FrozenInput:
    """A copy of an input, which may change or be deleted while frames are computed."""

    obj: Handle
    name: str
    color: tuple[float, float, float, float]
    mesh: Handle
    """The copy: a mesh, or other data for the frames."""
    longest_side: float
    """Longest side of the bounds, in world space."""
    foot: np.ndarray
    """Center of the underside of the bounds, or of a flat shape, world space, (3,)."""
    parts: tuple[Handle, ...] = ()
    """The objects of the input if it has several; empty otherwise."""
    values: ObjectValues = field(default_factory=ObjectValues)
    """What materials read of the object; its color is used if it has no material."""
    groups: tuple[str, ...] = ()
    """Names of the vertex groups in order."""
    shown: Handle | None = None
    """The copy to show as a frame, if it is another one."""
    own_space: np.ndarray = field(default_factory=lambda: np.eye(4))
    """Matrix from the copy to the object's own space, (4, 4)."""

    @property
    def objects(self) -> tuple[Handle, ...]:
        """The objects that show the input in the scene."""
        return self.parts or (self.obj,)


def frozen_inputs(sources: Sequence[ShapeSource], moves: Sequence[RigidMove | None]) -> list[FrozenInput]:
    """Copy all inputs, or none if one of them cannot be copied, and align the copies."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    shapes, meshes = [], []
    with removed_on_errors(meshes), current_shapes(sources, depsgraph):
        for source, move in zip(sources, moves, strict=True):
            with joined_shape(source, depsgraph) as obj:
                meshes.append(frozen_copy(obj, depsgraph, MESHED))
                put_rendered_first(meshes[-1])
                place = np.array(obj.matrix_world)
                if move is not None:
                    meshes[-1].transform(Matrix(move.matrix))
                    place = np.array(move.matrix) @ place
                shapes.append(replace(_described(source, obj, meshes[-1]), own_space=np.linalg.pinv(place)))
    return shapes


def _described(source: ShapeSource, obj: bpy.types.Object, mesh: bpy.types.Mesh) -> FrozenInput:
    """Describe an input and its world-space copy."""
    points = element_values(mesh.vertices, "co", 3)
    low, high = points.min(axis=0), points.max(axis=0)
    middle = (low + high) / 2.0
    return FrozenInput(
        obj=Handle.of("objects", source.root),
        name=source.name,
        color=input_color(obj),
        mesh=Handle.of("meshes", mesh),
        longest_side=float((high - low).max()),
        foot=np.array([middle[0], middle[1], low[2]], dtype=np.float64),
        parts=tuple(Handle.of("objects", part) for part in source.parts),
        values=ObjectValues.of(source.parts[0], mesh.materials),
        groups=tuple(group.name for group in obj.vertex_groups),
    )
