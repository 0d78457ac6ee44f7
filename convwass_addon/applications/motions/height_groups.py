# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Heights of the vertices of upright shapes as group weights, so that maps prefer what is at the same height."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...geometry.mesh import TriangleMesh

# Weight of heights relative to sides. Without, a cactus becomes a child that stands on its head. With half, it stays
# upright, as does a chair that becomes a man; from 0.7 on, a dog no longer becomes a bird symmetrically.
_UPRIGHT = 0.5

Groups = dict[str, NDArray[np.float64]]
"""Weights of the vertices of a mesh, (n,), by the name of the group."""


def height_groups(mesh: TriangleMesh) -> Groups:
    """Return how far up the vertices of a shape are, from 0 to 0.5."""
    low, high = mesh.bounds[:, 2]
    # Vertices without triangles may be anywhere.
    return {"up": _UPRIGHT * np.clip((mesh.vertices[:, 2] - low) / max(high - low, np.finfo(float).tiny), 0.0, 1.0)}
