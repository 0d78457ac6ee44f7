# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Sections of closed surfaces with planes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..plane.planar_fill import Boundary
from .edges import face_components
from .mesh import TriangleMesh
from .welding import place_labels


def plane_section(vertices: NDArray[np.float64], faces: NDArray[np.int64], height: float) -> Boundary:
    """Return the edges in which triangles cross a plane of constant last coordinate, in the first two coordinates.

    Parameters
    ----------
    vertices : (n, 3)
        Vertices of a closed surface.
    faces : (m, 3)
        Its triangles, oriented outward.
    height : float
        Last coordinate of the plane.

    Returns
    -------
    Boundary
        Edges of the solid's section. Parts of solids that overlap are not resolved; see :meth:`.Boundary.resolved`.
    """
    above = (vertices[:, 2] > height).take(faces)
    count = np.count_nonzero(above, axis=1)
    crossing = np.flatnonzero((count > 0) & (count < 3))
    corners, above, count = vertices[faces[crossing]], above[crossing], count[crossing]
    # The corner on its own side of the plane comes first.
    alone = np.where(count == 1, above.argmax(axis=1), (~above).argmax(axis=1))
    rows = np.arange(len(corners))
    first, second, third = (corners[rows, (alone + turn) % 3] for turn in range(3))
    ends = [_crossing(first, other, height) for other in (second, third)]
    # Above, the next corner is on the left of the edge from the second to the first crossing.
    leaves = above[rows, alone]
    starts = np.where(leaves[:, None], ends[0], ends[1])
    return Boundary(starts, np.where(leaves[:, None], ends[1], ends[0]))


def all_cross(mesh: TriangleMesh, heights: NDArray[np.float64]) -> bool:
    """Return whether all connected components of a mesh cross a plane, so that its section there shows them.

    The wheels of a van do not cross the middle between its sides, nor the feet of a drum every plane through its axis.

    Parameters
    ----------
    mesh : TriangleMesh
        Pieces that meet in a seam, as the front and the sides of solid text, are one component.
    heights : (n,)
        Heights of its vertices above the plane.
    """
    owners = np.repeat(face_components(place_labels(mesh.vertices)[mesh.faces]), 3)
    lowest, highest = np.full(owners.max() + 1, np.inf), np.full(owners.max() + 1, -np.inf)
    corners = heights[mesh.faces].ravel()
    np.minimum.at(lowest, owners, corners)
    np.maximum.at(highest, owners, corners)
    # Labels need not be consecutive.
    used = np.isfinite(lowest)
    return bool((lowest[used] < 0.0).all() and (highest[used] > 0.0).all())


def _crossing(one: NDArray[np.float64], other: NDArray[np.float64], height: float) -> NDArray[np.float64]:
    """Return where edges cross the plane, (k, 2): equal for both triangles that share an edge."""
    swapped = one[:, 2] > other[:, 2]
    lower, upper = np.where(swapped[:, None], other, one), np.where(swapped[:, None], one, other)
    share = (height - lower[:, 2]) / (upper[:, 2] - lower[:, 2])
    return lower[:, :2] + share[:, None] * (upper[:, :2] - lower[:, :2])
