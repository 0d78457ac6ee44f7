# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes whose triangles are split until no edge is long, so that they can bend."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .edges import edge_use
from .mesh import TriangleMesh


def with_short_edges(mesh: TriangleMesh, longest: float, most_faces: int = 400_000) -> TriangleMesh:
    """Split edges in the middle until none is longer than `longest`.

    Only triangles at long edges are split, into two, three or four, so that neighbors still share whole edges. The
    surface stays where it is, and the first vertices are those of `mesh`.

    Parameters
    ----------
    mesh : TriangleMesh
        Any triangles.
    longest : float
        In units of the vertices, positive.
    most_faces : int
        No further pass is made that would lead to more triangles than these; some edges may then stay longer.
    """
    while True:
        use = edge_use(mesh.faces)
        edge = np.empty(len(use.side), np.int64)
        edge[use.side] = np.repeat(np.arange(len(use.start)), use.count)
        side = use.side[use.start]
        tail = mesh.faces.ravel()[side]
        head = np.roll(mesh.faces, -1, axis=1).ravel()[side]
        is_long = np.linalg.norm(mesh.vertices[head] - mesh.vertices[tail], axis=1) > longest
        splits = is_long[edge].reshape(-1, 3)
        if not is_long.any() or len(mesh.faces) + int(splits.sum()) > most_faces:
            return mesh
        middle = np.full(len(is_long), -1, np.int64)
        middle[is_long] = len(mesh.vertices) + np.arange(np.count_nonzero(is_long))
        middles = 0.5 * (mesh.vertices[tail] + mesh.vertices[head])[is_long]
        faces = _split(mesh.faces, middle[edge].reshape(-1, 3), splits.sum(axis=1))
        mesh = TriangleMesh(np.concatenate([mesh.vertices, middles]), faces)


def _split(faces: NDArray[np.int64], middles: NDArray[np.int64], counts: NDArray[np.int64]) -> NDArray[np.int64]:
    """Split triangles, (m, 3), at the middles of the edges that begin at each corner, (m, 3), -1 for none."""
    # Turned so that the only edge that is split comes first, or the only one that is not comes last.
    lead = np.where(counts == 1, middles.argmax(axis=1), np.where(counts == 2, middles.argmin(axis=1) + 1, 0))
    turn = (lead[:, None] + np.arange(3)) % 3
    a, b, c = np.take_along_axis(faces, turn, axis=1).T
    ab, bc, ca = np.take_along_axis(middles, turn, axis=1).T
    one, two, three = (counts == count for count in (1, 2, 3))
    corners = [
        (counts == 0, (a, b, c)),
        *((one, triangle) for triangle in ((a, ab, c), (ab, b, c))),
        *((two, triangle) for triangle in ((ab, b, bc), (a, ab, bc), (a, bc, c))),
        *((three, triangle) for triangle in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))),
    ]
    return np.concatenate([np.stack(triangle, axis=1)[chosen] for chosen, triangle in corners])
