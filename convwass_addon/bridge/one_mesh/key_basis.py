# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A mesh that is to get shape keys: a copy of that of a shape, or a new one."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray

from ...geometry.algebra.affine import transformed_points
from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.solids.alignment import RigidMove
from ..handles import Handle
from ..objects import triangle_mesh
from ..unused_data import remove_if_unused
from .remeshed_rest import remeshed_shape
from .rest_mesh import RestMesh, rest_mesh


@dataclass(frozen=True)
class KeyBasis:
    """A mesh without users, and the shape that it has in the scene.

    Attributes
    ----------
    rest : RestMesh
        The mesh before its armature.
    shape : TriangleMesh
        World space, with the same vertices.
    mesh : Handle
        Finds the mesh again.
    """

    rest: RestMesh
    shape: TriangleMesh
    mesh: Handle

    @classmethod
    def of(cls, obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph, kind: str, resolution: int) -> KeyBasis:
        """Copy or remesh a mesh object; modifiers after its armatures must be hidden (`armature_last`).

        Parameters
        ----------
        obj : bpy.types.Object
            The shape.
        depsgraph : bpy.types.Depsgraph
            Used to evaluate the modifiers.
        kind : "FIRST", "EVEN", "ADAPTIVE" or "QUADS"
            The mesh itself, or the faces of the new one.
        resolution : int
            Cells of a new mesh along its longest side.

        Raises
        ------
        InputError
            As :func:`.rest_mesh.rest_mesh` and :func:`.remeshed_rest.remeshed_shape`.
        """
        if kind == "FIRST":
            shape, rest = triangle_mesh(obj, depsgraph), rest_mesh(obj, depsgraph)
        else:
            remeshed = remeshed_shape(obj, depsgraph, kind, resolution)
            shape, rest = remeshed.shape, remeshed.rest
        return cls(rest, shape, Handle.of("meshes", rest.mesh))

    def discard(self) -> None:
        """Remove the mesh unless an object uses it."""
        remove_if_unused([self.mesh.find()])

    def key_coordinates(self, positions: NDArray[np.float64], move: RigidMove | None) -> NDArray[np.float64]:
        """Return coordinates of keys, (k, n, 3), that lead to positions among aligned shapes, (k, n, 3).

        Parameters
        ----------
        positions : (k, n, 3) float64
            Of the vertices.
        move : RigidMove or None
            Aligned the shape; the mesh stays where the shape stands in the scene.
        """
        if move is not None:
            positions = transformed_points(positions, np.linalg.inv(np.array(move.matrix, dtype=np.float64)))
        return self.rest.key_coordinates(positions)
