# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Find shapes without limbs, which need no motion."""

from __future__ import annotations

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from ...geometry.mesh import TriangleMesh

# Shapes that fill this fraction of their convex hulls have no limbs that transport could tear off; chosen by eye.
_NEARLY_CONVEX = 0.85


def is_compact(mesh: TriangleMesh) -> bool:
    """Return whether a shape fills most of its convex hull, so that it has no limbs; loose vertices do not count.

    A shape that lies in a plane has no hull, and is not compact.
    """
    try:
        hull = ConvexHull(mesh.vertices[np.unique(mesh.faces)])
    except QhullError:
        return False
    return abs(mesh.volume) >= _NEARLY_CONVEX * hull.volume
