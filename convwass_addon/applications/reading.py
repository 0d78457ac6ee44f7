# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Read the surface of a shape from its density, and say what it leaves out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from ..geometry.isosurface import LevelSurface, surface_at_level, surface_enclosing
from ..geometry.mending import Connectivity, mended_surface
from ..geometry.thin_parts import locally_normalized, lost_parts
from .morph_settings import MorphSettings

# Cells over which a density is averaged before its surface is read: less than the grid can show of a shape, and enough
# for crumbs and false handles of a cell's size to vanish. The enclosed volume is chosen afterwards.
_READING_BLUR = 0.7
# Mass that a blur carries out of a surface lies within so many of its standard deviations.
_REACH = 3.0


@dataclass(frozen=True)
class Reading:
    """A surface read from a density.

    Attributes
    ----------
    surface : LevelSurface
        In cells.
    record : dict
        What it has, what was mended and what is not shown, ready for JSON.
    """

    surface: LevelSurface
    record: dict[str, object]


def own_surface(occupancy: NDArray[np.floating], settings: MorphSettings) -> LevelSurface:
    """Surface of a shape as it can be read from its occupancy, in the way that blends are read."""
    density = np.asarray(occupancy, dtype=np.float64)
    return surface_enclosing(_prepared(density, float(density.sum()), settings), float(density.sum()))


def connectivity_of(occupancy: NDArray[np.floating], settings: MorphSettings) -> Connectivity:
    """Pieces, handles and bubbles of a shape as they can be read from its occupancy at this resolution."""
    return Connectivity.of(own_surface(occupancy, settings))


def read_surface(
    density: NDArray[np.float64], volume: float, sigma: float, shapes: Sequence[Connectivity], settings: MorphSettings
) -> Reading:
    """Read the surface of a blend.

    Parameters
    ----------
    density : (nx, ny, nz) float64
        The barycenter.
    volume : float
        Cells that it should enclose.
    sigma : float
        The solver's blur in cells.
    shapes : sequence of Connectivity
        Of the shapes that are blended: a blend has no more pieces, handles and bubbles than the one that has most.
    settings : MorphSettings
        Which level, and whether to keep thin parts and to mend.
    """
    if settings.level == "half-max":
        surface = surface_at_level(density, float(density.max()) / 2)
        lost = lost_parts(density, density > surface.level, _REACH * sigma)
        return Reading(surface, {"found": asdict(Connectivity.of(surface)), "lost": lost.record()})
    prepared = _prepared(density, volume, settings)
    if settings.mend:
        most = shapes[0]
        for other in shapes[1:]:
            most = most.or_more(other)
        mending = mended_surface(prepared, volume, most)
        surface, record = mending.surface, mending.record()
    else:
        surface = surface_enclosing(prepared, volume)
        record = {"found": asdict(Connectivity.of(surface))}
    lost = lost_parts(density, prepared > surface.level, _REACH * sigma)
    return Reading(surface, {**record, "lost": lost.record()})


def _prepared(density: NDArray[np.float64], volume: float, settings: MorphSettings) -> NDArray[np.float64]:
    blurred = gaussian_filter(density, _READING_BLUR)
    return locally_normalized(blurred, volume) if settings.thin_parts else blurred
