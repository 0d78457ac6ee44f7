# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Suns and lamps of a sky: detection, removal, and matching with those of another sky."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import label, maximum_filter, median_filter

from ...transport.sphere import directions, solid_angles
from .sky_images import LUMINANCE, enlarged, light_of, padded, shrunk
from .sky_settings import SkySettings

# Size of the median filter, and rows of the reduced picture that it is applied to; full size would take minutes.
_ROWS, _PIXELS = 128, 9
# Angular radius of the sun, and the largest radius of a lamp, in radians; larger bright regions are sky.
SUN_RADIUS = float(np.radians(0.2725))
_WIDEST = float(np.radians(6.0))
# Smaller matched fractions are rounding errors.
_NO_SHARE = 1e-9


@dataclass(frozen=True)
class Lamp:
    """A sun or a lamp.

    Attributes
    ----------
    direction : (3,) float64
        Unit vector to its center, +Z up.
    flux : (3,) float64
        Its light: radiance times solid angle, per channel.
    radius : float
        In radians.
    """

    direction: NDArray[np.float64]
    flux: NDArray[np.float64]
    radius: float

    def record(self) -> dict[str, object]:
        """Return the JSON-ready attributes."""
        return {"direction": self.direction.tolist(), "flux": self.flux.tolist(), "radius": self.radius}


@dataclass(frozen=True)
class Move:
    """A lamp of the first sky that becomes a lamp of the second, with fractions of their light; None if missing."""

    first: Lamp | None
    second: Lamp | None
    first_share: float
    second_share: float


def split_lamps(image: NDArray[np.float64], settings: SkySettings) -> tuple[list[Lamp], NDArray[np.float64]]:
    """Detect suns and lamps in a sky and remove them.

    Parameters
    ----------
    image : (rows, 2 rows, 3) float64
        Radiance.
    settings : SkySettings
        Minimum brightness, largest number, and minimum fraction of the light of a lamp.

    Returns
    -------
    tuple
        The lamps, brightest first, and the sky with their surroundings in their place.
    """
    height, width = image.shape[:2]
    surroundings = _surroundings(image)
    luminance = image @ LUMINANCE
    floor = 1e-6 * luminance.max()
    bright = luminance > settings.brightness * np.maximum(surroundings @ LUMINANCE, floor)
    pieces = _labelled(maximum_filter(bright, 3, mode=("nearest", "wrap")))
    areas, vectors = solid_angles(height, width), directions(height, width)
    everything = float(light_of(image) @ LUMINANCE)
    rest, found = image.copy(), []
    for number in range(1, pieces.max() + 1):
        there = pieces == number
        excess = np.maximum(image[there] - surroundings[there], 0.0)
        flux = (areas[there][:, None] * excess).sum(axis=0)
        middle = ((areas[there] * (excess @ LUMINANCE))[:, None] * vectors[there]).sum(axis=0)
        light = float(flux @ LUMINANCE)
        # Broad bright clouds, and specks of a sun behind a hill, are not lamps.
        compact = areas[there & bright].sum() < np.pi * _WIDEST**2
        if light <= 0 or light < settings.least_share * everything or not compact:
            continue
        found.append((light, there, excess, Lamp(middle / np.linalg.norm(middle), flux, _radius(areas, image, there))))
    found.sort(key=lambda entry: -entry[0])
    for _, there, excess, _ in found[: settings.most_lamps]:
        rest[there] -= excess
    return [entry[3] for entry in found[: settings.most_lamps]], rest


def matched(first: list[Lamp], second: list[Lamp]) -> list[Move]:
    """Match lamps by optimal transport of their fractions of the light, with squared angles as costs.

    If only one sky has lamps, they appear or fade in place.
    """
    if not first or not second:
        return [Move(lamp, None, 1.0, 0.0) for lamp in first] + [Move(None, lamp, 0.0, 1.0) for lamp in second]
    own, their = (np.array([lamp.flux @ LUMINANCE for lamp in lamps]) for lamps in (first, second))
    own, their = own / own.sum(), their / their.sum()
    cosines = np.array([[a.direction @ b.direction for b in second] for a in first])
    cost = np.arccos(np.clip(cosines, -1.0, 1.0)) ** 2
    sums = np.concatenate(
        [np.kron(np.eye(len(own)), np.ones(len(their))), np.kron(np.ones(len(own)), np.eye(len(their)))]
    )
    # Imported here: SciPy loads a hundred modules for it, which most sessions do not need.
    from scipy.optimize import linprog

    plan = linprog(cost.ravel(), A_eq=sums[:-1], b_eq=np.concatenate([own, their])[:-1], method="highs").x
    plan = plan.reshape(cost.shape)
    return [
        Move(first[i], second[j], float(plan[i, j] / own[i]), float(plan[i, j] / their[j]))
        for i, j in np.argwhere(plan > _NO_SHARE)
    ]


def _surroundings(image: NDArray[np.float64]) -> NDArray[np.float64]:
    height, width = image.shape[:2]
    rows = _ROWS if height % _ROWS == 0 and height > _ROWS else height
    small = image if rows == height else shrunk(image, rows)
    margin = _PIXELS // 2 + 1
    medians = [median_filter(padded(small[..., c], margin), _PIXELS)[margin:-margin, margin:-margin] for c in range(3)]
    return np.stack([own if rows == height else enlarged(own, height, width) for own in medians], axis=-1)


def _labelled(inside: NDArray[np.bool_]) -> NDArray[np.int32]:
    """Label connected components, also across the seam; labels need not be consecutive."""
    pieces, _ = label(inside, np.ones((3, 3)))
    for left, right in zip(pieces[:, -1], pieces[:, 0], strict=True):
        if left and right and left != right:
            pieces[pieces == left] = right
    return pieces


def _radius(areas: NDArray[np.float64], image: NDArray[np.float64], there: NDArray[np.bool_]) -> float:
    """Radius of the disc with the area of all pixels above half of the largest brightness; at least the sun's."""
    luminance = np.where(there, image @ LUMINANCE, 0.0)
    core = luminance > 0.5 * luminance.max()
    if core.sum() <= 4:
        return SUN_RADIUS
    return float(np.clip(np.sqrt(areas[core].sum() / np.pi), SUN_RADIUS, _WIDEST))
