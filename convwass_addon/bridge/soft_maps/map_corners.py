# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Find the face corners of Blender's polygons that correspond to corners of their triangles."""

from __future__ import annotations

import bpy
import numpy as np
from numpy.typing import NDArray

from ...errors import InputError


def triangle_polygons(obj: bpy.types.Object) -> NDArray[np.int64]:
    """Return the polygon of each triangle of a mesh object, (m,)."""
    totals = _totals(obj.data)
    return np.repeat(np.arange(len(totals)), np.maximum(totals - 2, 0))


def triangle_loops(obj: bpy.types.Object, triangles: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the face corner ("loop") at every corner of every triangle, (m, 3).

    Parameters
    ----------
    obj : bpy.types.Object
        A mesh object.
    triangles : (m, 3) int64
        Vertices of the triangles, polygon by polygon, in any triangulation.

    Raises
    ------
    InputError
        The triangles belong to another mesh.
    """
    mesh = obj.data
    corners, totals = np.empty(len(mesh.loops), np.int32), _totals(mesh)
    mesh.loops.foreach_get("vertex_index", corners)
    polygons = triangle_polygons(obj)
    if len(polygons) == len(triangles):
        # A polygon contains a vertex only once, so that both indices together identify a corner.
        count = len(mesh.vertices)
        keys = np.repeat(np.arange(len(totals)), totals).astype(np.int64) * count + corners
        order = np.argsort(keys, kind="stable")
        wanted = polygons[:, None] * np.int64(count) + triangles
        places = np.minimum(np.searchsorted(keys[order], wanted), len(keys) - 1)
        loops = order[places]
        if np.array_equal(keys[loops], wanted):
            return loops
    raise InputError(
        "The vertices or faces of {object} have changed since its soft map was computed; compute it again.",
        object=obj.name,
    )


def _totals(mesh: bpy.types.Mesh) -> NDArray[np.int32]:
    totals = np.empty(len(mesh.polygons), np.int32)
    mesh.polygons.foreach_get("loop_total", totals)
    return totals
