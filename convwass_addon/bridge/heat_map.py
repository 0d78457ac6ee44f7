# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The colors of heat maps, for materials, color attributes and nodes."""

from __future__ import annotations

import bpy
import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..geometry.plane.polylines import along_polyline
from .scene_colors import scene_of_srgb

# Perceptually uniform from dark to bright; sRGB.
_STOPS = ("1a1423", "3b1f52", "6b2569", "a32d63", "d5474b", "f0752f", "f8b13e", "fbf2b5")


def heat_stops() -> NDArray[np.float64]:
    """Return the colors at even steps from 0 to 1, scene linear RGBA, (k, 4)."""
    srgb = np.array([[int(stop[place : place + 2], 16) for place in (0, 2, 4)] for stop in _STOPS]) / 255.0
    linear = scene_of_srgb(srgb)
    return np.concatenate([linear, np.ones((len(linear), 1))], axis=1)


def heat_colors(values: ArrayLike) -> NDArray[np.float64]:
    """Return the heat map colors of values, (n,), as scene linear RGBA, (n, 4); values are clamped to 0 ... 1."""
    stops = heat_stops()
    places = np.linspace(0.0, 1.0, len(stops))
    return along_polyline(values, places, stops)


def fill_ramp(ramp: bpy.types.ColorRamp) -> None:
    """Set a color ramp to the colors of `heat_colors`."""
    stops = heat_stops()
    ramp.interpolation = "LINEAR"
    # A new ramp has two elements, at its ends.
    for place in np.linspace(0.0, 1.0, len(stops))[1:-1]:
        ramp.elements.new(float(place))
    for element, color in zip(ramp.elements, stops, strict=True):
        element.color = color
