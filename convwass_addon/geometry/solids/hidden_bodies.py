# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Bodies of a mesh that are inside others, where nobody sees them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..arrays.equal_shares import at_equal_shares
from ..meshes.edges import face_components
from ..meshes.mesh import TriangleMesh
from .solid_angles import winding_numbers

# Triangles of a body whose centers are looked at.
_PROBES = 9


def visible_triangles(mesh: TriangleMesh) -> NDArray[np.bool_]:
    """Return which triangles belong to connected components that are not inside the others, (m,)."""
    names, labels = np.unique(face_components(mesh.faces), return_inverse=True)
    found = np.ones(len(labels), bool)
    if len(names) < 2:
        return found
    rows = [np.flatnonzero(labels == label) for label in range(len(names))]
    boxes = np.array([[own.min(axis=(0, 1)), own.max(axis=(0, 1))] for own in (mesh.corners[part] for part in rows)])
    for number, own in enumerate(rows):
        low, high = boxes[number]
        around = ((boxes[:, 0] < low) & (boxes[:, 1] > high)).all(axis=1)
        if not around.any():
            continue
        others = TriangleMesh(mesh.vertices, mesh.faces[around[labels]])
        probes = mesh.corners[own[at_equal_shares(mesh.face_areas[own], _PROBES)]].mean(axis=1)
        found[own] = not (np.abs(winding_numbers(probes, others)) > 0.5).all()
    return found
