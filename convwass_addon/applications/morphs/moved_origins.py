# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Origins and velocities of a blend of moving inputs.

A vertex of the blend belongs to one point on every moved input, given by a triangle and barycentric coordinates. The
same point on the input at rest is its origin. Moving the inputs a little further gives its velocity.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ...geometry.meshes.closest_points import ClosestPoints
from ..motions.motion import Motion, MovedShape

# Change of the weights for forward differences; their error is of about this relative size.
_STEP = 1e-4


def moved_origins(
    places: Sequence[ClosestPoints],
    shapes: Sequence[MovedShape],
    active: NDArray[np.int64],
    vertices: NDArray[np.float64],
    count: int,
) -> NDArray[np.float32]:
    """Return the points on the inputs at rest that the vertices of a blend come from.

    Parameters
    ----------
    places : sequence of ClosestPoints
        For every input of positive weight, the points on it that belong to the vertices.
    shapes : sequence of MovedShape
        These inputs.
    active : (a,) int64
        Their indices.
    vertices : (n, 3) float64
        Vertices of the blend in scene space.
    count : int
        Number of inputs.

    Returns
    -------
    (count, n, 3) float32
        In scene space; the vertices themselves for inputs without weight.
    """
    origins = np.tile(vertices.astype(np.float32), (count, 1, 1))
    for index, own, shape in zip(active, places, shapes, strict=True):
        origins[index] = own.interpolated(shape.rest.corners)
    return origins


def moved_tangents(
    places: Sequence[ClosestPoints],
    shapes: Sequence[MovedShape],
    motion: Motion,
    weights: Sequence[float],
    vertices: NDArray[np.float64],
) -> NDArray[np.float32]:
    """Return points that the vertices of a blend move towards or away from when the weights change.

    With x(w) the position of a vertex, D_i = d/ds x(w + s (e_i - w)) is its motion when weight i grows and the others
    shrink in proportion. If the weights change at the rates r, with sum zero and r_i = 0 for inputs without weight, the
    velocity is sum_i r_i (x + D_i).

    Parameters
    ----------
    places, shapes
        As for :func:`moved_origins`.
    motion : Motion
        How the inputs move.
    weights : (k,)
        Weights of the blend.
    vertices : (n, 3) float64
        Vertices of the blend in scene space.

    Returns
    -------
    (k, n, 3) float32
        x + D_i; x for inputs without weight.
    """
    alphas = np.asarray(weights, dtype=np.float64)
    active = np.flatnonzero(alphas)
    tangents = np.tile(vertices.astype(np.float32), (len(alphas), 1, 1))
    here = _followed(places, shapes, alphas[active])
    # Since sum_i w_i (e_i - w) = 0, so is sum_i w_i D_i: the D of the largest weight follows from the others.
    largest = int(alphas.argmax())
    rest = np.zeros(vertices.shape)
    for index in active[active != largest]:
        direction = -alphas
        direction[index] += 1.0
        # At most half of the way to the input itself.
        step = min(_STEP, 0.5 * alphas[active].min())
        ahead = alphas + step * direction
        moved = motion.moved(tuple(ahead.tolist()))
        along = (_followed(places, [moved[i] for i in active], ahead[active]) - here) / step
        tangents[index] += along.astype(np.float32)
        rest -= alphas[index] * along
    tangents[largest] += (rest / alphas[largest]).astype(np.float32)
    return tangents


def _followed(
    places: Sequence[ClosestPoints], shapes: Sequence[MovedShape], weights: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the mean of points on moved shapes, (n, 3)."""
    return sum(
        weight * own.interpolated(shape.mesh.corners)
        for weight, own, shape in zip(weights, places, shapes, strict=True)
    )
