# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Thin parts of a density: normalize it so that one level shows them too, and measure what the surface misses.

A blurred rod or sheet peaks below the density of the solid. A level at half of that density makes it thinner or misses
it entirely. Its volume then goes to the thick parts, because the surface encloses a given volume.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt, find_objects, gaussian_filter, label
from scipy.special import ndtr

from ...errors import InputError
from ..grids.boxes import Box, box_around
from ..grids.near import capped_squares

# Values are relative to the mean density of the solid's cells. Below this, a cell is empty.
_NEGLIGIBLE = 1e-6
# Width in cells of the averages that give the typical density of a place: about the radius of a thin part.
_AROUND = 1.25
_TRUNCATE = 3.0
# Typical density along a flat face, where the level is half of the solid's density.
_FLAT = 0.75
# The density on the surface of rods with a radius of 1 to 5 cells, blurred by 0.7 to 2 cells, is 0.5 (typical /
# 0.75)^0.65 to about a tenth; a slightly larger exponent compensates for the volume that triangles cut off narrow rods
# (tests/geometry/level_sets/test_thin_parts.py checks the volumes).
_POWER = 0.7
# Typical densities beside a plane are computed up to this distance in cells, in steps of this length.
_PROFILE, _PROFILE_STEP = 10.0, 1.0 / 16.0
# Below this typical density there is no part, only scattered mass.
_SCATTERED = 0.2

# A part must reach this density somewhere; less is scattered mass.
_PART = 0.1
# A part must also hold this fraction of the mass.
_LEAST_SHARE = 1e-4
# Number of parts that are described individually.
_LISTED = 16


@dataclass(frozen=True)
class LostPart:
    """A connected part of a density that the surface misses entirely.

    Attributes
    ----------
    share : float
        Fraction of the total mass.
    cells : float
        Its volume in cells, if it had the density of the solid.
    center : (float, float, float)
        Center of mass in cells; voxel (i, j, k) is the unit cube whose lower corner is (i, j, k).
    length : float
        In cells: the length of a rod whose mass has the same variance along its axis.
    thickness : float
        In cells: the diameter of a rod of this length and volume.
    low, high : (int, int, int)
        Bounding box in voxels, `high` excluded.
    """

    share: float
    cells: float
    center: tuple[float, float, float]
    length: float
    thickness: float
    low: tuple[int, int, int]
    high: tuple[int, int, int]

    def moved(self, offset: Sequence[int]) -> LostPart:
        """Return the part translated by `offset`, (3,) cells."""
        center, low, high = (
            tuple(type(x)(x + d) for x, d in zip(place, offset, strict=True))
            for place in (self.center, self.low, self.high)
        )
        return replace(self, center=center, low=low, high=high)


@dataclass(frozen=True)
class LostParts:
    """The mass that a surface misses, as fractions of the total mass.

    Attributes
    ----------
    share : float
        Mass of parts that are missed entirely.
    scattered : float
        Mass that is far from the surface and too thin or too small to be a part.
    count : int
        Number of missed parts.
    parts : tuple of LostPart
        The largest of them, in descending order.
    """

    share: float
    scattered: float
    count: int
    parts: tuple[LostPart, ...]

    def record(self) -> dict[str, object]:
        """Return all figures, ready for JSON."""
        return asdict(self)

    def moved(self, offset: Sequence[int]) -> LostParts:
        """Return the same parts on a larger grid in which this one begins at cell `offset`, (3,)."""
        return replace(self, parts=tuple(part.moved(offset) for part in self.parts))


def locally_normalized(density: NDArray[np.floating], volume: float) -> NDArray[np.float32]:
    """Raise thin parts of a density until one level suits thick and thin parts.

    The density is divided by its value on the surface of a part of the same thickness, which is a function of the
    typical density of the place. That is the mean of the surrounding densities weighted by mass, G(u^2) / G(u), with G
    a narrow Gaussian. Thick parts are divided by one, so their level sets do not change. Mass too faint to be a part is
    raised by one common factor of 2.5, which leaves it below any level.

    Parameters
    ----------
    density : (nx, ny, nz)
        Nonnegative, slightly blurred like all densities to be meshed.
    volume : float
        Number of cells that the surface will enclose; together with the mass it gives the density of the solid.

    Returns
    -------
    (nx, ny, nz) float32
        For `surface_enclosing`. In thick parts, the density in units of the solid's; zero where that is below 1e-6. The
        result does not depend on a constant factor of the density.

    Raises
    ------
    InputError
        No mass or no volume.
    """
    return _raised(_in_solids(density, volume), lambda values: _FLAT)


