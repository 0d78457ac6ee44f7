# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How much of a surface a mesh misses."""

from __future__ import annotations

from ...progress import UNINTERRUPTED, Control
from .closest_points import ClosestPointFinder
from .mesh import TriangleMesh
from .spread_distances import spread_distances


def missed_share(surface: TriangleMesh, mesh: TriangleMesh, distance: float, control: Control = UNINTERRUPTED) -> float:
    """Return the share of the area of a surface that is farther than a distance from a mesh, from 0 to 1."""
    return float((spread_distances(surface, ClosestPointFinder(mesh.corners), control) > distance).mean())
