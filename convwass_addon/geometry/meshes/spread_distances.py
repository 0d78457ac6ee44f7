# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How far a surface is from another one, all over its triangles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...progress import UNINTERRUPTED, Control
from .closest_points import ClosestPointFinder
from .mesh import TriangleMesh
from .spread_points import spread_points

# Points of the surface, each of which stands for an equal share of the area.
_POINTS = 4096


def spread_distances(
    surface: TriangleMesh, finder: ClosestPointFinder, control: Control = UNINTERRUPTED
) -> NDArray[np.float64]:
    """Return distances from triangles, (k,), of points that are spread evenly over the area of a surface."""
    points = spread_points(surface.corners, _POINTS).interpolated(surface.corners)
    return finder.find_about(points, control).distances
