# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Extract the surface of a shape from its density, and report what the surface leaves out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from functools import reduce

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from ...errors import InputError
from ...geometry.grids.boxes import Box, box_around
from ...geometry.level_sets.connectivity import Connectivity
from ...geometry.level_sets.even_surface import even_surface
from ...geometry.level_sets.face_size import with_face_size
from ...geometry.level_sets.handle_removal import GENTLE, Effort
from ...geometry.level_sets.isosurface import LevelSurface, level_enclosing, surface_at_level, surface_enclosing
from ...geometry.level_sets.mending import Mending, mended_surface
from ...geometry.level_sets.thin_parts import locally_normalized, lost_parts
from ...geometry.solids.surface_bounds import SurfaceBounds, cells_changed
from ...progress import UNINTERRUPTED, Control
from .coinciding_solids import CoincidingSolids
from .morph_settings import MorphSettings

EXTRACTION_BLUR = 0.7
"""Blur of a density before its surface is extracted, standard deviation in cells.

It is finer than a shape's representation on the grid, and enough to remove fragments and false handles of the size of a
cell. The enclosed volume is chosen afterwards.
"""

_EXTRACTION_REACH = 4.0
# Below this fraction of the maximum, a density counts as zero.
_NEGLIGIBLE = 1e-7
# Limits are applied at most so many times, until the level changes by less than this fraction.
_LEVELS, _SAME_LEVEL = 3, 0.03
# Mass that a blur moves out of a surface stays within this many of its standard deviations.
_REACH = 3.0


@dataclass(frozen=True)
class Extraction:
    """A surface extracted from a density.

    Attributes
    ----------
    surface : LevelSurface
        In cells.
    record : dict
        Figures of the surface, its repairs and what it leaves out, ready for JSON.
    """

    surface: LevelSurface
    record: dict[str, object]


@dataclass(frozen=True)
class LevelDensity:
    """A density prepared for surface extraction, and the level of the surface.

    Attributes
    ----------
    density : (mx, my, mz) float32
        Restricted to a box of the grid that holds all of it.
    low : (3,) int64
        First cell of the box.
    level : float
        Density on the surface.
    volume : float
        Volume enclosed by the surface, in cells.
    """

    density: NDArray[np.float32]
    low: NDArray[np.int64]
    level: float
    volume: float


def level_density(
    density: NDArray[np.floating], volume: float, settings: MorphSettings, solids: CoincidingSolids | None = None
) -> LevelDensity:
    """Prepare a density and find the level of its surface, without repairs; parameters as for `extract_surface`."""
    prepared = _Prepared.of(density, volume, settings)
    if settings.level == "half-max":
        surface = surface_at_level(prepared.density, float(prepared.density.max()) / 2)
        return LevelDensity(prepared.density, prepared.low, surface.level, surface.mesh.volume)
    if solids is not None:
        prepared = prepared.mixed_with(solids)
    level = surface_enclosing(prepared.density, prepared.volume).level
    return LevelDensity(prepared.density, prepared.low, level, prepared.volume)


def estimated_level_density(density: NDArray[np.floating], volume: float, settings: MorphSettings) -> LevelDensity:
    """Return :func:`level_density` with an estimated level, which needs no surface and takes half of the time."""
    if settings.level == "half-max":
        return level_density(density, volume, settings)
    prepared = _Prepared.of(density, volume, settings)
    return LevelDensity(prepared.density, prepared.low, level_enclosing(prepared.density, volume), volume)


@dataclass(frozen=True)
class Constraint:
    """Constraints on the surface of a blend besides its density.

    Attributes
    ----------
    effort : Effort
        How much may change to remove handles.
    bounds : SurfaceBounds or None
        Limits for the position of the surface.
    """

    effort: Effort = GENTLE
    bounds: SurfaceBounds | None = None


UNCONSTRAINED = Constraint()


def own_surface(occupancy: NDArray[np.floating], settings: MorphSettings) -> LevelSurface:
    """Extract the surface of a shape from its occupancy, in the same way as for blends."""
    volume = float(occupancy.sum(dtype=np.float64))
    prepared = _Prepared.of(occupancy, volume, settings)
    return prepared.placed(surface_enclosing(prepared.density, volume))


def connectivity_of(occupancy: NDArray[np.floating], settings: MorphSettings) -> Connectivity:
    """Count pieces, handles and bubbles of the surface extracted from an occupancy."""
    return Connectivity.of(own_surface(occupancy, settings))


def extract_surface(
    density: NDArray[np.float64],
    volume: float,
    sigma: float,
    shapes: Sequence[Connectivity],
    settings: MorphSettings,
    solids: CoincidingSolids | None = None,
    constraint: Constraint = UNCONSTRAINED,
    control: Control = UNINTERRUPTED,
) -> Extraction:
    """Extract the surface of a blend.

    Parameters
    ----------
    density : (nx, ny, nz) float64
        The barycenter.
    volume : float
        Volume that it should enclose, in cells.
    sigma : float
        The solver's blur in cells.
    shapes : sequence of Connectivity
        Connectivity of the blended shapes: a blend gets at most as many pieces, handles and bubbles as the shape that
        has most.
    settings : MorphSettings
        Determines the level, whether thin parts are kept, and whether the surface is repaired.
    solids : CoincidingSolids, optional
        The shapes, if they have been moved onto each other: where they coincide, their mean replaces the barycenter.
    constraint : Constraint
        Further constraints, applied during repair.
    control : Control
        Stops the work when cancelled.
    """
    if settings.level == "half-max":
        surface = surface_at_level(density, float(density.max()) / 2)
        lost = lost_parts(density, density > surface.level, _REACH * sigma)
        return Extraction(
            with_face_size(even_surface(surface, density), density, settings.face_size, control),
            {"found": asdict(Connectivity.of(surface)), "lost": lost.record()},
        )
    prepared = _Prepared.of(density, volume, settings)
    if solids is not None:
        prepared = prepared.mixed_with(solids)
    extracted = _Repairs(shapes, settings, constraint, control).mended(prepared)
    # Repairs on a coarse grid may raise the level above all of the density that they started from.
    level = min(extracted.surface.level, float(np.nextafter(prepared.density.max(), np.float32(0.0))))
    shown = prepared.density > level
    lost = lost_parts(density[prepared.box], shown, _REACH * sigma).moved(prepared.low)
    return Extraction(prepared.placed(extracted.surface), {**extracted.record, "lost": lost.record()})


