# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Submeshes, and vertices that move with others."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ...geometry.rotations import nearest_rotations

# Number of vertices that determine the motion of a part without counterpart.
_AROUND = 40


def renumbered(faces: NDArray[np.int64], own: NDArray[np.int64], count: int) -> NDArray[np.int64]:
    """Return the triangles between some vertices, (f, 3), as indices in these."""
    if len(own) == count:
        return faces
    place = np.full(count, -1, np.int64)
    place[own] = np.arange(len(own))
    kept = place[faces]
    return kept[(kept >= 0).all(axis=1)]


def with_others(rest: NDArray[np.float64], own: NDArray[np.int64], moved: NDArray[np.float64]) -> NDArray[np.float64]:
    """Move all other vertices like the moved ones around each, by similarity transforms, (n, 3)."""
    points = np.empty_like(rest)
    points[own] = moved
    others = np.setdiff1d(np.arange(len(rest)), own)
    if not len(others):
        return points
    nearest = cKDTree(rest[own]).query(rest[others], min(_AROUND, len(own)))[1].reshape(len(others), -1)
    before, after = rest[own][nearest], moved[nearest]
    here, there = before.mean(axis=1), after.mean(axis=1)
    before, after = before - here[:, None], after - there[:, None]
    fitted = nearest_rotations(np.einsum("nki,nkj->ijn", after, before))
    scales = fitted.traces / np.maximum(np.square(before).sum(axis=(1, 2)), np.finfo(float).tiny)
    turned = np.einsum("ijn,nj->ni", fitted.rotations, rest[others] - here)
    points[others] = there + np.maximum(scales, 0.0)[:, None] * turned
    return points
