# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Small elastic displacements of a solid, which preserve the distances within it as far as possible."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import bsr_array
from scipy.sparse.linalg import LinearOperator, cg

from ...progress import Control
from .solid_cells import HALF_OF_THE_NEIGHBORS, SolidCells

# Relative residual at which conjugate gradients stop, and their largest number of iterations. A registration recomputes
# the step in every round, so the rest is left to the next round.
_RESIDUAL, _MOST_ITERATIONS = 1e-3, 250


def elastic_step(
    solid: SolidCells,
    aims: NDArray[np.float64],
    trust: NDArray[np.float64],
    width: float,
    control: Control,
) -> NDArray[np.float64]:
    """Displace the cells of a solid elastically towards their target displacements.

    The displacements v minimize

        sum_i q_i |v_i - d_i|^2 + width^2 sum_ij min(m_i, m_j) / |e_ij|^2 ((v_i - v_j) . e_ij / |e_ij|)^2

    over the cells i and the pairs ij of neighboring cells (26 neighborhood), with e_ij from one center to the other:
    springs that resist stretching and compression. Translations and infinitesimal rotations have no energy.

    Parameters
    ----------
    solid : SolidCells
        m are its filled fractions.
    aims : (n, 3) float64
        d, in cells.
    trust : (n,) float64
        q: the weight of each aim. It must be positive somewhere in every connected component of the solid.
    width : float
        Approximate size, in cells, of the parts that move together.
    control : Control
        Stops the work.

    Returns
    -------
    (n, 3) float64
        In cells.
    """
    system = _system(solid, np.maximum(trust, 1e-4), width)
    diagonal = _diagonal_blocks(system)
    inverses = np.linalg.inv(diagonal)

    def precondition(vector: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.einsum("nij,nj->ni", inverses, vector.reshape(-1, 3)).ravel()

    right = (np.maximum(trust, 1e-4)[:, None] * aims).ravel()
    found, _ = cg(
        system,
        right,
        aims.ravel(),
        rtol=_RESIDUAL,
        maxiter=_MOST_ITERATIONS,
        M=LinearOperator(system.shape, precondition, dtype=np.float64),
        callback=lambda _: control.check(),
    )
    return found.reshape(-1, 3)


def _system(solid: SolidCells, trust: NDArray[np.float64], width: float) -> bsr_array:
    """Matrix of the normal equations in 3 x 3 blocks, (3n, 3n)."""
    count = len(solid)
    rows, columns, blocks = [np.arange(count)], [np.arange(count)], [np.zeros((count, 3, 3))]
    blocks[0][:] = trust[:, None, None] * np.eye(3)
    for offset in HALF_OF_THE_NEIGHBORS:
        first, second = solid.pairs(offset)
        edge = np.array(offset, float)
        squared = float(edge @ edge)
        weights = width**2 * np.minimum(solid.filled[first], solid.filled[second]) / squared
        outer = np.outer(edge, edge) / squared
        spring = weights[:, None, None] * outer
        own = np.bincount(first, weights, count) + np.bincount(second, weights, count)
        blocks[0] += own[:, None, None] * outer
        rows += [first, second]
        columns += [second, first]
        blocks += [-spring, -spring]
    row, column = np.concatenate(rows), np.concatenate(columns)
    # Pairs of cells occur once, and single numbers sort much faster than np.lexsort.
    order = np.argsort(row * count + column)
    starts = np.concatenate([[0], np.cumsum(np.bincount(row, minlength=count))])
    return bsr_array((np.concatenate(blocks)[order], column[order], starts), shape=(3 * count, 3 * count))


def _diagonal_blocks(system: bsr_array) -> NDArray[np.float64]:
    row = np.repeat(np.arange(len(system.indptr) - 1), np.diff(system.indptr))
    return system.data[system.indices == row]
