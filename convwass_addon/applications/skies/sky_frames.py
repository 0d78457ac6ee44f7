# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Skies between two: lamps move along great circles, their glow is transported, the rest fades."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import InputError
from ...transport import Inputs, KernelTooNarrowError, Sphere
from ...transport.barycenter import Barycenter, barycenter
from ...transport.domain import LOG_NOTHING
from ...transport.sphere import directions
from .lamps import Lamp, matched, split_lamps
from .sky_images import LUMINANCE, add_disc, enlarged, great_circle, light_of, shrunk
from .sky_settings import SkySettings

# Within this share of the way from an end its glow goes over into what it is there exactly.
_END = 0.2
# Above the horizon glow comes up within so many degrees; with more a band of it would stay behind.
_HORIZON = 0.7
# What keeps the color of a glow defined where there is hardly any, as a share of the brightest.
_FAINT = 1e-4


@dataclass(frozen=True)
class SkyFrame:
    """A sky between two.

    Attributes
    ----------
    time : float
        0 the first, 1 the second.
    image : (rows, columns, 3) float32
        Radiance, the top row at the zenith; column j looks to the longitude (j + 1/2) 360 degrees / columns.
    lamps : tuple of Lamp
        Where the suns are, and how bright.
    record : dict
        Figures ready for JSON: lamps, energy, how the glow's transport went.
    """

    time: float
    image: NDArray[np.float32]
    lamps: tuple[Lamp, ...]
    record: dict[str, object]


class Skies:
    """Two skies, prepared once for any time between them.

    Parameters
    ----------
    first, second : (rows, columns, 3)
        Equirectangular pictures of linear radiance, equally large, twice as wide as high; the top row first. The rows
        must be a multiple of `settings.rows`.
    settings : SkySettings
        How.

    Raises
    ------
    InputError
        Pictures of other or different sizes, without any light, or with values that are no light.
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
        self._glow = _glows([rest for _, rest in split], self.lamps, self.settings)
        self._still = [rest - glow for (_, rest), glow in zip(split, self._glow, strict=True)]
        self.domain = Sphere(self.settings.rows, self.settings.sigma)
        self._colors = [shrunk(np.maximum(glow, 0.0), self.settings.rows) for glow in self._glow]

    @property
    def has_glow(self) -> bool:
        """Whether both skies have a glow that can travel from one to the other."""
        return all(color.any() for color in self._colors)

    @cached_property
    def _tints(self) -> list[NDArray[np.float64]]:
        """Color of the glow over its luminance, (rows, columns, 3)."""
        raised = [color + _FAINT * (color @ LUMINANCE).max() for color in self._colors]
        return [color / (color @ LUMINANCE)[..., None] for color in raised]

    @cached_property
    def _inputs(self) -> Inputs:
        return Inputs.of(np.stack([color @ LUMINANCE for color in self._colors]), self.domain)

    @cached_property
    def _corrections(self) -> list[NDArray[np.float64]]:
        """What the transported glow lacks of the true one at both ends."""
        return [glow - self._travelled(float(end))[0] for end, glow in enumerate(self._glow)]

    def frame(self, time: float) -> SkyFrame:
        """Interpolate at a time in [0, 1]; the ends are the skies themselves.

        Raises
        ------
        InputError
            A time beyond the ends, or a glow that is too far from the other for the blur.
        """
        if not 0 <= time <= 1:
            raise InputError("The time of a sky must lie between 0 and 1.")
        if time in (0, 1):
            end = int(time)
            return SkyFrame(float(time), self._ends[end].astype(np.float32), self.lamps[end], self._record(time, None))
        image = (1.0 - time) * self._still[0] + time * self._still[1]
        glow, solved = self._travelled(time) if self.has_glow else (self._faded(time), None)
        image += glow
        if solved is not None:
            for correction, away in zip(self._corrections, (time, 1.0 - time), strict=True):
                image += max(0.0, 1.0 - away / _END) ** 2 * correction
        np.maximum(image, 0.0, out=image)
        lamps = self._lamps_at(time)
        # Clipping adds light: what is left of the two skies' own is scaled back.
        want = sum(w * light_of(own) for w, own in zip((1.0 - time, time), self._ends, strict=True))
        lit = sum((lamp.flux for lamp in lamps), np.zeros(3))
        have = light_of(image)
        image *= np.where(have > 0, np.maximum(want - lit, 0.0) / np.where(have > 0, have, 1.0), 1.0)
        for lamp in lamps:
            add_disc(image, lamp.direction, lamp.flux, lamp.radius)
        return SkyFrame(float(time), image.astype(np.float32), lamps, self._record(time, solved))

    def _lamps_at(self, time: float) -> tuple[Lamp, ...]:
        lamps = []
        for move in self._moves:
            first, second = move.first or move.second, move.second or move.first
            flux = (1.0 - time) * move.first_share * first.flux + time * move.second_share * second.flux
            direction = great_circle(first.direction, second.direction, time)
            lamps.append(Lamp(direction, flux, (1.0 - time) * first.radius + time * second.radius))
        return tuple(lamps)

    def _faded(self, time: float) -> NDArray[np.float64]:
        return (1.0 - time) * self._glow[0] + time * self._glow[1]

    def _travelled(self, time: float) -> tuple[NDArray[np.float64], Barycenter]:
        """Glow as a distribution on the way, its color carried by the plans, with the light that the mix has."""
        weights = np.array([1.0 - time, time])
        try:
            solved = barycenter(
                self._inputs,
                weights,
                self.domain,
                sharpness=self.settings.sharpness,
                tolerance=self.settings.tolerance,
            )
        except KernelTooNarrowError as problem:
            raise InputError("The glows are too far apart for this blur; blur the glow more.") from problem
        tint = sum(
            weights[index] * self._carried(log_v, index)
            for log_v, index in zip(solved.log_v, solved.active, strict=True)
        )
        colored = solved.density[..., None] * tint
        glow = np.stack([enlarged(colored[..., c], *self.shape) for c in range(3)], axis=-1)
        glow *= _above(self.shape)[..., None]
        want = sum(w * light_of(own) for w, own in zip(weights, self._glow, strict=True))
        return glow * (want / np.maximum(light_of(glow), np.finfo(float).tiny)), solved

    def _carried(self, log_v: NDArray[np.float64], index: int) -> NDArray[np.float64]:
        """Mean color of the input's light that comes to every place: H(w c) / H(w), w = mu / H(v)."""
        reached = np.empty(self.domain.shape)
        self.domain.log_apply(log_v, reached)
        mu = self._inputs.levels[-1].regions[index].scatter(self._inputs.levels[-1].log_mus[index], LOG_NOTHING)
        known = (mu > LOG_NOTHING / 2) & (reached > LOG_NOTHING / 2)
        log_w = np.where(known, mu - reached, LOG_NOTHING)
        columns = np.concatenate([log_w[None], log_w + np.log(np.moveaxis(self._tints[index], -1, 0))])
        self.domain.log_apply(columns, columns)
        there = columns[0] > LOG_NOTHING / 2
        means = np.exp(np.where(there, columns[1:] - columns[0], 0.0))
        return np.moveaxis(means, 0, -1)

    def _record(self, time: float, solved: Barycenter | None) -> dict[str, object]:
        lamps = self.lamps[int(time)] if time in (0, 1) else self._lamps_at(time)
        return {
            "time": float(time),
            "settings": self.settings.as_dict(),
            "lamps": [lamp.record() for lamp in lamps],
            "transport": None if solved is None else solved.record(),
        }


