# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The rotations nearest to many matrices at once."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

# Newton's iteration squares what is wrong in every round: this many take any matrix that it is given to rounding.
_ROUNDS = 7
# Determinants, of matrices whose largest entry is one, from which on it is given them: about a condition below 1e4.
_REGULAR = 1e-5
# The row (or column) after each, and the one after that.
_NEXT, _LAST = np.array([1, 2, 0]), np.array([2, 0, 1])


@dataclass(frozen=True)
class FittedTurns:
    """Rotations, and how well they fit.

    Attributes
    ----------
    rotations : (3, 3, n) float64
        The proper rotations R that maximize tr(R^T M) for matrices M.
    traces : (n,) float64
        What they reach: the sum of the singular values of M, the least taken negatively where det M < 0.
    """

    rotations: NDArray[np.float64]
    traces: NDArray[np.float64]


def nearest_rotations(matrices: NDArray[np.float64]) -> FittedTurns:
    """Find the proper rotation nearest to each matrix.

    The polar factor of a matrix of positive determinant is found by Newton's iteration with scaling (N. Higham,
    "Computing the Polar Decomposition - with Applications", SIAM J. Sci. Stat. Comput. 7, 1986), on all matrices side
    by side, which takes a third of the time of as many singular value decompositions; the others are left to those.

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
        # The scale that brings the singular values closest to one, in Frobenius norms.
        scales = np.sqrt(np.sqrt(np.square(inverses).sum(axis=(0, 1)) / np.square(turns).sum(axis=(0, 1))))
        turns = 0.5 * (scales * turns + inverses / scales)
    if not regular.all():
        turns[:, :, ~regular] = _by_singular_values(matrices[:, :, ~regular])
    return FittedTurns(turns, (turns * matrices).sum(axis=(0, 1)))


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
