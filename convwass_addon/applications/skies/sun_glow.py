# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Separate the glow around suns from a sky, together with its reflection on the ground near the horizon."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

from ...geometry.arrays.steps import smooth_step
from ...transport.sphere import directions
from .lamps import Lamp
from .sky_images import LUMINANCE
from .sky_settings import SkySettings

# Chosen by eye; tests/applications/test_sun_glow.py tests what they achieve.
# Air is brighter towards the horizon: largest factor, and smoothing in degrees.
_MOST_HAZE, _HAZE_DEGREES = 8.0, 0.7
# The reflectance of the ground is measured where the glow above it is at least this fraction of its brightest, as this
# percentile of the pixels, and fades out to this many degrees below the horizon.
_REFLECTING_SHARE, _REFLECTING_PERCENT, _DEEPEST = 0.2, 10.0, 20.0


@dataclass(frozen=True)
class Glow:
    """The glow of a sun.

    Attributes
    ----------
    light : (rows, columns, 3) float64
        Radiance above the horizon; 0 below.
    ground : (rows, columns, 3) float64
        Light on the ground that moves with the glow; 0 above the horizon.
    reflected : (rows, 3) float64
        Ground light as a fraction of the glow right above it; 0 above the horizon.
    haze : (rows,) float64
        Brightness of the sky at every height relative to its median; at least 1.
    """

    light: NDArray[np.float64]
    ground: NDArray[np.float64]
    reflected: NDArray[np.float64]
    haze: NDArray[np.float64]

    def times(self, share: float) -> Glow:
        """Return a fraction of the glow."""
        return replace(self, light=share * self.light, ground=share * self.ground)


def split_glows(
    rests: Sequence[NDArray[np.float64]], suns: Sequence[Sequence[Lamp]], settings: SkySettings
) -> list[list[Glow]]:
    """Find what each sky has in excess of the other around its suns.

    Parameters
    ----------
    rests : two (rows, columns, 3) arrays
        Skies without their suns.
    suns : two sequences of Lamp
        Suns of each sky. Light between several suns is divided.
    settings : SkySettings
        Angular extent of the glows.

    Returns
    -------
    list of list of Glow
        For each sky, one glow per sun.
    """
    height = len(rests[0])
    medians = [float(np.median((rest @ LUMINANCE)[: height // 2])) for rest in rests]
    ratio = medians[0] / medians[1] if min(medians) > 0 else 1.0
    common = np.minimum(rests[0], ratio * rests[1])
    glows = []
    for rest, shared, own in zip(rests, (common, common / ratio), suns, strict=True):
        windows = _windows(own, height, settings)
        excess, haze = np.maximum(rest - shared, 0.0), _haze(rest)
        total = np.maximum(windows.sum(axis=0), np.finfo(float).tiny)
        glows.append(
            [_glow(excess, window / np.maximum(total, 1.0), window / total, haze) for window in windows],
        )
    return glows


def _windows(suns: Sequence[Lamp], height: int, settings: SkySettings) -> NDArray[np.float64]:
    """1 around every sun, 0 far from it, (suns, rows, columns)."""
    vectors = directions(height, 2 * height)
    angles = [np.degrees(np.arccos(np.clip(vectors @ sun.direction, -1.0, 1.0))) for sun in suns]
    return np.array([1.0 - smooth_step(angle, settings.near, settings.far) for angle in angles])


def reflecting(light: NDArray[np.float64], reflected: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the light of the ground below a glow, (rows, columns, 3); see :class:`Glow`."""
    return reflected[:, None] * light[horizon(len(light)) - 1]


def horizon(rows: int) -> int:
    """Return the first row whose center is not above the horizon.

    A gradual transition would leave a bright line at the horizon, because part of the band there would not move.
    """
    return rows // 2


def _glow(
    excess: NDArray[np.float64], window: NDArray[np.float64], part: NDArray[np.float64], haze: NDArray[np.float64]
) -> Glow:
    """Extract the excess in a window, and the ground light, of which the fraction `part` belongs to this sun."""
    start = horizon(len(excess))
    light = excess * window[..., None]
    light[start:] = 0.0
    reflected = _reflected(light[start - 1], excess[start:], part[start:])
    return Glow(light, np.minimum(reflecting(light, reflected), excess * part[..., None]), reflected, haze)


def _reflected(
    above: NDArray[np.float64], excess: NDArray[np.float64], part: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the ground light as a fraction of the glow above it, (rows, 3), with zero rows for the sky.

    Ground far from the sun that is brighter than in the other sky is not a reflection, so its median is subtracted.
    """
    rows = len(excess)
    reflected = np.zeros((2 * rows, 3))
    luminance = above @ LUMINANCE
    counted = luminance > _REFLECTING_SHARE * luminance.max()
    if not counted.any():
        return reflected
    for row, (own, near) in enumerate(zip(excess, part, strict=True)):
        falling = 1.0 - smooth_step((row + 0.5) * (90.0 / rows), 0.0, _DEEPEST)
        if falling <= 0:
            break
        far = near <= 0
        everywhere = np.median(own[far], axis=0) if far.any() else 0.0
        shares = (own[counted] - everywhere) / np.maximum(above[counted], np.finfo(float).tiny)
        reflected[rows + row] = np.clip(np.percentile(shares, _REFLECTING_PERCENT, axis=0), 0.0, 1.0) * falling
    return reflected


def _haze(rest: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the median of every row relative to that of the whole sky; below the horizon, the value just above it."""
    rows = len(rest)
    start = horizon(rows)
    luminance = rest[:start] @ LUMINANCE
    middle = float(np.median(luminance))
    if middle <= 0:
        return np.ones(rows)
    means = gaussian_filter1d(np.median(luminance, axis=1) / middle, _HAZE_DEGREES * rows / 180.0, mode="nearest")
    return np.clip(np.concatenate([means, np.full(rows - start, means[-1])]), 1.0, _MOST_HAZE)
