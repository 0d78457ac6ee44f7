# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Convert boundaries of flat meshes to polygons."""

from __future__ import annotations

import bpy
import numpy as np
from numpy.typing import NDArray

from ...geometry.affine import transformed_points
from ...geometry.ring_nesting import closed_chains
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
    """Read the boundaries of the faces of a flat mesh by material, regardless of the orientation of faces."""
    mesh = evaluated.data
    matrix = np.array(evaluated.matrix_world, dtype=np.float64)
    points = _points(mesh, matrix)
    plane = plane_of(points, matrix)
    corners, loops = plane.coordinates(points), element_values(mesh.loops, "vertex_index", kind=np.int32)
    names = ("loop_start", "loop_total", "material_index")
    starts, totals, slots = (element_values(mesh.polygons, name, kind=np.int32) for name in names)
    rings: list[NDArray[np.int64]] = []
    owners: list[int] = []
    for slot in np.unique(slots):
        chosen = np.flatnonzero(slots == slot)
        found = _border([loops[starts[face] : starts[face] + totals[face]] for face in chosen], corners)
        rings += found
        owners += [int(slot)] * len(found)
    return FlatRings([points[ring] for ring in rings], matrix, "non-zero", None, tuple(owners))


def _points(mesh: bpy.types.Mesh, matrix: NDArray[np.float64]) -> NDArray[np.float64]:
    return transformed_points(vectors_of(mesh.vertices), matrix)


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
