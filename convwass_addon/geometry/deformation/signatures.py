# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Isometry-invariant signatures of points on a surface."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..algebra.products import product
from ..meshes.spectrum import Spectrum

# Standard deviation of the wave kernel's bands, in energy steps, and the margin at the upper end (Aubry et al. 2011).
_BAND_STEPS = 7.0
_UPPER_END = 1.02
# Eigenvalues below this, on a surface of unit area, count as zero: constants on its components.
_ZERO = 1e-6


def wave_kernel_signature(spectrum: Spectrum, energies: int = 100) -> NDArray[np.float64]:
    """Return the probability of measuring a quantum particle of every energy at every vertex, (n, energies).

    Column e is sum_k w_ek f_k^2 with w_ek = exp(-(ln E_e - ln lambda_k)^2 / (2 s^2)), normalized to sum one over k.
    Energies are spaced logarithmically from the first nonzero eigenvalue almost to the last, and s is seven steps.
    M. Aubry, U. Schlickewei and D. Cremers, "The Wave Kernel Signature: A Quantum Mechanical Approach to Shape
    Analysis", ICCV Workshops, 2011.

    Parameters
    ----------
    spectrum : Spectrum
        Spectrum of the surface.
    energies : int
        Number of energies, at least two.

    Raises
    ------
    ValueError
        Fewer than two energies, or fewer than two nonzero eigenvalues.
    """
    if energies < 2:
        raise ValueError(f"at least two energies are needed, got {energies}")
    values, squares = _nonzero_modes(spectrum)
    if len(values) < 2:
        raise ValueError("at least two eigenvalues that are not zero are needed")
    logs = np.log(values)
    # Move the end inwards whatever the sign of its logarithm.
    grid = np.linspace(logs[0], logs[-1] - (1.0 - 1.0 / _UPPER_END) * abs(logs[-1]), energies)
    width = _BAND_STEPS * (grid[-1] - grid[0]) / energies
    if width == 0:
        bands = np.ones((energies, len(values)))
    else:
        exponents = -np.square(grid[:, None] - logs) / (2.0 * width**2)
        bands = np.exp(exponents - exponents.max(axis=1, keepdims=True))
    return product(squares, (bands / bands.sum(axis=1, keepdims=True)).T)


def _nonzero_modes(spectrum: Spectrum) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Nonzero eigenvalues, and squares of their eigenfunctions."""
    moving = spectrum.eigenvalues > _ZERO
    return spectrum.eigenvalues[moving], np.square(spectrum.functions[:, moving])
