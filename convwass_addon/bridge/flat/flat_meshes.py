# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Convert boundaries of flat meshes to polygons."""

from __future__ import annotations

import bpy
import numpy as np
from numpy.typing import NDArray

from ...geometry.algebra.affine import transformed_points
from ...geometry.plane.ring_nesting import closed_chains
from ..element_values import element_values, vectors_of
from .flat_rings import FlatRings
from .planes import plane_of


def is_flat_mesh(evaluated: bpy.types.Object) -> bool:
    """Return whether the mesh of an evaluated object has faces and lies in one plane."""
    matrix = np.array(evaluated.matrix_world, dtype=np.float64)
    try:
        mesh = evaluated.to_mesh()
        if mesh is None or not len(mesh.polygons):
            return False
        points = _points(mesh, matrix)
    finally:
        evaluated.to_mesh_clear()
    return bool(np.isfinite(points).all()) and plane_of(points, matrix) is not None


def mesh_rings(evaluated: bpy.types.Object) -> FlatRings:
    """Read the boundaries of the faces of a flat mesh by material, regardless of the orientation of faces.

    The mesh of a curve or text is what its modifiers make of it.
    """
    matrix = np.array(evaluated.matrix_world, dtype=np.float64)
    try:
        mesh = evaluated.to_mesh()
        points, faces, slots = _points(mesh, matrix), _faces(mesh), _slots(mesh)
    finally:
        evaluated.to_mesh_clear()
    corners = plane_of(points, matrix).coordinates(points)
    rings: list[NDArray[np.int64]] = []
    owners: list[int] = []
    for slot in np.unique(slots):
        found = _border([faces[face] for face in np.flatnonzero(slots == slot)], corners)
        rings += found
        owners += [int(slot)] * len(found)
    return FlatRings([points[ring] for ring in rings], matrix, "non-zero", None, tuple(owners))


def wire_rings(evaluated: bpy.types.Object) -> FlatRings | None:
    """Read the edges of a flat mesh without faces, as of a curve that is not filled.

    Return None if they are open, or do not lie in a plane.
    """
    matrix = np.array(evaluated.matrix_world, dtype=np.float64)
    try:
        mesh = evaluated.to_mesh()
        if mesh is None or len(mesh.polygons) or not len(mesh.edges):
            return None
        points, edges = _points(mesh, matrix), element_values(mesh.edges, "vertices", 2, np.int32).astype(np.int64)
    finally:
        evaluated.to_mesh_clear()
    # Edges of a spline have the same direction.
    leaving, arriving = (np.bincount(ends, minlength=len(points)) for ends in edges.T)
    if (leaving != arriving).any() or not np.isfinite(points).all() or plane_of(points, matrix) is None:
        return None
    return FlatRings([points[ring] for ring in closed_chains(*edges.T)], matrix, "even-odd")


def _points(mesh: bpy.types.Mesh, matrix: NDArray[np.float64]) -> NDArray[np.float64]:
    return transformed_points(vectors_of(mesh.vertices), matrix)


def _faces(mesh: bpy.types.Mesh) -> list[NDArray[np.int32]]:
    """Return the vertices of every face."""
    loops = element_values(mesh.loops, "vertex_index", kind=np.int32)
    return np.split(loops, element_values(mesh.polygons, "loop_start", kind=np.int32)[1:])


def _slots(mesh: bpy.types.Mesh) -> NDArray[np.int32]:
    return element_values(mesh.polygons, "material_index", kind=np.int32)


def _border(faces: list[NDArray[np.int32]], corners: NDArray[np.float64]) -> list[NDArray[np.int64]]:
    """Chain the polygon edges that no equally oriented polygon uses in the opposite direction."""
    begins, ends = [], []
    for face in faces:
        x, y = corners[face].T
        turned = face if x @ np.roll(y, -1) >= y @ np.roll(x, -1) else face[::-1]
        begins.append(turned)
        ends.append(np.roll(turned, -1))
    start, end = np.concatenate(begins).astype(np.int64), np.concatenate(ends).astype(np.int64)
    # An edge used more often in one direction is kept with the surplus.
    count = len(corners)
    keys, place = np.unique(np.minimum(start, end) * count + np.maximum(start, end), return_inverse=True)
    surplus = np.bincount(place.ravel(), np.where(start < end, 1, -1), minlength=len(keys)).astype(np.int64)
    low, high = keys // count, keys % count
    times = np.abs(surplus)
    first = np.repeat(np.where(surplus > 0, low, high), times)
    second = np.repeat(np.where(surplus > 0, high, low), times)
    return closed_chains(first, second)
