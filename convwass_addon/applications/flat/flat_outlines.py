# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Outlines of flat shapes and blends, read from how full the cells of the plane are."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from ...geometry.contours import LevelOutline, outline_at_level, outline_enclosing
from ...geometry.flat_mending import FlatConnectivity, FlatMending, mended_outline
from ..morphs.coinciding_solids import CoincidingSolids
from ..morphs.merging import typical_density
from .flat_settings import FlatSettings

# Cells over which a density is averaged before its outline is read, as those of solids are.
_READING_BLUR = 0.7


def own_outline(occupancy: NDArray[np.floating], area: float) -> LevelOutline:
    """Outline of a shape as it can be read from its occupancy, in the way that blends are read."""
    return outline_enclosing(gaussian_filter(occupancy, _READING_BLUR), area)


def prepared_density(
    density: NDArray[np.float64], area: float, solids: CoincidingSolids | None = None
) -> NDArray[np.floating]:
    """Blur the density of a blend as it is read.

    Parameters
    ----------
    density : (nx, ny)
        The barycenter.
    area : float
        In cells, that is going to be enclosed.
    solids : CoincidingSolids, optional
        The mean of moved shapes: where they agree, it takes the place of the barycenter.
    """
    prepared = gaussian_filter(density / density.max(), _READING_BLUR)
    if solids is None:
        return prepared
    # The mean is one half on its outline, and so must the barycenter be.
    level = outline_enclosing(prepared, area).level
    return solids.mixed(prepared * (0.5 / level), (slice(None), slice(None)))


def blend_outline(
    prepared: NDArray[np.floating], area: float, shapes: Sequence[FlatConnectivity], settings: FlatSettings
) -> FlatMending:
    """Outline of a blend that encloses `area` cells, connected as the shapes are that it is made of."""
    if not settings.mend:
        return FlatMending(outline_enclosing(prepared, area), prepared)
    most = shapes[0]
    for other in shapes[1:]:
        most = most.or_more(other)
    return mended_outline(prepared, area, most)


def half_max_outline(density: NDArray[np.floating]) -> FlatMending:
    """Outline at half of the largest density."""
    return FlatMending(outline_at_level(density, float(density.max()) / 2), density)


def filled_area(density: NDArray[np.float64]) -> float:
    """Area in cells of what is at least half as dense as is typical of the blend.

    Its root is never less than that interpolated between the roots of the inputs' areas (Brunn and Minkowski, McCann
    1997), and it is more where the maps stretch: a bar that becomes a bar across is a square halfway, larger than both.
    A level for less would have to cut through what is evenly filled, along noise.
    """
    half = 0.5 * typical_density([density])
    above = density - half
    # Cells that the edge passes through count in part.
    return float(np.clip(above / half + 0.5, 0.0, 1.0).sum())