def normalized_solid(blurred: NDArray[np.floating], blur: float) -> NDArray[np.float32]:
    """Raise the thin parts of a blurred solid, and leave it as it is beside planes, at any distance from them.

    :func:`locally_normalized` also raises densities outside a plane face, because typical densities are low there, too.

    Parameters
    ----------
    blurred : (nx, ny, nz)
        Fraction of every cell that the solid fills, blurred by a Gaussian; also (nx, ny).
    blur : float
        Standard deviation of the blur in cells.

    Raises
    ------
    InputError
        No mass.
    """
    if not blurred.any():
        raise InputError("A density without mass, or no volume for it, has no parts.")
    densities, typical = _beside_plane(blur)
    least = np.minimum(typical, _FLAT)
    return _raised(blurred.astype(np.float32, copy=False), lambda values: np.interp(values, densities, least))


def lost_parts(density: NDArray[np.floating], shown: NDArray[np.bool_], reach: float) -> LostParts:
    """Find the mass that a surface misses, excluding the blurred rim of what it shows.

    Parameters
    ----------
    density : (nx, ny, nz)
        Nonnegative; as solved, before any change to find a level.
    shown : (nx, ny, nz) bool
        Cells inside the surface.
    reach : float
        Distance in cells that a blur carries mass from the surface; mass farther away belongs to something else. Three
        standard deviations are enough.

    Returns
    -------
    LostParts
        Where a lost part touches a shown one, cells closer to the shown one are not counted.

    Raises
    ------
    InputError
        No mass, nothing shown, or shapes that do not match.
    """
    if shown.shape != density.shape or not shown.any():
        raise InputError("What a surface shows must be some of the cells of its density.")
    volume = float(np.count_nonzero(shown))
    solid = _in_solids(density, volume)
    box = box_around((solid > _NEGLIGIBLE) | shown, 1)
    values, inside = solid[box], shown[box]
    # The surface lies about half a cell beyond the centers of the cells inside.
    away = capped_squares(inside, reach + 0.5)
    far = away > (reach + 0.5) ** 2
    beyond = float(values.sum(where=far, dtype=np.float64))
    parts = _Parts.none() if beyond < _LEAST_SHARE * volume else _labelled_parts(values, away, far, reach)
    masses = np.bincount(parts.labels.ravel(), values[parts.box].ravel())
    kept = np.flatnonzero(masses[1:] >= _LEAST_SHARE * volume) + 1
    lost = np.zeros(values.shape, bool)
    lost[parts.box] = np.isin(parts.labels, kept)
    largest = kept[np.argsort(-masses[kept], kind="stable")][:_LISTED]
    start = [span.start + inner.start for span, inner in zip(box, parts.box, strict=True)]
    boxes = find_objects(parts.labels)
    measured = (_measured(values[parts.box], parts.labels, int(one), boxes[one - 1], volume) for one in largest)
    return LostParts(
        share=float(masses[kept].sum()) / volume,
        scattered=(beyond - float(values.sum(where=far & lost, dtype=np.float64))) / volume,
        count=len(kept),
        parts=tuple(part.moved(start) for part in measured),
    )


@dataclass(frozen=True)
class _Parts:
    """Labels 1, 2, ... of the cells of parts that are not shown, zero elsewhere, within their common box."""

    box: Box
    labels: NDArray[np.int32]

    @classmethod
    def none(cls) -> _Parts:
        return cls((slice(0, 1),) * 3, np.zeros((1, 1, 1), np.int32))


