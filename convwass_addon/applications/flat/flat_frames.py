# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What a finished blend of flat shapes is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...geometry.outlines import Outline
from ...one_line import one_line
from ..morphs.layouts import Blend
from .flat_origins import FlatOrigins, MovedOrigins


@dataclass(frozen=True)
class FlatDensity:
    """A density as an image.

    Attributes
    ----------
    values : (nx, ny) float32
        Columns from left to right, rows from the bottom up. The sum of all, times the area of a pixel, is the mass:
        what is 1 in the inputs comes out at about 1.
    pixel : float
        Size of a pixel in scene units.
    corner : (float, float)
        Place of the lower left corner.
    """

    values: NDArray[np.float32]
    pixel: float
    corner: tuple[float, float]

    __repr__ = one_line("values", "pixel", "corner")


@dataclass(frozen=True)
class ColoredOutline:
    """What of a blend has one color.

    Attributes
    ----------
    outline : Outline
        Where, in the plane, scene units.
    color : (float, float, float, float)
        Red, green, blue, opacity, linear.
    layers : dict of int to int
        Number of the layer that it comes from, for every input of positive weight.
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
        Which one.
    outline : Outline or None
        Regions, each an outer ring and its holes, in the plane, scene units, dense: a point per cell that it passes.
        None where an input is shown as it is, and where densities were asked for.
    density : FlatDensity or None
        Where densities were asked for; of inputs too.
    record : dict
        The solver's figures, the level, area wanted and reached, regions and holes; ready for JSON.
    origins : FlatOrigins, MovedOrigins or None
        Tells for any points of the blend where on every input their matter comes from.
    regions : tuple of ColoredOutline
        How colors divide the outline, the largest first; empty where all of it has one.
    """

    blend: Blend
    outline: Outline | None
    record: dict[str, object]
    density: FlatDensity | None = None
    origins: FlatOrigins | MovedOrigins | None = None
    regions: tuple[ColoredOutline, ...] = ()

    __repr__ = one_line("blend", "outline", "density", "regions")
