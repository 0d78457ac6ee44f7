# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How much of a surface a mesh misses."""

from __future__ import annotations

from dataclasses import dataclass

from ...progress import UNINTERRUPTED, Control
from .closest_points import ClosestPointFinder
from .edges import side_lengths
from .mesh import TriangleMesh
from .spread_closest_points import spread_closest_points


@dataclass(frozen=True)
class MissedSurface:
    """Shares of the area of a surface, from 0 to 1.

    Attributes
    ----------
    missed : float
        What is far from the mesh.
    beyond : float
        What of that is also farther than the closest triangle is long: smaller triangles there would not reach it, as a
        cape that the mesh has no part for.
    """

    missed: float
    beyond: float


def missed_surface(
    surface: TriangleMesh, mesh: TriangleMesh, distance: float, control: Control = UNINTERRUPTED
) -> MissedSurface:
    """Measure how much of a surface is farther than a distance from a mesh."""
    found = spread_closest_points(surface, ClosestPointFinder(mesh.corners), control)
    far = found.distances > distance
    beyond = far & (found.distances > side_lengths(mesh.corners).max(axis=1)[found.triangles])
    return MissedSurface(float(far.mean()), float(beyond.mean()))
