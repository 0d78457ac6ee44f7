# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Read the meshes of a stored map in the scene, with the triangles of the map."""

from __future__ import annotations

import bpy
import numpy as np
from numpy.typing import NDArray

from ...geometry.mesh import TriangleMesh
from ..surfaces import surface_mesh


def standing_mesh(obj: bpy.types.Object, triangles: NDArray[np.int64], depsgraph: bpy.types.Depsgraph) -> TriangleMesh:
    """Return the mesh of an object with modifiers and shape keys, in world space.

    Parameters
    ----------
    obj : bpy.types.Object
        Must have the vertices and faces for which the map was computed.
    triangles : (m, 3) int64
        Triangles of the map; in another pose, Blender may triangulate differently.
    depsgraph : bpy.types.Depsgraph
        Dependency graph of the scene.

    Raises
    ------
    InputError
        As `surface_mesh`.
    """
    return TriangleMesh(surface_mesh(obj, depsgraph).vertices, triangles)
