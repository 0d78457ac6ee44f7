# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Interpolate two skies: lamps move along great circles, their glow is transported, the rest fades."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import InputError
from ...geometry.algebra.quotients import quotients
from ...one_line import one_line
from ...transport.barycenter import Barycenter
from .glow_travel import GlowTravel
from .lamps import Lamp, matched, split_lamps
from .sky_images import LUMINANCE, add_disc, great_circle, light_of
from .sky_settings import SkySettings
from .sun_frames import SunWay
from .sun_glow import split_glows

# Suns that share less than this fraction of the light with each other move without their glow.
_LEAST_MOVE = 0.05


@dataclass(frozen=True)
class SkyFrame:
    """An interpolated sky.

    Attributes
    ----------
    time : float
        0 for the first sky, 1 for the second.
    image : (rows, columns, 3) float32
        Radiance, zenith in the top row; column j shows the longitude (j + 1/2) 360 degrees / columns.
    lamps : tuple of Lamp
        Positions and brightness of the suns.
    record : dict
        JSON-ready figures: lamps, energy, and the solution of the glow's transport.
    """

    time: float
    image: NDArray[np.float32]
    lamps: tuple[Lamp, ...]
    record: dict[str, object]

    __repr__ = one_line("time", "image", "lamps")


class Skies:
    """Two skies, prepared for any time between them.

    Parameters
    ----------
    first, second : (rows, columns, 3)
        Equirectangular pictures of linear radiance, of equal size, twice as wide as high, top row first. The number of
        rows must be a multiple of `settings.rows`.
    settings : SkySettings
        Settings of the interpolation.

    Raises
    ------
    InputError
        Pictures of invalid or different sizes, without any light, or with invalid values.
    """

    def __init__(self, first: ArrayLike, second: ArrayLike, settings: SkySettings | None = None) -> None:
        self.settings = SkySettings() if settings is None else settings
        images = [_checked(image, self.settings.rows) for image in (first, second)]
        if images[0].shape != images[1].shape:
            raise InputError("The skies have different sizes; make them equally large.")
        self._ends = images
        self.shape = images[0].shape[:2]
        split = [split_lamps(image, self.settings) for image in images]
        self.lamps = tuple(tuple(lamps) for lamps, _ in split)
        self._moves = matched(*(lamps for lamps, _ in split))
        self._still = [rest for _, rest in split]
        self._travels = self._travelling()

    def _travelling(self) -> list[GlowTravel]:
        """Separate the glows of suns that turn into one another from the still part."""
        everything = sum(lamp.flux @ LUMINANCE for lamp in self.lamps[0])
        pairs = [
            move
            for move in self._moves
            if move.first is not None
            and move.second is not None
            and move.first_share * (move.first.flux @ LUMINANCE) >= _LEAST_MOVE * everything
        ]
        if not pairs:
            return []
        glows = [
            {id(lamp): glow for lamp, glow in zip(lamps, own, strict=True)}
            for lamps, own in zip(self.lamps, split_glows(self._still, self.lamps, self.settings), strict=True)
        ]
        travels = []
        for move in pairs:
            moving = [
                glows[0][id(move.first)].times(move.first_share),
                glows[1][id(move.second)].times(move.second_share),
            ]
            if all(glow.light.any() for glow in moving):
                self._still = [rest - glow.light - glow.ground for rest, glow in zip(self._still, moving, strict=True)]
                way = SunWay.between(move.first.direction, move.second.direction)
                travels.append(GlowTravel(moving, way, self.settings))
        return travels

    def frame(self, time: float) -> SkyFrame:
        """Interpolate at a time in [0, 1]; the ends return the given skies.

        Raises
        ------
        InputError
            A time outside [0, 1], or glows too far apart for the blur.
        """
        if not 0 <= time <= 1:
            raise InputError("The time of a sky must lie between 0 and 1.")
        if time in (0, 1):
            end = int(time)
            return self._frame(time, self._ends[end], self.lamps[end], [])
        image = (1.0 - time) * self._still[0] + time * self._still[1]
        solved = []
        for travel in self._travels:
            glow, found = travel.at(time)
            image += glow
            solved.append(found)
        np.maximum(image, 0.0, out=image)
        lamps = self._lamps_at(time)
        # Clipping adds light, so scale the result back to the interpolated total.
        want = sum(w * light_of(own) for w, own in zip((1.0 - time, time), self._ends, strict=True))
        lit = sum((lamp.flux for lamp in lamps), np.zeros(3))
        have = light_of(image)
        image *= quotients(np.maximum(want - lit, 0.0), have, 1.0)
        for lamp in lamps:
            add_disc(image, lamp.direction, lamp.flux, lamp.radius)
        return self._frame(time, image, lamps, solved)

    def _lamps_at(self, time: float) -> tuple[Lamp, ...]:
        lamps = []
        for move in self._moves:
            first, second = move.first or move.second, move.second or move.first
            flux = (1.0 - time) * move.first_share * first.flux + time * move.second_share * second.flux
            direction = great_circle(first.direction, second.direction, time)
            lamps.append(Lamp(direction, flux, (1.0 - time) * first.radius + time * second.radius))
        return tuple(lamps)

    def _frame(
        self, time: float, image: NDArray[np.float64], lamps: tuple[Lamp, ...], solved: list[Barycenter]
    ) -> SkyFrame:
        record = {
            "time": float(time),
            "settings": self.settings.as_dict(),
            "lamps": [lamp.record() for lamp in lamps],
            "transport": [found.record() for found in solved],
        }
        return SkyFrame(float(time), image.astype(np.float32), lamps, record)


def require_light(image: ArrayLike, name: str) -> None:
    """Check that a sky has light, and only numbers.

    Parameters
    ----------
    image : (rows, columns, 3)
        Radiance.
    name : str
        Name of the sky in error messages.

    Raises
    ------
    InputError
        The sky is black, or a pixel is not finite.
    """
    values = np.asarray(image)
    if not np.isfinite(values).all():
        raise InputError("The sky of {name} has pixels that are no numbers.", name=name)
    if not (values > 0.0).any():
        raise InputError("The sky of {name} has no light.", name=name)


def _checked(image: ArrayLike, rows: int) -> NDArray[np.float64]:
    values = np.asarray(image, dtype=np.float64)
    if values.ndim != 3 or values.shape[2] != 3 or values.shape[1] != 2 * values.shape[0]:
        raise InputError("A sky must be a picture with three channels that is twice as wide as high.")
    if values.shape[0] < rows or values.shape[0] % rows:
        raise InputError("The height of a sky must be a multiple of {rows} pixels.", rows=rows)
    if not np.isfinite(values).all():
        raise InputError("A sky has pixels that are no numbers.")
    values = np.maximum(values, 0.0)
    if not values.any():
        raise InputError("A sky has no light.")
    return values
