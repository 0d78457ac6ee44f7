# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Refuse distributions and weights that make no sense, by the name of the argument."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .domain import Domain


def check_distributions(mus: ArrayLike, domain: Domain) -> NDArray[np.float64]:
    """Return `mus` as float64 of shape (k, *domain.shape), each normalized to mass 1.

    Raises
    ------
    ValueError
        A shape that does not fit, values that are not numbers, negative mass, no mass.
    """
    densities = np.array(mus, dtype=np.float64)
    if densities.ndim != len(domain.shape) + 1 or densities.shape[1:] != tuple(domain.shape) or not len(densities):
        raise ValueError(f"mus must have the shape (k, {', '.join(map(str, domain.shape))}), got {densities.shape}")
    for index, density in enumerate(densities):
        if not np.isfinite(density).all():
            raise ValueError(f"mus[{index}] has values that are not numbers")
        if (density < 0).any():
            raise ValueError(f"mus[{index}] has negative values; a distribution must not")
        mass = float((density * domain.weights).sum())
        if mass <= 0:
            raise ValueError(f"mus[{index}] has no mass")
        density /= mass
    return densities


def check_weights(weights: Sequence[float] | NDArray[np.float64], count: int) -> NDArray[np.float64]:
    """Return `weights` as float64, (count,), normalized to sum 1.

    Raises
    ------
    ValueError
        Another number of weights, weights that are negative, not numbers, or all zero.
    """
    alphas = np.array(weights, dtype=np.float64)
    if alphas.shape != (count,):
        raise ValueError(f"weights must be {count} numbers, one per distribution, got shape {alphas.shape}")
    if not np.isfinite(alphas).all() or (alphas < 0).any():
        raise ValueError(f"weights must be zero or positive numbers, got {alphas.tolist()}")
    if alphas.sum() <= 0:
        raise ValueError("weights must not all be zero")
    return alphas / alphas.sum()
