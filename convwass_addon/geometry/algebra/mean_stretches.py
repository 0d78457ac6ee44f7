# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Weighted means of linear maps that are nearly symmetric, such as the stretches of the triangles of a surface.

Halfway to a stretch by 9 across and by 1/9 along, which preserves areas, the arithmetic mean stretches by 5 and by
0.56, so that areas are 2.8 times as large. The area-preserving mean stretches by 3 and 1/3.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from .rotation_fields import rotation_matrices, rotation_vectors
from .rotations import nearest_rotations

Parts = Sequence[tuple[float, NDArray[np.float64]]]
"""Weights and matrices, (m, 3, 3); what the weights lack of 1 is the weight of the identity."""

# Smaller singular values are raised to this.
_LEAST = 1e-3


def arithmetic_mean(parts: Parts) -> NDArray[np.float64]:
    """Return the weighted arithmetic mean of matrices, (m, 3, 3)."""
    return (1.0 - sum(weight for weight, _ in parts)) * np.eye(3) + sum(weight * found for weight, found in parts)


def area_preserving_mean(parts: Parts) -> NDArray[np.float64]:
    """Return a weighted mean of matrices of the plane z = 0, (m, 3, 3), that preserves areas if they do.

    With matrices s_i R_i S_i of sizes s_i, rotations R_i and symmetric S_i of determinant 1, it is (sum_i w_i s_i)
    exp(sum_i w_i log R_i) exp(sum_i w_i log S_i).

    V. Arsigny, P. Fillard, X. Pennec and N. Ayache, "Log-Euclidean Metrics for Fast and Simple Calculus on Diffusion
    Tensors", Magnetic Resonance in Medicine 56(2), 2006.
    """
    sizes = 1.0 - sum(weight for weight, _ in parts)
    turns, logarithms = 0.0, 0.0
    for weight, found in parts:
        rotations = nearest_rotations(found.transpose(1, 2, 0)).rotations.transpose(2, 0, 1)
        stretches = rotations.transpose(0, 2, 1) @ found
        logarithm = _of_values(0.5 * (stretches + stretches.transpose(0, 2, 1)), _logarithms)
        size = 0.5 * np.trace(logarithm, axis1=1, axis2=2)
        sizes = sizes + weight * np.exp(size)
        turns = turns + weight * rotation_vectors(rotations)
        logarithms = logarithms + weight * (logarithm - size[:, None, None] * np.diag([1.0, 1.0, 0.0]))
    mean = rotation_matrices(turns) @ _of_values(logarithms, np.exp)
    mean[:, :2] *= sizes[:, None, None]
    return mean


def _logarithms(values: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.log(np.maximum(values, _LEAST))


def _of_values(
    matrices: NDArray[np.float64], function: Callable[[NDArray[np.float64]], NDArray[np.float64]]
) -> NDArray[np.float64]:
    """Return symmetric matrices, (m, 3, 3), with a function applied to their eigenvalues."""
    values, directions = np.linalg.eigh(matrices)
    return directions * function(values)[:, None] @ directions.transpose(0, 2, 1)
