# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Find shapes without limbs, which need no motion."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, QhullError

from ...geometry.mesh import TriangleMesh

# Shapes that fill this fraction of their convex hulls have no limbs that transport could tear off; chosen by eye.
_NEARLY_CONVEX = 0.85


def is_nearly_convex(points: NDArray[np.float64], content: float) -> bool:
    """Return whether a shape fills most of its convex hull.

    Parameters
    ----------
    points : (n, 2) or (n, 3) float64
        Points on its boundary.
    content : float
        Its area or volume.

    Returns
    -------
    bool
        False if there is no hull, because all points lie on a line, or in space in a plane.
    """
    try:
        hull = ConvexHull(points)
    except QhullError:
        return False
    # For hulls in the plane, Qhull's `volume` is the area.
    return abs(content) >= _NEARLY_CONVEX * hull.volume


def is_compact(mesh: TriangleMesh) -> bool:
    """Return whether a shape has no limbs; its loose vertices do not count."""
    return is_nearly_convex(mesh.vertices[np.unique(mesh.faces)], mesh.volume)
