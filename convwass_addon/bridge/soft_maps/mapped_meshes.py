# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The meshes of a stored map as they stand in the scene, with the triangles that the map counts."""

from __future__ import annotations

import bpy
import numpy as np
from numpy.typing import NDArray

from ...geometry.mesh import TriangleMesh
from ..surfaces import surface_mesh


def standing_mesh(obj: bpy.types.Object, triangles: NDArray[np.int64], depsgraph: bpy.types.Depsgraph) -> TriangleMesh:
    """Return the mesh of an object as modifiers and shape keys leave it, world space.

    Parameters
    ----------
    obj : bpy.types.Object
        With the vertices and the faces that it had when the map was made.
    triangles : (m, 3) int64
        How its faces are cut, as a map counts them; in another pose Blender may cut them otherwise.
    depsgraph : bpy.types.Depsgraph
        Of the scene.

    Raises
    ------
    InputError
        As `surface_mesh`.
    """
    return TriangleMesh(surface_mesh(obj, depsgraph).vertices, triangles)
