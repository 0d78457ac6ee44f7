# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Conformal distortion of triangles under a deformation: the ratio of their two singular values."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .mesh import TriangleMesh

# Upper limit of a distortion, which degenerate triangles have.
_MOST = 10.0


def vertex_distortions(rest: TriangleMesh, vertices: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the mean distortion of the triangles around every vertex, (n,), weighted by their areas at rest.

    With singular values s1 and s2 of a triangle's deformation, its distortion is (s1 / s2 + s2 / s1) / 2: 1 where
    angles are preserved, 1.25 where one direction is stretched twice as much as the other (K. Hormann and G. Greiner,
    "MIPS: an efficient global parametrization method", Curve and Surface Design, 1999). Bending and uniform scaling do
    not count.

    Parameters
    ----------
    rest : TriangleMesh
        The undeformed mesh.
    vertices : (n, 3) float64
        The deformed vertices.
    """
    before, after = (_metrics(points[rest.faces]) for points in (rest.vertices, vertices))
    areas = np.sqrt(np.maximum(before[0] * before[2] - np.square(before[1]), 0.0))
    moved = np.sqrt(np.maximum(after[0] * after[2] - np.square(after[1]), 0.0))
    # The trace of the inverse first metric times the second is s1^2 + s2^2; here it is multiplied by the squared area.
    traces = before[2] * after[0] - 2.0 * before[1] * after[1] + before[0] * after[2]
    distortions = np.minimum(0.5 * traces / np.maximum(areas * moved, np.finfo(float).tiny), _MOST)
    weights = np.repeat(areas, 3)
    corners = rest.faces.ravel()
    sums = np.bincount(corners, weights * np.repeat(distortions, 3), len(vertices))
    total = np.bincount(corners, weights, len(vertices))
    return np.where(total > 0.0, sums / np.maximum(total, np.finfo(float).tiny), 1.0)


def _metrics(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the first fundamental forms of triangles, (3, m): squared lengths of two edges around their product."""
    one, other = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    return np.stack([np.einsum("md,md->m", a, b) for a, b in ((one, one), (one, other), (other, other))])
