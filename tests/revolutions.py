# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Solids of revolution about the z axis."""

from __future__ import annotations

import numpy as np

from benchmarks.props import revolved
from convwass_addon.geometry.solids.occupancy import occupancy

CONE = revolved([(0.0, 0.0), (1.0, 0.0), (0.0, 2.0)])
LARGER_CONE = revolved([(0.0, 0.0), (3.0, 0.0), (0.0, 3.0)])
CUP = revolved([(0.0, 0.0), (0.8, 0.0), (1.0, 1.5), (0.85, 1.5), (0.65, 0.15), (0.0, 0.15)])
BOWL = revolved([(0.0, 0.0), (0.6, 0.0), (1.6, 0.8), (1.45, 0.85), (0.5, 0.2), (0.0, 0.2)])


def asideness(mesh, axis, center):
    """Root mean square of how far normals lie beside the planes through an axis."""
    corners = mesh.corners - center
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    around = np.cross(axis, corners.mean(axis=1))
    around /= np.linalg.norm(around, axis=1)[:, None]
    areas = np.linalg.norm(normals, axis=1)
    return np.sqrt(np.square((normals * around).sum(axis=1) / areas) @ areas / areas.sum())


def floor(mesh):
    """Height of the upper end of what is solid on the axis, as a share of the height of the shape."""
    low, high = mesh.bounds
    cell = (high - low).max() / 70.0
    filled = occupancy((mesh.corners - low) / cell + 4.0, (78, 78, 78))
    x, y = (int(middle) for middle in 0.5 * (high - low)[:2] / cell + 4.0)
    return filled[x, y].sum() * cell / (high[2] - low[2])
