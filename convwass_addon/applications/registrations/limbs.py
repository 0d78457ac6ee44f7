# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Find shapes without limbs, which need no motion."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, QhullError

from ...geometry.meshes.mesh import TriangleMesh

# Shapes that fill this fraction of their convex hulls have no limbs that transport could tear off; chosen by eye.
_NEARLY_CONVEX = 0.85
# The hull of about so many points shows that most shapes with limbs have some.
_SOME = 5000


def is_compact(mesh: TriangleMesh) -> bool:
    """Return whether a shape fills most of its convex hull, so that it has no limbs; loose vertices do not count.

    A shape that lies in a plane has no hull, and is not compact.
    """
    points, volume = mesh.vertices[mesh.is_used], abs(mesh.volume)
    # The hull of some of the points is found much faster, and not larger.
    if volume < _NEARLY_CONVEX * _hull_volume(points[:: 1 + len(points) // _SOME]):
        return False
    hull = _hull_volume(points)
    return hull > 0.0 and volume >= _NEARLY_CONVEX * hull


def _hull_volume(points: NDArray[np.float64]) -> float:
    """Return the volume of the convex hull of points, (n, 3), zero if they lie in a plane."""
    try:
        return float(ConvexHull(points).volume)
    except QhullError:
        return 0.0
