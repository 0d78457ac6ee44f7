# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Find the face corners of Blender's polygons that correspond to corners of their triangles."""

from __future__ import annotations

import bpy
import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ..element_values import element_values


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
    corners, totals = element_values(mesh.loops, "vertex_index", kind=np.int32), _totals(mesh)
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
    return element_values(mesh.polygons, "loop_total", kind=np.int32)
