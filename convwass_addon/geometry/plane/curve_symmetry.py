# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Axes about which closed curves are mirror images of themselves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .closed_curves import ClosedCurve

# Number of samples of a curve. With 256, the axis of an M is off by three degrees.
_SAMPLES = 4096
# Largest root mean square distance of a curve from its mirror image, relative to its radius.
_DEVIATION = 0.03
# A sharp corner this close to an end of an axis, relative to the length of the curve, is that end.
_AT_END = 0.004


@dataclass(frozen=True)
class MirrorAxes:
    """Axes of a closed curve through its center.

    Attributes
    ----------
    places : (k, 2) float64
        Places at which each axis crosses the curve, the one in its direction first.
    angles : (k,) float64
        Direction of each axis in radians.
    is_best : (k,) bool
        Whether the curve deviates more from its mirror images about the neighboring axes.
    """

    places: NDArray[np.float64]
    angles: NDArray[np.float64]
    is_best: NDArray[np.bool_]

    @classmethod
    def of(cls, curve: ClosedCurve, center: NDArray[np.float64], corners: NDArray[np.float64]) -> MirrorAxes:
        """Find the axes of a curve.

        Uniform samples z_k of a symmetric curve, as complex numbers, satisfy z_(c - k) = exp(2 i a) conj(z_k), where
        a is the angle of the axis and c / 2 the index at which it crosses the curve. All c are tried at once: the sum
        of z_k z_(c - k) is a convolution.

        Parameters
        ----------
        curve : ClosedCurve
            The curve.
        center : (2,)
            The point that every axis passes through.
        corners : (m,)
            Places of its sharp corners, which axes pass through exactly if they pass close by.
        """
        points = curve.at(np.arange(_SAMPLES) * (curve.length / _SAMPLES)) - center
        samples = points[:, 0] + 1j * points[:, 1]
        sums = np.fft.ifft(np.square(np.fft.fft(samples)))
        total = float(np.square(np.abs(samples)).sum())
        deviations = np.sqrt(np.maximum(2.0 * (total - np.abs(sums)), 0.0) / total)
        chosen = np.flatnonzero(deviations <= _DEVIATION)
        least = np.minimum(np.roll(deviations, 1), np.roll(deviations, -1))
        spacing = curve.length / _SAMPLES
        ends = np.stack([0.5 * chosen, 0.5 * (chosen + _SAMPLES)], axis=1) * spacing
        nearest = curve.to_nearest(ends, corners)
        ends = np.where(np.abs(nearest) <= _AT_END * curve.length, ends + nearest, ends)
        crossings = curve.at(ends.ravel()).reshape(-1, 2, 2)
        along = crossings[:, 0] - crossings[:, 1]
        return cls(ends, np.arctan2(along[:, 1], along[:, 0]), deviations[chosen] <= least[chosen])
