# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Join vertices that lie in one place: files of separate triangles have no holes for that."""

from __future__ import annotations

import numpy as np

from .mesh import TriangleMesh


def welded(mesh: TriangleMesh) -> TriangleMesh:
    """Return the mesh with one vertex in every place, and without triangles that are none then.

    Vertices that no triangle uses are left out.
    """
    vertices, index = np.unique(mesh.vertices[mesh.faces].reshape(-1, 3), axis=0, return_inverse=True)
    faces = index.reshape(-1, 3)
    a, b, c = faces.T
    return TriangleMesh(vertices, np.ascontiguousarray(faces[(a != b) & (b != c) & (c != a)]))