def _glows(
    rests: list[NDArray[np.float64]], lamps: tuple[tuple[Lamp, ...], ...], settings: SkySettings
) -> list[NDArray[np.float64]]:
    """Return what each sky has more than the other, around its brightest lamp and above the horizon."""
    if not all(lamps):
        return [np.zeros_like(rest) for rest in rests]
    height, width = rests[0].shape[:2]
    vectors = directions(height, width)
    medians = [float(np.median((rest @ LUMINANCE)[: height // 2])) for rest in rests]
    ratio = medians[0] / medians[1] if min(medians) > 0 else 1.0
    common = np.minimum(rests[0], ratio * rests[1])
    glows = []
    for rest, shared, own in ((rests[0], common, lamps[0]), (rests[1], common / ratio, lamps[1])):
        angle = np.degrees(np.arccos(np.clip(vectors @ own[0].direction, -1.0, 1.0)))
        far = np.clip((angle - settings.near) / (settings.far - settings.near), 0.0, 1.0)
        window = (1.0 - far * far * (3.0 - 2.0 * far)) * _above((height, width))
        glows.append(np.maximum(rest - shared, 0.0) * window[..., None])
    return glows


def _above(shape: tuple[int, int]) -> NDArray[np.float64]:
    """0 below the horizon, 1 a little above it, (rows, 1)."""
    elevation = 90.0 - (np.arange(shape[0]) + 0.5) * (180.0 / shape[0])
    return np.clip(elevation / _HORIZON, 0.0, 1.0)[:, None]


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
