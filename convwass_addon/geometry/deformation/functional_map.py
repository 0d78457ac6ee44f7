# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Functional maps between surfaces: small matrices between eigenbases, refined by spectral upsampling.

M. Ovsjanikov et al., "Functional Maps: A Flexible Representation of Maps Between Shapes", ACM Transactions on Graphics
31(4), 2012; S. Melzi et al., "ZoomOut: Spectral Upsampling for Efficient Shape Correspondence", ACM Transactions on
Graphics 38(6), 2019.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..algebra.products import product
from ..meshes.spectrum import Spectrum

# Chosen by eye; docs/performance, "Soft maps", lists what functional maps achieve alone and in combination.
# Number of eigenfunctions of the first fit, how many each step adds, and where it ends.
_FIRST, _STEP, _LAST = 20, 10, 120
# Regularization that keeps the fit definite with fewer descriptors than functions.
_RIDGE = 1e-6


@dataclass(frozen=True)
class SpectralMatch:
    """For every vertex of each surface, a vertex of the other.

    Attributes
    ----------
    forward : (n0,) int64
        Vertices of the target.
    backward : (n1,) int64
        Vertices of the source.
    """

    forward: NDArray[np.int64]
    backward: NDArray[np.int64]


def spectral_match(
    source: Spectrum,
    target: Spectrum,
    source_descriptors: NDArray[np.float64],
    target_descriptors: NDArray[np.float64],
) -> SpectralMatch:
    """Match two surfaces by common descriptors.

    Parameters
    ----------
    source, target : Spectrum
        Up to 120 functions of each are used.
    source_descriptors, target_descriptors : (n, d)
        Corresponding functions on the two surfaces.

    Raises
    ------
    ValueError
        Different numbers of descriptors.
    """
    if source_descriptors.shape[1:] != target_descriptors.shape[1:]:
        raise ValueError("source and target need the same number of descriptors")
    most = min(len(source.eigenvalues), len(target.eigenvalues), _LAST)
    first = min(_FIRST, most)
    matrix = _least_squares_map(source.first(first), target.first(first), source_descriptors, target_descriptors)
    return upsampled(matrix, source.first(most), target.first(most))


def upsampled(matrix: NDArray[np.float64], source: Spectrum, target: Spectrum) -> SpectralMatch:
    """Refine a small map with more and more eigenfunctions, in both directions, which keeps it one-to-one.

    Parameters
    ----------
    matrix : (k, k)
        Maps coefficients of functions on the target to those of the same functions on the source.
    source, target : Spectrum
        At least k functions each; the last step uses all of them.
    """
    count, most = len(matrix), len(source.eigenvalues)
    while True:
        match = _nearest(matrix, source.functions[:, :count], target.functions[:, :count])
        if count >= most:
            return match
        count = min(count + _STEP, most)
        here, there = source.functions[:, :count], target.functions[:, :count]
        pulled = product((source.areas[:, None] * here).T, there[match.forward])
        pushed = product((target.areas[:, None] * there).T, here[match.backward])
        matrix = 0.5 * (pulled + pushed.T)


def _least_squares_map(
    source: Spectrum, target: Spectrum, here: NDArray[np.float64], there: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Fit descriptors in the least squares sense, penalizing unequal eigenvalues: equal surfaces have diagonal maps."""
    wanted = product((source.areas[:, None] * source.functions).T, here)
    given = product((target.areas[:, None] * target.functions).T, there)
    squares, mixed = product(given, given.T), product(wanted, given.T)
    top = max(source.eigenvalues[-1], target.eigenvalues[-1], np.finfo(float).tiny)
    apart = np.square((source.eigenvalues[:, None] - target.eigenvalues) / top)
    ridge = _RIDGE * np.trace(squares) / len(squares) + np.finfo(float).tiny
    systems = squares + (apart + ridge)[:, None, :] * np.eye(len(squares))
    return np.linalg.solve(systems, mixed[:, :, None])[:, :, 0]


def _nearest(matrix: NDArray[np.float64], here: NDArray[np.float64], there: NDArray[np.float64]) -> SpectralMatch:
    forward = _closest_rows(product(here, matrix), there)
    return SpectralMatch(forward, _closest_rows(product(there, matrix.T), here))


def _closest_rows(rows: NDArray[np.float64], others: NDArray[np.float64]) -> NDArray[np.int64]:
    """Index of the nearest of the other rows for every row, (n,)."""
    squares = np.square(others).sum(axis=1)
    return (squares - 2.0 * product(rows, others.T)).argmin(axis=1)