def _raised(
    solid: NDArray[np.float32], thick: Callable[[NDArray[np.float32]], NDArray[np.float64] | float]
) -> NDArray[np.float32]:
    """Raise densities, in units of the solid's, where the typical density is below that of thick parts.

    `thick` returns the least typical density of thick parts for some densities, at most `_FLAT`.
    """
    box = box_around(solid > _NEGLIGIBLE, 0)
    values = np.where(solid[box] > _NEGLIGIBLE, solid[box], np.float32(0.0))
    around = gaussian_filter(values, _AROUND, truncate=_TRUNCATE, mode="constant")
    typical = np.square(values)
    gaussian_filter(typical, _AROUND, truncate=_TRUNCATE, mode="constant", output=typical)
    # Around cells with mass, there is more than this.
    typical /= np.maximum(around, np.finfo(np.float32).tiny, out=around)
    # On fine grids, it is large.
    del around
    # Most cells are empty or belong to thick parts.
    thin = np.flatnonzero((values > 0.0) & (typical < _FLAT))
    gain = thick(values.ravel()[thin]) / np.maximum(typical.ravel()[thin], _SCATTERED)
    values.ravel()[thin] *= np.maximum(gain, 1.0).astype(np.float32) ** np.float32(_POWER)
    result = np.zeros(solid.shape, np.float32)
    result[box] = values
    return result


@cache
def _beside_plane(blur: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return rising densities beside a plane face of a blurred solid, and the typical density around each of them."""
    places = np.arange(-_PROFILE, _PROFILE, _PROFILE_STEP)
    # A cell is uniform, which adds a twelfth to the variance.
    density = ndtr(places / np.sqrt(blur**2 + 1.0 / 12.0))
    width = _AROUND / _PROFILE_STEP
    squares, around = (gaussian_filter(values, width, truncate=_TRUNCATE) for values in (density**2, density))
    return density, squares / np.maximum(around, _NEGLIGIBLE)


def _in_solids(density: NDArray[np.floating], volume: float) -> NDArray[np.float32]:
    """Return the density in units of the density that the mass would have if spread evenly over the volume."""
    # Sums of very large or very small densities may overflow or underflow.
    peak = float(density.max(initial=0.0))
    if not 0.0 < peak < np.inf or not volume > 0.0:
        raise InputError("A density without mass, or no volume for it, has no parts.")
    relative = (density / peak).astype(np.float32, copy=False)
    relative *= np.float32(volume / relative.sum(dtype=np.float64))
    return relative


def _labelled_parts(
    values: NDArray[np.float32], away: NDArray[np.integer], far: NDArray[np.bool_], reach: float
) -> _Parts:
    """Label every part that is not shown: connected components far from the surface, extended by their rims."""
    seeds = far & (values > _PART)
    if not seeds.any():
        return _Parts.none()
    box = box_around(seeds, int(np.ceil(reach)) + 1)
    cores, _ = label(seeds[box], np.ones((3, 3, 3)))
    distance, nearest = distance_transform_edt(cores == 0, return_indices=True)
    rim = (distance <= reach) & (distance**2 < away[box])
    return _Parts(box, np.where(rim, cores[tuple(nearest)], 0))


def _measured(
    values: NDArray[np.float32],
    part: NDArray[np.int32],
    index: int,
    box: Box,
    volume: float,
) -> LostPart:
    """Measure one part: its moments determine the length, and its mass the corresponding thickness."""
    where = np.argwhere(part[box] == index)
    weights = values[box][tuple(where.T)]
    low, high = (np.array(ends) for ends in zip(*((span.start, span.stop) for span in box), strict=True))
    cells = float(weights.sum())
    center = weights @ where / cells
    spread = where - center
    # A cell is itself a cube, with a variance of one twelfth along each axis.
    covariance = (spread * weights[:, None]).T @ spread / cells + np.eye(3) / 12.0
    length = float(np.sqrt(12.0 * np.linalg.eigvalsh(covariance)[-1]))
    return LostPart(
        share=cells / volume,
        cells=cells,
        center=tuple(float(x) for x in center + low + 0.5),
        length=length,
        thickness=float(2.0 * np.sqrt(cells / (np.pi * length))),
        low=tuple(int(x) for x in low),
        high=tuple(int(x) for x in high),
    )
