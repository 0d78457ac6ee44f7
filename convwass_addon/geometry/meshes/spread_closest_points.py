# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The points of a surface that are closest to another one, all over its triangles."""

from __future__ import annotations

from ...progress import UNINTERRUPTED, Control
from .closest_points import ClosestPointFinder, ClosestPoints
from .mesh import TriangleMesh
from .spread_points import spread_points

# Points of the surface, each of which stands for an equal share of the area.
_POINTS = 4096


def spread_closest_points(
    surface: TriangleMesh, finder: ClosestPointFinder, control: Control = UNINTERRUPTED
) -> ClosestPoints:
    """Find the closest points to points that are spread evenly over the area of a surface."""
    points = spread_points(surface.corners, _POINTS).interpolated(surface.corners)
    return finder.find_about(points, control)
