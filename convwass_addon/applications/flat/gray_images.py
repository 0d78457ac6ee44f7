# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Simple ways to turn a blurred density into an image (Solomon et al. 2015, Fig. 13): grays, a threshold, colors."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...geometry.polylines import along_polyline
from .flat_frames import FlatDensity, FlatFrame


def regraded(frame: FlatFrame, ends: Sequence[FlatDensity]) -> FlatDensity:
    """Give the density of a blend the gray values of the inputs, keeping the order of its pixels from dark to bright.

    The brightest pixel gets the weighted mean of the inputs' brightest pixels, the second brightest that of the second
    brightest, and so on: the barycenter of their histograms.

    Parameters
    ----------
    frame : FlatFrame
        A blend with a density.
    ends : sequence of FlatDensity
        Densities of all unblended inputs, from the same morph.

    Raises
    ------
    InputError
        The frame has no density, or the densities belong to another morph.
    """
    if frame.density is None:
        raise InputError("These frames have outlines only; make them again as densities.")
    values = frame.density.values
    if len(ends) != len(frame.blend.weights) or any(end.values.shape != values.shape for end in ends):
        raise InputError("The densities of the inputs must come from the same morph.")
    grays = sum(weight * np.sort(end.values, axis=None) for weight, end in zip(frame.blend.weights, ends, strict=True))
    result = np.empty(values.size, np.float32)
    result[np.argsort(values, axis=None, kind="stable")] = grays
    return FlatDensity(result.reshape(values.shape), frame.density.pixel, frame.density.corner)


def colored(
    values: NDArray[np.floating], stops: Sequence[float], colors: Sequence[Sequence[float]]
) -> NDArray[np.float64]:
    """Map gray values to colors by interpolation between stops.

    Parameters
    ----------
    values : (nx, ny)
        Gray values of a density.
    stops : (s,)
        Gray values of the stops, increasing.
    colors : (s, c)
        Colors of the stops; beyond the first and last stop, their colors are used.

    Returns
    -------
    (nx, ny, c) float64

    Raises
    ------
    InputError
        Stops that do not increase, or a wrong number of colors.
    """
    places, channels = np.asarray(stops, dtype=np.float64), np.asarray(colors, dtype=np.float64)
    if places.ndim != 1 or channels.ndim != 2 or len(places) != len(channels) or (np.diff(places) <= 0).any():
        raise InputError("A color ramp needs rising stops with a color each.")
    return along_polyline(values, places, channels)
