# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The point about which a shape is voxelized."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .mesh import TriangleMesh


def centroid(mesh: TriangleMesh) -> NDArray[np.float64]:
    """Center of mass of the enclosed solid, (3,), or the center of the bounding box if the volume is unclear."""
    middle = mesh.bounds.mean(axis=0)
    volumes = mesh.face_volumes
    total = volumes.sum()
    if total <= 1e-6 * float(np.prod(np.ptp(mesh.bounds, axis=0))):
        return middle
    # The tetrahedron of a triangle and the reference point has its centroid at the mean of its corners.
    center = (volumes[:, None] * (mesh.corners.sum(axis=1) + middle) / 4.0).sum(axis=0) / total
    inside = ((center >= mesh.bounds[0]) & (center <= mesh.bounds[1])).all()
    return center if inside else middle
