# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Transport the glow of a sun in the sun's own frame, where only its shape has to change."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...transport import Inputs, KernelTooNarrowError, Sphere
from ...transport.barycenter import Barycenter, barycenter
from ...transport.log_range import LOG_NOTHING
from ...transport.sphere import directions
from .sky_images import LUMINANCE, light_of, shrunk
from .sky_settings import SkySettings
from .sun_frames import SunWay, seen_in
from .sun_glow import Glow, horizon, reflecting

# Chosen by eye; tests/applications/test_sun_glow.py tests what they achieve.
# Within this fraction of the path from an end, the glow blends into the exact one.
_END = 0.2
# Within this many degrees of the horizon it blends over a shorter fraction, so that it does not seem to rise from
# there.
_LOW, _LOW_END = 8.0, 0.05
# Number of directions along each side of a cell over which its mean is taken.
_POINTS = 4
# Keeps the color of a very faint glow defined, as a fraction of the brightest.
_FAINT = 1e-4


class GlowTravel:
    """The glows of two suns, prepared for any time between them.

    On a sphere, transport over a long distance widens what it moves, and a glow cut off by the horizon would keep the
    cut while it moves. To avoid both, each glow is rotated with its sun into one frame and divided by the haze of its
    height, and the part hidden by the horizon is mirrored from the other side of the sun. The result is rotated back
    and cut off again.

    Parameters
    ----------
    glows : two Glow
        Both with some light.
    way : SunWay
        Path from the first sun to the second.
    settings : SkySettings
        Settings of the interpolation.
    """

    def __init__(self, glows: Sequence[Glow], way: SunWay, settings: SkySettings) -> None:
        self._glows, self._way, self._settings = tuple(glows), way, settings
        rows, columns = glows[0].light.shape[:2]
        self._seen = directions(rows, columns)[: horizon(rows)]
        self._clear = [_completed(glow, way.frame(float(end))[:, 0]) for end, glow in enumerate(glows)]
        self._domain = Sphere(settings.rows, settings.sigma)
        self._colors = [self._turned(glow, way.frame(float(end))) for end, glow in enumerate(self._clear)]

    def at(self, time: float) -> tuple[NDArray[np.float64], Barycenter]:
        """Return the glow at a time in [0, 1], (rows, columns, 3), with its light on the ground, and the solution."""
        weights = np.array([1.0 - time, time])
        colored, solved = self._transported(weights)
        frame = self._way.frame(time)
        light = seen_in(colored, self._seen @ frame)
        for end, away in enumerate((time, 1.0 - time)):
            if away < _END:
                turn = frame @ self._way.frame(float(end)).T
                light += seen_in(self._details[end] * self._detail_weights(away), self._seen @ turn)
        haze = sum(weight * glow.haze for weight, glow in zip(weights, self._glows, strict=True))
        glow = np.zeros_like(self._glows[0].light)
        glow[: len(light)] = np.maximum(light, 0.0) * haze[: len(light), None, None]
        want = sum(weight * light_of(own.light) for weight, own in zip(weights, self._glows, strict=True))
        glow *= want / np.maximum(light_of(glow), np.finfo(float).tiny)
        reflected = sum(weight * own.reflected for weight, own in zip(weights, self._glows, strict=True))
        glow += reflecting(glow, reflected)
        for own, away in zip(self._glows, (time, 1.0 - time), strict=True):
            if away < _END:
                glow += (1.0 - away / _END) ** 2 * (own.ground - reflecting(own.light, own.reflected))
        return glow, solved

    def _detail_weights(self, away: float) -> NDArray[np.float64]:
        """Return the fraction of the details that remains this far from their end, (rows, 1, 1)."""
        rows = len(self._glows[0].light)
        elevation = 90.0 - (np.arange(rows) + 0.5) * (180.0 / rows)
        high = np.clip(elevation / _LOW, 0.0, 1.0)
        left = high * max(1.0 - away / _END, 0.0) ** 2 + (1.0 - high) * max(1.0 - away / _LOW_END, 0.0) ** 2
        return left[:, None, None]

    @cached_property
    def _details(self) -> list[NDArray[np.float64]]:
        """Difference of the true glow from the transported one at both ends; 0 below the horizon."""
        details = []
        for end, clear in enumerate(self._clear):
            colored, _ = self._transported(np.array([1.0 - end, end]))
            lacking = np.zeros_like(clear)
            start = len(self._seen)
            lacking[:start] = clear[:start] - seen_in(colored, self._seen @ self._way.frame(float(end)))
            details.append(lacking)
        return details

    @cached_property
    def _tints(self) -> list[NDArray[np.float64]]:
        """Color of the glow divided by its luminance, (rows, columns, 3)."""
        raised = [color + _FAINT * (color @ LUMINANCE).max() for color in self._colors]
        return [color / (color @ LUMINANCE)[..., None] for color in raised]

    @cached_property
    def _inputs(self) -> Inputs:
        return Inputs.of(np.stack([color @ LUMINANCE for color in self._colors]), self._domain)

    def _turned(self, glow: NDArray[np.float64], frame: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return means of a glow over the cells of the sphere, in the frame of its sun."""
        rows = _POINTS * self._settings.rows
        return shrunk(seen_in(glow, directions(rows, 2 * rows) @ frame.T), self._settings.rows)

    def _transported(self, weights: NDArray[np.float64]) -> tuple[NDArray[np.float64], Barycenter]:
        """Return the glow in the frame of the sun, with colors moved by the plans and the interpolated total light."""
        try:
            solved = barycenter(
                self._inputs,
                weights,
                self._domain,
                sharpness=self._settings.sharpness,
                tolerance=self._settings.tolerance,
            )
        except KernelTooNarrowError as problem:
            raise InputError("The glows are too far apart for this blur; blur the glow more.") from problem
        tint = sum(
            weights[index] * self._carried(log_v, index)
            for log_v, index in zip(solved.log_v, solved.active, strict=True)
        )
        colored = solved.density[..., None] * tint
        want = sum(weight * light_of(own) for weight, own in zip(weights, self._colors, strict=True))
        return colored * (want / np.maximum(light_of(colored), np.finfo(float).tiny)), solved

    def _carried(self, log_v: NDArray[np.float64], index: int) -> NDArray[np.float64]:
        """Mean color of the input's light that arrives at every cell: H(w c) / H(w), w = mu / H(v)."""
        reached = np.empty(self._domain.shape)
        self._domain.log_apply(log_v, reached)
        level = self._inputs.levels[-1]
        mu = level.regions[index].scatter(level.log_mus[index], LOG_NOTHING)
        known = (mu > LOG_NOTHING / 2) & (reached > LOG_NOTHING / 2)
        log_w = np.where(known, mu - reached, LOG_NOTHING)
        columns = np.concatenate([log_w[None], log_w + np.log(np.moveaxis(self._tints[index], -1, 0))])
        self._domain.log_apply(columns, columns)
        there = columns[0] > LOG_NOTHING / 2
        means = np.exp(np.where(there, columns[1:] - columns[0], 0.0))
        return np.moveaxis(means, 0, -1)


def _completed(glow: Glow, sun: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a glow without haze, with the part below the horizon mirrored from the other side of the sun."""
    clear = glow.light / glow.haze[:, None, None]
    rows, columns = clear.shape[:2]
    start = horizon(rows)
    below = directions(rows, columns)[start:]
    clear[start:] = seen_in(clear, 2.0 * (below @ sun)[..., None] * sun - below)
    return clear
