# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Read the surface of an object at rest: the basis of its shape keys, without modifiers."""

from __future__ import annotations

import bpy
import numpy as np
from numpy.typing import NDArray

from ...geometry.affine import transformed_points
from ...geometry.mesh import TriangleMesh
from ..element_values import element_values


def resting_mesh(obj: bpy.types.Object, triangles: NDArray[np.int64]) -> TriangleMesh:
    """Return the mesh of an object without modifiers and shape keys, in world space.

    Parameters
    ----------
    obj : bpy.types.Object
        A mesh object.
    triangles : (m, 3) int64
        Triangles of the map.
    """
    keys = obj.data.shape_keys
    local = element_values(keys.reference_key.data if keys else obj.data.vertices, "co", 3).astype(np.float64)
    return TriangleMesh(transformed_points(local, obj.matrix_world), triangles)
