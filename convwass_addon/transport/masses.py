# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Convert histograms, whose values sum to one, to densities, whose mean over the area is one."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .domain import Domain


def from_masses(masses: ArrayLike, domain: Domain) -> NDArray[np.float64]:
    """Convert distributions given by the mass of every element to densities.

    On a grid all cells have the same area and solvers accept histograms directly, because they normalize their inputs.
    On a mesh or a sphere the elements have different areas, so a histogram is not a density.

    Parameters
    ----------
    masses : (k, *domain.shape) or domain.shape
        Histograms; usually of sum 1.
    domain : Domain
        The domain of the histograms.

    Returns
    -------
    ndarray of the same shape, float64
        Density = mass / area; its mean over the area is the sum of the masses. The `masses` of a result are the
        inverse.

    Raises
    ------
    ValueError
        A wrong shape, negative or non-finite masses, or mass on an element without area.
    """
    given = np.asarray(masses, dtype=np.float64)
    if given.shape[-len(domain.shape) :] != tuple(domain.shape) or given.ndim > len(domain.shape) + 1:
        raise ValueError(f"masses must have the shape (k, {', '.join(map(str, domain.shape))}), got {given.shape}")
    if not np.isfinite(given).all() or (given < 0).any():
        raise ValueError("masses must be zero or positive numbers")
    areas = np.broadcast_to(domain.weights, given.shape)
    if (given[areas == 0] != 0).any():
        raise ValueError("masses must be zero on elements that have no area")
    return np.divide(given, areas, out=np.zeros(given.shape), where=areas > 0)
