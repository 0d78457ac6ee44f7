# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Descriptors of the points of a surface: wave kernel signatures and distances to marked points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...geometry.deformation.signatures import wave_kernel_signature
from ...geometry.deformation.unit_shape import UnitShape
from ...geometry.meshes.spectrum import Spectrum, spectrum
from ...geometry.meshes.surface_graph import surface_distances

_FUNCTIONS = 120
_ENERGIES = 50
# Chosen by eye; docs/performance, "Soft maps", lists what these and the other constants of soft maps achieve.
# Weight of marked points relative to signatures. Marked points are weighted by 1 / (0.1 + d)^2 with the distance d;
# differences of distances are relative to the distance, or to 0.05 if that is larger.
_MARKS, _NEARNESS, _SHORT = 3.0, 0.1, 0.05
# Scale of the total, whose parts have a median of one.
_SCALE = 0.25
# Functions for fitting spectral maps: every fifth energy, and Gaussians of these widths around marked points, with
# their weight.
_EVERY, _WIDTHS, _BELLS = 5, (0.1, 0.2, 0.4), 3.0
# Wave kernels are sums of squares; values below this are rounding errors.
_TINY = 1e-9


@dataclass(frozen=True)
class ShapeDescriptors:
    """Descriptors of the vertices of one surface.

    Attributes
    ----------
    spectrum : Spectrum
    signature : (n, e) float32
        Wave kernel signature.
    distances : (k, n) float32
        Distances to the marked points, on the surface of unit area; unreachable points get the largest distance.
    descriptors : (n, d) float64
        Functions for fitting a spectral map.
    """

    spectrum: Spectrum
    signature: NDArray[np.float32]
    distances: NDArray[np.float32]
    descriptors: NDArray[np.float64]


def shape_descriptors(shape: UnitShape, marked: NDArray[np.int64], groups: NDArray[np.float64]) -> ShapeDescriptors:
    """Compute the descriptors of a surface.

    Parameters
    ----------
    shape : UnitShape
    marked : (k,) int64
        Marked vertices.
    groups : (g, n) float64
        Painted weights.
    """
    modes = spectrum(shape.laplacian, _FUNCTIONS)
    signature = _signature(modes)
    away = surface_distances(shape.graph, marked)
    finite = np.isfinite(away)
    away = np.where(finite, away, away[finite].max(initial=1.0))
    descriptors = [_unit(signature[:, ::_EVERY], modes.areas)]
    bells = np.array([np.exp(-0.5 * np.square(away / width)) for width in _WIDTHS]).reshape(-1, len(modes.areas))
    for functions in (bells, groups):
        if len(functions):
            descriptors.append(_BELLS * _unit(functions.T, modes.areas))
    return ShapeDescriptors(
        modes, signature.astype(np.float32), away.astype(np.float32), np.concatenate(descriptors, axis=1)
    )


def differences(source: ShapeDescriptors, target: ShapeDescriptors) -> NDArray[np.float32]:
    """Return the descriptor differences of all pairs of points, (n0, n1)."""
    total = _relative(_signature_differences(source.signature, target.signature))
    if len(source.distances):
        total += np.float32(_MARKS) * _relative(_distance_differences(source.distances, target.distances))
    total *= np.float32(_SCALE)
    return total


def _signature(modes: Spectrum) -> NDArray[np.float64]:
    try:
        return wave_kernel_signature(modes, _ENERGIES)
    except ValueError:
        # Disconnected triangles have no information.
        return np.zeros((len(modes.areas), _ENERGIES))


def _unit(functions: NDArray[np.float64], areas: NDArray[np.float64]) -> NDArray[np.float64]:
    """Scale functions, (n, d), such that their sum has a mean square of one."""
    norms = np.sqrt(areas @ np.square(functions))
    return functions / (np.maximum(norms, _TINY) * np.sqrt(functions.shape[1]))


def _relative(values: NDArray[np.float32]) -> NDArray[np.float32]:
    middle = np.median(values[:: max(1, len(values) // 200)])
    if middle > 0:
        values /= middle
    return values


def _signature_differences(source: NDArray[np.float32], target: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return sums of |a - b| / (a + b) over energies (Aubry et al. 2011), (n0, n1)."""
    total = np.zeros((len(source), len(target)), np.float32)
    for here, there in zip(source.T + np.float32(_TINY), target.T + np.float32(_TINY), strict=True):
        sums = here[:, None] + there
        difference = here[:, None] - there
        np.abs(difference, out=difference)
        difference /= sums
        total += difference
    return total


def _distance_differences(source: NDArray[np.float32], target: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return weighted means of squared relative differences over marked points, (n0, n1)."""
    weights = np.float32(1.0) / np.square(np.float32(_NEARNESS) + source)
    weights /= weights.sum(axis=0)
    total = np.zeros((source.shape[1], target.shape[1]), np.float32)
    for here, there, weight in zip(source, target, weights, strict=True):
        difference = here[:, None] - there
        difference /= np.float32(_SHORT) + np.float32(0.5) * (here[:, None] + there)
        np.square(difference, out=difference)
        difference *= weight[:, None]
        total += difference
    return total
