# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Rotations of the parts of a body, divided so that each factor can be interpolated alone.

Maps between surfaces know where a limb points, but on a round limb hardly how far it is twisted. If a swing and a twist
are interpolated as one rotation, the limb moves on a cone; interpolated apart, it moves in a plane. Both are relative
to the body: a body that only turns stays rigid.

Turns are arrays (..., 3, 3) of three rotation vectors in radians: the turn g of the whole body, the swing s of the limb
and its twist u about its own axis. The rotation is exp(g) exp(s) exp(u). Turns can be averaged and scaled.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..algebra.rotation_fields import matrices_about, nearest_branches, rotation_matrices, rotation_vectors
from ..algebra.rotations import nearest_rotations
from ..arrays.steps import linear_step
from .limb_axes import LimbAxes

# Rotations by more than the first angle, in radians, are divided less and less, and not at all beyond the second one:
# of half a turn about an axis across the limb, any part can be twist.
_DIVIDED, _WHOLE = 2.4, 2.9
# Iterations of the median, and the distance between matrices, about an angle in radians, up to which it is a mean.
_ROUNDS, _NEAR = 20, 0.02


def turn_matrices(turns: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the rotations, (n, 3, 3), of turns of one body, (n, 3, 3), whose first vectors are all the same.

    They are composed as quaternions, in two fifths of the time of products of matrices and an eighth of that of SciPy.
    """
    # Coordinate by coordinate, numbers that are used together are next to each other.
    whole, swings, twists = np.ascontiguousarray(turns.transpose(1, 2, 0))
    w, *axes = _product(_quaternions(whole[:, :1]), _product(_quaternions(swings), _quaternions(twists)))
    return matrices_about(axes, 2.0 * w, 2.0)


def mean_turns(turns: NDArray[np.float64], ends: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return the mean turns of the corners of triangles or of the ends of links, (k, 3) or (k, 2), as (k, 3, 3)."""
    # Corner by corner: NumPy takes several times as long for means over an axis of length three.
    total = sum(turns.take(corner, axis=0) for corner in np.ascontiguousarray(ends.T))
    return total / ends.shape[1]


def _quaternions(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the unit quaternions (w, x, y, z) of rotation vectors, (3, n) by coordinate, as (4, n)."""
    x, y, z = vectors
    half = 0.5 * np.sqrt(x * x + y * y + z * z)
    along = 0.5 * np.sinc(half / np.pi)
    return np.stack([np.cos(half), along * x, along * y, along * z])


def _product(one: NDArray[np.float64], other: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the products of quaternions, (4, n) or (4, 1)."""
    (a, b, c, d), (w, x, y, z) = one, other
    return np.stack(
        [
            a * w - b * x - c * y - d * z,
            a * x + b * w + c * z - d * y,
            a * y - b * z + c * w + d * x,
            a * z + b * y - c * x + d * w,
        ]
    )


def median_rotation(rotations: NDArray[np.float64], areas: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the geometric median, (3, 3), of rotations, (n, 3, 3), by Weiszfeld's algorithm (1937).

    It is the rotation of most of a surface with vertices of these areas, (n,), even if limbs rotate far.
    """
    weights = areas
    for _ in range(_ROUNDS):
        mean = np.einsum("n,nij->ij", weights, rotations)
        middle = nearest_rotations(mean[:, :, None]).rotations[:, :, 0]
        distances = np.linalg.norm(rotations - middle, axis=(1, 2)) / np.sqrt(2.0)
        weights = areas / np.maximum(distances, _NEAR)
    return middle


def divided_turns(whole: NDArray[np.float64], vectors: NDArray[np.float64], axes: LimbAxes) -> NDArray[np.float64]:
    """Divide rotations into swings and twists about the axes of limbs.

    Parameters
    ----------
    whole : (3,)
        The turn of the whole body.
    vectors : (n, 3)
        Rotation vectors before it.
    axes : LimbAxes
        The axis at every point, before the rotation; where its weight is zero, there is no twist.

    Returns
    -------
    (n, 3, 3) float64
        Turns.
    """
    # The twist part of a quaternion (w, v) about the axis a is (w, (v . a) a).
    w, *v = _quaternions(vectors.T)
    twists = 2.0 * np.arctan2(np.einsum("dn,nd->n", v, axes.directions), w)
    # The same rotation by at most half a turn.
    twists -= 2.0 * np.pi * np.round(twists / (2.0 * np.pi))
    angles = np.linalg.norm(vectors, axis=1)
    weights = axes.weights * linear_step(angles, _WHOLE, _DIVIDED)
    return turns_with_twists(whole, vectors, (weights * twists)[:, None] * axes.directions)


def turns_with_twists(
    whole: NDArray[np.float64], vectors: NDArray[np.float64], twists: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Divide rotations into given twists, (n, 3), and the swings that remain; otherwise as :func:`divided_turns`."""
    swings = rotation_vectors(rotation_matrices(vectors) @ rotation_matrices(-twists))
    return np.stack([np.broadcast_to(whole, vectors.shape), nearest_branches(swings, vectors), twists], axis=1)


def inverse_turns(turns: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return turns of the inverse rotations, (n, 3, 3): on the way back, parts pass through the same rotations.

    With G = exp(g) and S = exp(s), the inverse of G S exp(u) is exp(-g) exp(-G s) exp(-G S u).
    """
    whole, swings, twists = (turns[:, factor] for factor in range(3))
    first = rotation_matrices(whole)
    both = first @ rotation_matrices(swings)
    turned = (np.einsum("nij,nj->ni", *pair) for pair in ((first, swings), (both, twists)))
    return -np.stack([whole, *turned], axis=1)
