# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Nearest rotations of many matrices at once."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

# Newton's iteration converges quadratically: so many rounds converge for any matrix used with it. After a change that
# is smaller than the second number, only rounding errors are left.
_ROUNDS, _CONVERGED = 7, 1e-8
# Least determinant, after scaling the largest entry to one, for Newton's iteration: a condition number below about 1e4.
_REGULAR = 1e-5
# Cyclic indices of the next row (or column) and of the one after that.
_NEXT, _LAST = np.array([1, 2, 0]), np.array([2, 0, 1])


@dataclass(frozen=True)
class FittedTurns:
    """Rotations and the quality of their fit.

    Attributes
    ----------
    rotations : (3, 3, n) float64
        The proper rotations R that maximize tr(R^T M) for matrices M.
    traces : (n,) float64
        The maxima reached: the sums of the singular values of M, with the least one negated where det M < 0.
    """

    rotations: NDArray[np.float64]
    traces: NDArray[np.float64]


def nearest_rotations(matrices: NDArray[np.float64]) -> FittedTurns:
    """Find the proper rotation nearest to each matrix.

    The polar factor of a matrix with positive determinant is computed by Newton's iteration with scaling (N. Higham,
    "Computing the Polar Decomposition - with Applications", SIAM J. Sci. Stat. Comput. 7, 1986), vectorized over all
    matrices, which takes a third of the time of singular value decompositions. These handle the other matrices.

    Parameters
    ----------
    matrices : (3, 3, n)
        Finite.
    """
    sizes = np.abs(matrices).max(axis=(0, 1))
    turns = matrices / np.maximum(sizes, np.finfo(float).tiny)
    regular = _determinants(turns, _cofactors(turns)) > _REGULAR
    turns[:, :, ~regular] = np.eye(3)[:, :, None]
    for _ in range(_ROUNDS):
        cofactors = _cofactors(turns)
        inverses = cofactors / _determinants(turns, cofactors)
        # The optimal scaling by Frobenius norms, which brings the singular values close to one.
        scales = np.sqrt(np.sqrt(np.square(inverses).sum(axis=(0, 1)) / np.square(turns).sum(axis=(0, 1))))
        before, turns = turns, 0.5 * (scales * turns + inverses / scales)
        if np.abs(turns - before).max(initial=0.0) < _CONVERGED:
            break
    if not regular.all():
        turns[:, :, ~regular] = _by_singular_values(matrices[:, :, ~regular])
    return FittedTurns(turns, (turns * matrices).sum(axis=(0, 1)))


def nearest_rotations_in_plane(matrices: NDArray[np.float64]) -> FittedTurns:
    """Find the rotation about the third axis that is nearest to each matrix.

    In the plane, a rotation with the cosine c and the sine s has the trace c (m11 + m22) + s (m21 - m12) with M. It
    never turns the plane over, as a nearest rotation in space does if M reflects the plane.

    Parameters
    ----------
    matrices : (3, 3, n)
        Finite; their last row and column have no influence.
    """
    cosines, sines = matrices[0, 0] + matrices[1, 1], matrices[1, 0] - matrices[0, 1]
    traces = np.hypot(cosines, sines)
    # Divided by the larger one first, because reciprocals of denormal numbers overflow.
    sizes = np.maximum(np.abs(cosines), np.abs(sines))
    known = sizes > 0
    cosines, sines = (part / np.where(known, sizes, 1.0) for part in (np.where(known, cosines, 1.0), sines))
    lengths = np.hypot(cosines, sines)
    turns = np.zeros(matrices.shape)
    turns[0, 0] = turns[1, 1] = cosines / lengths
    turns[1, 0] = sines / lengths
    turns[0, 1] = -turns[1, 0]
    turns[2, 2] = 1.0
    return FittedTurns(turns, traces)


def nearest_rotation(matrix: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the rotation nearest to a single matrix, (3, 3)."""
    left, _, right = np.linalg.svd(matrix)
    left[:, 2] *= np.sign(np.linalg.det(left @ right))
    return left @ right


def best_turn(points: NDArray[np.float64], images: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the rotation, (3, 3), that best maps points to images about their centers, (n, 3) (S. Umeyama 1991)."""
    return nearest_rotation((images - images.mean(axis=0)).T @ (points - points.mean(axis=0)))


def _cofactors(matrices: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return det M times the transposed inverse of each matrix M, (3, 3, n)."""
    after, last = matrices[_NEXT], matrices[_LAST]
    return after[:, _NEXT] * last[:, _LAST] - after[:, _LAST] * last[:, _NEXT]


def _determinants(matrices: NDArray[np.float64], cofactors: NDArray[np.float64]) -> NDArray[np.float64]:
    return (matrices[0] * cofactors[0]).sum(axis=0)


def _by_singular_values(matrices: NDArray[np.float64]) -> NDArray[np.float64]:
    left, _, right = np.linalg.svd(np.moveaxis(matrices, 2, 0))
    left[:, :, 2] *= np.sign(np.linalg.det(left @ right))[:, None]
    return np.moveaxis(left @ right, 0, 2)
