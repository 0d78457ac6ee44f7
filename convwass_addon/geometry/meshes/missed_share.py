# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How much of a surface a mesh misses."""

from __future__ import annotations

from ...progress import UNINTERRUPTED, Control
from .closest_points import ClosestPointFinder
from .mesh import TriangleMesh
from .spread_points import spread_points

# Points of the surface, each of which stands for an equal share of the area.
_POINTS = 4096


def missed_share(surface: TriangleMesh, mesh: TriangleMesh, distance: float, control: Control = UNINTERRUPTED) -> float:
    """Return the share of the area of a surface that is farther than a distance from a mesh, from 0 to 1."""
    points = spread_points(surface.corners, _POINTS).interpolated(surface.corners)
    found = ClosestPointFinder(mesh.corners).find_about(points, control)
    return float((found.distances > distance).mean())
