# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Monotone maps between closed curves."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

from .closed_curves import ClosedCurve

# Matched places between corners are fitted by a smooth curve through this many points per round, and maps are linear
# between this many places per round.
_KNOTS, _PLACES = 12, 320
# Places this close to each other, relative to the length of the curve, are the same.
_SAME = 1e-6


@dataclass(frozen=True)
class CurveMap:
    """A monotone map between two closed curves.

    Attributes
    ----------
    places, images : (k,) float64
        Places on the first curve, increasing over one round, and those on the second curve to which they are mapped.
    lengths : (float, float)
        Lengths of the curves.
    """

    places: NDArray[np.float64]
    images: NDArray[np.float64]
    lengths: tuple[float, float]

    def __call__(self, places: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the places on the second curve to which places on the first one are mapped."""
        rounds = np.floor((places - self.places[0]) / self.lengths[0])
        return np.interp(places - rounds * self.lengths[0], self.places, self.images) + rounds * self.lengths[1]

    def inverse(self) -> CurveMap:
        """Return the inverse map."""
        return CurveMap(self.images, self.places, self.lengths[::-1])


def even_map(one: ClosedCurve, other: ClosedCurve) -> CurveMap:
    """Return the map at constant speed from the first point of a curve to that of another one."""
    return CurveMap(np.array([0.0, one.length]), np.array([0.0, other.length]), (one.length, other.length))


def smooth_map(
    curves: tuple[ClosedCurve, ClosedCurve],
    corners: tuple[NDArray[np.float64], NDArray[np.float64]],
    places: NDArray[np.float64],
    images: NDArray[np.float64],
) -> CurveMap:
    """Return a map that is smooth between corners, because matches of samples run faster and slower in turn.

    Parameters
    ----------
    curves : (ClosedCurve, ClosedCurve)
        The curves.
    corners : (array, array)
        Places of corners of each. Where one of them is matched, its image stays the same.
    places, images : (k,)
        Places on both curves that match, increasing over one round.
    """
    lengths = curves[0].length, curves[1].length
    kept = np.zeros(len(places), bool)
    kept[[0, -1]] = True
    for curve, own, sharp in zip(curves, (places, images), corners, strict=True):
        kept |= np.abs(curve.to_nearest(own, sharp)) < _SAME * curve.length
    rounds = 0.5 * (places / lengths[0] + images / lengths[1])
    knots = np.flatnonzero(kept)
    chosen = [knots]
    for low, high in pairwise(knots):
        count = int((rounds[high] - rounds[low]) * _KNOTS)
        even = np.linspace(rounds[low], rounds[high], count + 2)[1:-1]
        chosen.append(low + np.abs(rounds[low : high + 1] - even[:, None]).argmin(axis=1))
    found = np.unique(np.concatenate(chosen))
    fitted = PchipInterpolator(_three_rounds(places[found], lengths[0]), _three_rounds(images[found], lengths[1]))
    fine = np.unique(np.concatenate([places, np.linspace(places[0], places[-1], _PLACES)]))
    return CurveMap(fine, fitted(fine), lengths)


def _three_rounds(places: NDArray[np.float64], length: float) -> NDArray[np.float64]:
    """Repeat places of one round before and after it."""
    return np.concatenate([places[:-1] - length, places, places[1:] + length])
