# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Validate distributions, weights and solver parameters; messages name the argument."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .domain import Domain, total_mass
from .pieces import piece_masses

# Masses on one connected component may differ by the rounding of the caller's normalization.
_PIECE_TOLERANCE = 1e-6


def check_distributions(mus: ArrayLike, domain: Domain, name: str = "mus") -> NDArray[np.float64]:
    """Return `mus` as float64 of shape (k, *domain.shape), each normalized to mass 1.

    Raises
    ------
    ValueError
        A wrong shape, values that are not finite, negative mass, no mass, or masses that differ on a connected
        component of the domain. `name` is the name of the argument in messages.
    """
    densities = np.array(mus, dtype=np.float64, order="C")
    if densities.ndim != len(domain.shape) + 1 or densities.shape[1:] != tuple(domain.shape) or not len(densities):
        raise ValueError(f"{name} must have the shape (k, {', '.join(map(str, domain.shape))}), got {densities.shape}")
    if not isinstance(domain.weights, float):
        densities[:, domain.weights == 0] = 0.0
    for index, density in enumerate(densities):
        _normalize(density, domain, f"{name}[{index}]")
    if domain.pieces is not None:
        _check_pieces(densities, domain, name)
    return densities


def check_distribution(mu: ArrayLike, domain: Domain, name: str) -> NDArray[np.float64]:
    """Return one distribution as float64 of shape `domain.shape`, normalized to mass 1.

    Raises
    ------
    ValueError
        As :func:`check_distributions`.
    """
    density = np.array(mu, dtype=np.float64, order="C")
    if density.shape != tuple(domain.shape):
        raise ValueError(f"{name} must have the shape {tuple(domain.shape)}, got {density.shape}")
    if not isinstance(domain.weights, float):
        density[domain.weights == 0] = 0.0
    _normalize(density, domain, name)
    return density


def check_pair(mu0: ArrayLike, mu1: ArrayLike, domain: Domain) -> NDArray[np.float64]:
    """Return two distributions, called mu0 and mu1, as float64 of shape (2, *domain.shape), each of mass 1.

    Raises
    ------
    ValueError
        As :func:`check_distributions`.
    """
    pair = np.stack([check_distribution(mu0, domain, "mu0"), check_distribution(mu1, domain, "mu1")])
    return check_distributions(pair, domain, "mu")


def _normalize(density: NDArray[np.float64], domain: Domain, name: str) -> None:
    if not np.isfinite(density).all():
        raise ValueError(f"{name} has values that are not numbers")
    if (density < 0).any():
        raise ValueError(f"{name} has negative values; a distribution must not")
    with np.errstate(over="ignore"):
        mass = total_mass(density, domain.weights)
    if not 0 < mass < np.inf:
        raise ValueError(f"{name} has no mass" if mass <= 0 else f"{name} has more mass than float64 can express")
    density /= mass


def _check_pieces(densities: NDArray[np.float64], domain: Domain, name: str) -> None:
    """Check that all distributions have the same mass on each connected component, which mass cannot leave."""
    labels = domain.pieces.ravel()
    masses = piece_masses(densities, domain)
    spread = np.ptp(masses, axis=0)
    worst = int(spread.argmax())
    if spread[worst] > _PIECE_TOLERANCE:
        low, high = int(masses[:, worst].argmin()), int(masses[:, worst].argmax())
        size = int((labels == worst).sum())
        first = int(np.flatnonzero(labels == worst)[0])
        raise ValueError(
            f"{name}[{low}] has mass {masses[low, worst]:.4g} and {name}[{high}] {masses[high, worst]:.4g} on the "
            f"piece of {size} vertices around vertex {first}; mass cannot cross from one connected piece to another"
        )


def check_weights(weights: Sequence[float] | NDArray[np.float64], count: int) -> NDArray[np.float64]:
    """Return `weights` as float64, (count,), normalized to sum 1.

    Raises
    ------
    ValueError
        The wrong number of weights, or weights that are negative, not finite, all zero, or too large to be added.
    """
    alphas = np.array(weights, dtype=np.float64)
    if alphas.shape != (count,):
        raise ValueError(f"weights must be {count} numbers, one per distribution, got shape {alphas.shape}")
    if not np.isfinite(alphas).all() or (alphas < 0).any():
        raise ValueError(f"weights must be zero or positive numbers, got {alphas.tolist()}")
    with np.errstate(over="ignore"):
        total = alphas.sum()
    if total <= 0:
        raise ValueError("weights must not all be zero")
    if not np.isfinite(total):
        raise ValueError(f"weights must have a finite sum, got {alphas.tolist()}")
    return alphas / total


def check_solver(tolerance: float, max_iterations: int, name: str = "max_iterations") -> None:
    """Check the limits of an iteration; `name` is the name of the second argument in messages.

    Raises
    ------
    ValueError
        A tolerance that is not positive, or less than one iteration.
    """
    if not tolerance > 0:
        raise ValueError(f"tolerance must be positive, got {tolerance}")
    if max_iterations < 1:
        raise ValueError(f"{name} must be at least 1, got {max_iterations}")


def check_entropy_limit(entropy_limit: str | float | None) -> None:
    """Check that an entropy bound is "max", a number or None.

    Raises
    ------
    ValueError
        Another word, an array, or not a number.
    """
    if entropy_limit is None or (isinstance(entropy_limit, str) and entropy_limit == "max"):
        return
    if isinstance(entropy_limit, str) or np.ndim(entropy_limit) or np.isnan(entropy_limit):
        raise ValueError(f'entropy_limit must be "max", a number or None, got {entropy_limit!r}')


def check_sharpness(sharpness: float) -> None:
    """Check that a sharpness lies between 0, the plain method, and 1, the debiased one.

    Raises
    ------
    ValueError
        Not a number between 0 and 1.
    """
    if not 0.0 <= sharpness <= 1.0:
        raise ValueError(f"sharpness must lie between 0 and 1, got {sharpness}")