def extract_coinciding(
    solids: CoincidingSolids,
    volume: float,
    shapes: Sequence[Connectivity],
    settings: MorphSettings,
    constraint: Constraint = UNCONSTRAINED,
    control: Control = UNINTERRUPTED,
) -> Extraction:
    """Extract the surface of the mean of solids that coincide everywhere; see :func:`extract_surface`."""
    whole = tuple(slice(0, n) for n in solids.density.shape)
    prepared = _Prepared(solids.density, whole, 1.0, volume + solids.surplus)
    return _Repairs(shapes, settings, constraint, control).mended(prepared)


@dataclass(frozen=True)
class _Repairs:
    """How the surface of a blend is repaired; see :func:`extract_surface`."""

    shapes: Sequence[Connectivity]
    settings: MorphSettings
    constraint: Constraint
    control: Control

    def mended(self, prepared: _Prepared) -> Extraction:
        """Return the surface in the box of a density, repaired as the settings demand."""
        density, volume = prepared.density, prepared.volume
        if not self.settings.mend:
            surface = surface_enclosing(density, volume)
            even = with_face_size(even_surface(surface, density), density, self.settings.face_size, self.control)
            return Extraction(even, {"found": asdict(Connectivity.of(surface))})
        most = reduce(Connectivity.or_more, self.shapes)
        if self.constraint.bounds is None:
            return self._sized(mended_surface(density, volume, most, self.constraint.effort, self.control))
        # What the limits change is repaired once more, so that little effort is enough before.
        return self._limited(prepared, mended_surface(density, volume, most, control=self.control), most)

    def _limited(self, prepared: _Prepared, free: Mending, most: Connectivity) -> Extraction:
        """Return a repaired surface that is limited by a constraint; repairs may extend beyond the limits."""
        level, volume = free.surface.level, prepared.volume
        for _ in range(_LEVELS):
            limited = self.constraint.bounds.limited(free.density, level, prepared.box)
            held = cells_changed(free.density, limited, level)
            if not held:
                return self._sized(free, held=0, held_share=0.0)
            share = float(np.count_nonzero((limited > level) != (free.density > level)) / volume)
            if np.count_nonzero(limited) <= volume:
                # A thin part that moves by more than its width is beyond all limits.
                return self._sized(free, held=held, held_share=share)
            # What the limits change also changes the level, which moves the limited surface.
            before, level = level, level_enclosing(limited, volume)
            if abs(level - before) <= _SAME_LEVEL * before:
                break
        mending = mended_surface(limited, volume, most, self.constraint.effort, self.control)
        return self._sized(mending, held=held, held_share=share)

    def _sized(self, mending: Mending, **figures: float) -> Extraction:
        """Return a repaired surface with triangles of the wanted size, and further figures for its record."""
        surface = with_face_size(mending.surface, mending.density, self.settings.face_size, self.control)
        return Extraction(surface, {**mending.record(), **figures})


@dataclass(frozen=True)
class _Prepared:
    """A density in the form from which its surface is extracted.

    Attributes
    ----------
    density : (mx, my, mz) float32
        Restricted to a box, in the unit given below.
    box : Box
        The box on the density's grid.
    unit : float
        One, or the maximum of the density.
    volume : float
        Volume that the surface should enclose, in cells.
    """

    density: NDArray[np.float32]
    box: Box
    unit: float
    volume: float

    @classmethod
    def of(cls, density: NDArray[np.floating], volume: float, settings: MorphSettings) -> _Prepared:
        # Sums of very large or very small densities may overflow or vanish, especially in single precision.
        peak = float(density.max())
        if not 0.0 < peak < np.inf:
            raise InputError("A density without mass has no surface.")
        box = box_around(density > _NEGLIGIBLE * peak, int(np.ceil(_EXTRACTION_REACH * EXTRACTION_BLUR)))
        blurred = gaussian_filter((density[box] / peak).astype(np.float32), EXTRACTION_BLUR, truncate=_EXTRACTION_REACH)
        if settings.thin_parts:
            return cls(locally_normalized(blurred, volume), box, 1.0, volume)
        return cls(blurred, box, peak, volume)

    def mixed_with(self, solids: CoincidingSolids) -> _Prepared:
        """Replace the density by the mean of solids where they coincide."""
        density = solids.mixed(self.density, self.box)
        return replace(self, density=density, volume=self.volume + solids.surplus)

    @property
    def low(self) -> NDArray[np.int64]:
        return np.array([span.start for span in self.box])

    def placed(self, surface: LevelSurface) -> LevelSurface:
        """Convert a surface from the coordinates of the box to those of the grid."""
        return LevelSurface(surface.mesh.moved(self.low), surface.level * self.unit)
