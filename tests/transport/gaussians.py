# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Closed forms of entropic transport between Gaussians; lengths in cells.

Janati, Muzellec, Peyré and Cuturi 2020, "Entropic optimal transport between unbalanced Gaussian measures has a closed
form". Their epsilon = 2 sigma^2 is the gamma of K = exp(-d^2 / gamma), with sigma the kernel's deviation.
"""

from __future__ import annotations

import numpy as np


def gaussian(shape, mean, covariance):
    """Density of mass 1 under equal area weights; `covariance` is a matrix, or a variance for all axes."""
    covariance = np.asarray(covariance, dtype=float)
    covariance = covariance if covariance.ndim else covariance * np.eye(len(shape))
    away = np.moveaxis(np.indices(shape), 0, -1) + 0.5 - np.asarray(mean, dtype=float)
    density = np.exp(-0.5 * np.einsum("...i,ij,...j->...", away, np.linalg.inv(covariance), away))
    return density / density.mean()


def moments(density):
    """Mean and covariance, in cells."""
    mass = (density / density.sum()).ravel()
    points = np.moveaxis(np.indices(density.shape), 0, -1).reshape(-1, density.ndim) + 0.5
    mean = mass @ points
    return mean, ((points - mean) * mass[:, None]).T @ (points - mean)


def root(matrix):
    """Symmetric square root of a positive definite matrix."""
    values, vectors = np.linalg.eigh(matrix)
    return (vectors * np.sqrt(values)) @ vectors.T


def bures(first, second):
    """W2^2 between centered Gaussians without regularization."""
    half = root(first)
    return float(np.trace(first + second - 2.0 * root(half @ second @ half)))


def entropic_cost(first, second, sigma):
    """Minimum of transport cost + 2 sigma^2 KL(plan | product) between centered Gaussians (their theorem 1)."""
    count, half = len(first), root(first)
    spread = root(4.0 * half @ second @ half + sigma**4 * np.eye(count))
    volume = np.linalg.slogdet(spread + sigma**2 * np.eye(count))[1]
    bias = count * (1.0 - np.log(2.0 * sigma**2)) + volume
    return float(np.trace(first + second - spread)) + sigma**2 * bias


def debiased_distance(first, second, sigma):
    """Debiased W2^2 between centered Gaussians."""
    own = entropic_cost(first, first, sigma) + entropic_cost(second, second, sigma)
    return entropic_cost(first, second, sigma) - 0.5 * own


def entropic_value(first, second, sigma, cells):
    """Eq. (10) between centered Gaussians on a grid, in squared cells.

    The closed form has the product of the marginals as its reference; eq. (10) has H, which adds the marginals'
    entropies and the normalization of H, for densities with respect to the grid's unit volume.
    """
    entropies = sum(0.5 * np.linalg.slogdet(2.0 * np.pi * np.e * c)[1] for c in (first, second))
    normalization = len(first) * np.log(np.sqrt(2.0 * np.pi) * sigma) + np.log(cells)
    return entropic_cost(first, second, sigma) + 2.0 * sigma**2 * (normalization - entropies)


def raised(first, second, sigma):
    """sigma^2 plus the cross-covariance of the entropic plan, as seen from `first`; barycenters average this."""
    half, identity = root(first), np.eye(len(first))
    return 0.5 * (sigma**2 * identity + root(sigma**4 * identity + 4.0 * half @ second @ half))


def barycenter_covariance(covariances, weights, sigma, sharpness):
    """Covariance of the entropic barycenter of Gaussians, for any sharpness between plain and debiased.

    The scaling of mu toward mu_i is a Gaussian with precision P_i = S^(-1/2) R_i S^(-1/2) / sigma^2 - 1 / sigma^2,
    R_i = raised(S, S_i), and likewise toward itself. Then sum_i alpha_i ln v_i = s ln d is
    S = sum_i alpha_i R_i - s (R_S - S), which is solved by fixed-point iteration.
    """
    covariance = sum(w * c for w, c in zip(weights, covariances, strict=True))
    for _ in range(5000):
        own = raised(covariance, covariance, sigma) - covariance
        found = sum(w * raised(covariance, c, sigma) for w, c in zip(weights, covariances, strict=True))
        found = found - sharpness * own
        if np.abs(found - covariance).max() < 1e-13:
            break
        covariance = 0.5 * (found + found.T)
    return covariance


def map_slope(first, second, sigma):
    """Matrix of the barycentric projection x -> m1 + A (x - m0) of the entropic plan between Gaussians."""
    half = root(first)
    inverse = np.linalg.inv(half)
    cross = 0.5 * root(4.0 * half @ second @ half + sigma**4 * np.eye(len(first)))
    return inverse @ cross @ inverse - 0.5 * sigma**2 * np.linalg.inv(first)


def quantiles(density, levels):
    """Positions in cells below which the fractions `levels` of the mass lie, which fills each cell evenly."""
    mass = density / density.sum()
    cumulated = np.cumsum(mass)
    cells = np.searchsorted(cumulated, levels)
    return cells + 1.0 - (cumulated[cells] - levels) / mass[cells]
