# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How far the inside of a shape moves where it is deformed, apart from where the shape is and how large it is."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..meshes.mesh import TriangleMesh
from ..plane.plane_angles import rotated


def travel(mesh: TriangleMesh, moved: NDArray[np.float64], turn: float = 0.0) -> float:
    """Return how far points of a flat mesh move, relative to their distances from its center.

    This is the root mean square over the area at rest, after both shapes were moved to the same center, and scaled to
    the same root mean square distance from it. A turn by an angle a has 2 sin(a / 2), and half a turn, with 2, the most
    that is possible.

    Parameters
    ----------
    mesh : TriangleMesh
        At rest, in the plane z = 0.
    moved : (n, 2) float64
        Positions of its vertices.
    turn : float
        Angle in radians of a turn of the whole mesh that does not count.
    """
    shares = mesh.vertex_areas / mesh.area
    ours, theirs = (_unit(points, shares) for points in (mesh.vertices[:, :2], moved))
    return float(np.sqrt(shares @ np.square(theirs - rotated(ours, turn)).sum(axis=1)))


def _unit(points: NDArray[np.float64], shares: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return points, (n, 2), with the center at the origin and a mean square distance of one from it."""
    away = points - shares @ points
    return away / np.sqrt(shares @ np.square(away).sum(axis=1))
