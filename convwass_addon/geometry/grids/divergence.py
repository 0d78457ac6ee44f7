# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Remove the divergence of a solid's displacements, so that its volume is preserved; its surface moves freely."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, diags_array
from scipy.sparse.linalg import cg

from ...progress import Control
from .solid_cells import SolidCells

_RESIDUAL, _MOST_ITERATIONS = 1e-4, 500
_AXES = ((1, 0, 0), (0, 1, 0), (0, 0, 1))


def divergence_free(solid: SolidCells, displacements: NDArray[np.float64], control: Control) -> NDArray[np.float64]:
    """Remove the divergence of displacements of the cells of a solid.

    Subtracts the gradient of a pressure (Helmholtz decomposition). The pressure is zero outside the solid, which makes
    its surface free. Derivatives are central differences, one-sided where a neighbor is missing.

    Parameters
    ----------
    solid : SolidCells
        The cells that are displaced.
    displacements : (n, 3) float64
        In cells.
    control : Control
        Stops the work.

    Returns
    -------
    (n, 3) float64
        In cells; divergence-free displacements are returned unchanged.
    """
    count = len(solid)
    divergence = np.zeros(count)
    links = []
    for axis, offset in enumerate(_AXES):
        low, high = solid.pairs(offset)
        links.append((low, high))
        rise, known = np.zeros(count), np.zeros(count)
        for end in (low, high):
            rise[end] += displacements[high, axis] - displacements[low, axis]
            known[end] += 1.0
        divergence += rise / np.maximum(known, 1.0)
    pressure = _pressure(links, divergence, control)
    corrected = displacements.copy()
    for axis, (low, high) in enumerate(links):
        upper, lower = np.zeros(count), np.zeros(count)
        upper[low], lower[high] = pressure[high], pressure[low]
        corrected[:, axis] -= 0.5 * (upper - lower)
    return corrected


def _pressure(
    links: list[tuple[NDArray[np.int64], NDArray[np.int64]]], divergence: NDArray[np.float64], control: Control
) -> NDArray[np.float64]:
    """Solve the Poisson equation with the seven-point stencil, and zero outside."""
    count = len(divergence)
    low = np.concatenate([pair[0] for pair in links])
    high = np.concatenate([pair[1] for pair in links])
    ones = np.ones(2 * len(low))
    neighbors = coo_array((ones, (np.concatenate([low, high]), np.concatenate([high, low]))), shape=(count, count))
    system = (diags_array(np.full(count, 6.0)) - neighbors).tocsr()
    pressure, _ = cg(system, -divergence, rtol=_RESIDUAL, maxiter=_MOST_ITERATIONS, callback=lambda _: control.check())
    return pressure
