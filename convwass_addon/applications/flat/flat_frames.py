# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Finished blends of flat shapes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...geometry.plane.outlines import Outline
from ...one_line import one_line
from ..morphs.layouts import Blend
from .flat_origins import FlatOrigins, MovedOrigins


@dataclass(frozen=True)
class FlatDensity:
    """A density as an image.

    Attributes
    ----------
    values : (nx, ny) float32
        Columns from left to right, rows from the bottom up. The sum of all values, times the area of a pixel, is the
        mass: where the inputs are 1, values are about 1.
    pixel : float
        Size of a pixel in scene units.
    corner : (float, float)
        Position of the lower left corner.
    """

    values: NDArray[np.float32]
    pixel: float
    corner: tuple[float, float]

    __repr__ = one_line("values", "pixel", "corner")


@dataclass(frozen=True)
class ColoredOutline:
    """The part of a blend that has one color.

    Attributes
    ----------
    outline : Outline
        Its outline in the plane, scene units.
    color : (float, float, float, float)
        Red, green, blue, opacity, linear.
    layers : dict of int to int
        The layer that it comes from, for every input of positive weight.
    """

    outline: Outline
    color: tuple[float, float, float, float]
    layers: dict[int, int]


@dataclass(frozen=True)
class FlatFrame:
    """A finished blend of flat shapes.

    Attributes
    ----------
    blend : Blend
        Its weights and place.
    outline : Outline or None
        Regions in the plane, each an outer ring and its holes, in scene units, with a point per cell that they pass.
        None for an unblended input, and if densities are requested.
    density : FlatDensity or None
        Only if densities are requested; also for inputs.
    record : dict
        The solver's figures, the level, the wanted and actual area, regions and holes; ready for JSON.
    origins : FlatOrigins, MovedOrigins or None
        Gives the origins on every input for points of the blend.
    regions : tuple of ColoredOutline
        The differently colored parts of the outline, largest first; empty if there is only one color.
    """

    blend: Blend
    outline: Outline | None
    record: dict[str, object]
    density: FlatDensity | None = None
    origins: FlatOrigins | MovedOrigins | None = None
    regions: tuple[ColoredOutline, ...] = ()

    __repr__ = one_line("blend", "outline", "density", "regions")
