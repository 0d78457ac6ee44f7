# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Outlines of flat shapes and blends, extracted from densities on a grid."""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from ...geometry.level_sets.contours import LevelOutline, outline_at_level, outline_enclosing
from ...geometry.level_sets.flat_mending import FlatConnectivity, FlatMending, mended_outline
from ..morphs.coinciding_solids import CoincidingSolids
from ..morphs.merging import typical_density
from .flat_settings import FlatSettings

# Blur in cells of a density before its outline is extracted, as for solids.
_READING_BLUR = 0.7


def own_outline(occupancy: NDArray[np.floating], area: float) -> LevelOutline:
    """Extract the outline of a shape from its occupancy, in the same way as for blends."""
    return outline_enclosing(gaussian_filter(occupancy, _READING_BLUR), area)


def prepared_density(
    density: NDArray[np.float64], area: float, solids: CoincidingSolids | None
) -> NDArray[np.floating]:
    """Blur the density of a blend for the extraction of its outline.

    Parameters
    ----------
    density : (nx, ny)
        The barycenter.
    area : float
        The area to enclose, in cells.
    solids : CoincidingSolids or None
        The mean of moved shapes: where they agree, it replaces the barycenter.
    """
    prepared = gaussian_filter(density / density.max(), _READING_BLUR)
    if solids is None:
        return prepared
    # The mean is one half on its outline, so the barycenter must be, too.
    level = outline_enclosing(prepared, area).level
    return solids.mixed(prepared * (0.5 / level), (slice(None), slice(None)))


def blend_outline(
    prepared: NDArray[np.floating], area: float, shapes: Sequence[FlatConnectivity], settings: FlatSettings
) -> FlatMending:
    """Extract the outline of a blend that encloses `area` cells, with the connectivity of the blended shapes."""
    if not settings.mend:
        return FlatMending(outline_enclosing(prepared, area), prepared)
    return mended_outline(prepared, area, reduce(FlatConnectivity.or_more, shapes))


def half_max_outline(density: NDArray[np.floating]) -> FlatMending:
    """Extract the outline at half of the largest density."""
    return FlatMending(outline_at_level(density, float(density.max()) / 2), density)


def filled_area(density: NDArray[np.float64]) -> float:
    """Return the area in cells where the density is at least half of the typical one.

    Its square root is never less than the interpolated square roots of the inputs' areas (Brunn and Minkowski, McCann
    1997), and greater where the maps stretch: a bar that becomes a perpendicular bar is a square halfway, larger than
    both. A level for a smaller area would cut through an evenly filled region, following noise.
    """
    half = 0.5 * typical_density([density])
    above = density - half
    # Cells that the edge passes count in part.
    return float(np.clip(above / half + 0.5, 0.0, 1.0).sum())
