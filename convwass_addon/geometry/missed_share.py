# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How much of a surface a mesh misses."""

from __future__ import annotations

import numpy as np

from ..progress import UNINTERRUPTED, Control
from .closest_points import ClosestPointFinder
from .equal_shares import at_equal_shares
from .mesh import TriangleMesh

# Points of the surface, each of which stands for an equal share of the area.
_POINTS = 4096


def missed_share(surface: TriangleMesh, mesh: TriangleMesh, distance: float, control: Control = UNINTERRUPTED) -> float:
    """Return the share of the area of a surface that is farther than a distance from a mesh, from 0 to 1."""
    # Uniformly distributed in every triangle.
    shares = np.random.default_rng(0).dirichlet((1.0, 1.0, 1.0), _POINTS)
    points = np.einsum("nk,nkd->nd", shares, surface.corners[at_equal_shares(surface.face_areas, _POINTS)])
    found = ClosestPointFinder(mesh.corners).find_about(points, control)
    return float((found.distances > distance).mean())
