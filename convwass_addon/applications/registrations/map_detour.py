# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How far a map moves a surface, compared with the least distance that brings it onto the other surface.

Maps between different bodies may fit well and be useless: a neck and a tail become the wings of a bird, and the body
turns over on the way. Then points move much farther than transport needs.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment
from scipy.spatial.distance import cdist

from ...geometry.arrays.equal_shares import at_equal_shares
from ...geometry.meshes.mesh import TriangleMesh

# Number of points that represent each surface.
_POINTS = 500
# Surfaces closer than this, relative to the square root of the area, are the same.
_SAME = 1e-6


def map_detour(shapes: Sequence[TriangleMesh], images: Sequence[NDArray[np.float64]]) -> float:
    """Return the length of a map over the Wasserstein distance between the surfaces.

    The length is the root mean square distance over the area between points and their images, after translations that
    make it least, over both shapes. Both surfaces have mass one.

    Parameters
    ----------
    shapes : two TriangleMesh
        The shapes, of triangles much smaller than themselves.
    images : two (n, 3) float64
        The images of the vertices of each on the other shape.

    Returns
    -------
    float
        About 1 if points move to the nearest free places, or if both surfaces are the same. Smaller where the map
        covers only a part of the other shape, and where the surfaces nearly coincide, because samples of different
        triangles are never at distance zero.
    """
    moved = [_spread(mesh, ends - mesh.vertices) for mesh, ends in zip(shapes, images, strict=True)]
    apart = _distance(*(_points(mesh) for mesh in shapes))
    if apart <= _SAME * shapes[0].root_area:
        return 1.0
    return float(np.sqrt(np.mean(moved)) / apart)


def _spread(mesh: TriangleMesh, offsets: NDArray[np.float64]) -> float:
    """Return the variance of offsets at the vertices, by area."""
    shares = mesh.vertex_areas / mesh.area
    return float(shares @ np.square(offsets - shares @ offsets).sum(axis=1))


def _points(mesh: TriangleMesh) -> NDArray[np.float64]:
    """Return centers of triangles at equal steps of area, about their mean."""
    centers = mesh.corners[at_equal_shares(mesh.face_areas, _POINTS)].mean(axis=1)
    return centers - centers.mean(axis=0)


def _distance(first: NDArray[np.float64], second: NDArray[np.float64]) -> float:
    """Return the Wasserstein distance of order two between equally many points of equal mass."""
    costs = cdist(first, second, "sqeuclidean")
    return float(np.sqrt(costs[linear_sum_assignment(costs)].mean()))
