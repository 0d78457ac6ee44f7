# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Merge coincident vertices, since files of separate triangles would otherwise seem to be full of holes."""

from __future__ import annotations

import numpy as np

from .edges import proper_faces
from .mesh import TriangleMesh


def welded(mesh: TriangleMesh) -> TriangleMesh:
    """Return the mesh with coincident vertices merged and degenerate triangles removed.

    Unused vertices are removed as well.
    """
    is_used = np.zeros(len(mesh.vertices), bool)
    is_used[mesh.faces] = True
    used = np.flatnonzero(is_used)
    # Sorting by columns takes a tenth of the time of np.unique for rows.
    order = used[np.lexsort(mesh.vertices[used].T[::-1])]
    points = mesh.vertices[order]
    is_first = np.ones(len(order), bool)
    is_first[1:] = (points[1:] != points[:-1]).any(axis=1)
    index = np.empty(len(mesh.vertices), np.int64)
    index[order] = np.cumsum(is_first) - 1
    return TriangleMesh(points[is_first], np.ascontiguousarray(proper_faces(index[mesh.faces])))
