# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Level fields of blends, and mixtures of them at the level that encloses the interpolated volume.

The level field of a blend is zero on its surface, positive inside, and -1 where the density is zero. Fields of
neighboring blends differ little, so the zero set of their mean is close to the surface of the blend between them
(docs/performance, "Live blends").
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import InputError
from ...geometry.arrays.bounds import common_bounds
from ...geometry.grids.boxes import bounding_box, padded_box
from ...geometry.level_sets.marching_cubes import marching_cubes
from ...geometry.meshes.mesh import TriangleMesh
from ...one_line import one_line
from .color_fields import ColorField, mixed_colors

OUTSIDE = -1.0
"""Value of a level field where nothing is."""

# Far inside, values do not influence the surface of a mixture; larger values would only favor thick parts over thin
# ones.
_DEEPEST = 4.0
# Limits for the level of a mixed field.
_LEAST_LEVEL, _MOST_LEVEL = -0.75, 0.9
# Cells with values this close to the level count in part, over a band of this total width. Counting whole cells would
# make the volume of a ball of 800 cells vary by 1.4 % (tests/applications/live/test_level_fields.py).
_RAMP = 0.5
# Tolerance of the level, as a fraction of the cells inside, and the maximum number of Newton steps.
_CELL_TOLERANCE, _NEWTON_STEPS = 5e-4, 8
# Values are kept at this distance from the level: samples at the level would give several vertices at one position.
_CLEARANCE = 1e-4


@dataclass(frozen=True)
class FieldBox:
    """A box of cells.

    Attributes
    ----------
    low : (3,) int64
        The first cell, in cells of the common grid.
    shape : tuple of int
        Cells per axis.
    """

    low: NDArray[np.int64]
    shape: tuple[int, int, int]

    @classmethod
    def between(cls, low: ArrayLike, high: ArrayLike) -> FieldBox:
        """Return the box from a first cell to the cell after the last, (3,) each."""
        low, high = np.asarray(low, np.int64), np.asarray(high, np.int64)
        return cls(low, tuple(int(n) for n in high - low))

    @property
    def high(self) -> NDArray[np.int64]:
        """The cell after the last, (3,)."""
        return self.low + self.shape

    @property
    def field_bytes(self) -> int:
        """Memory of one field in bytes."""
        return int(np.prod(self.shape)) * np.dtype(np.float16).itemsize

    def overlap(self, other: FieldBox) -> tuple[slice, ...]:
        """Return the slices of an array in this box that lie in another box, too."""
        begin = np.clip(other.low - self.low, 0, self.shape).tolist()
        end = np.clip(other.high - self.low, 0, self.shape).tolist()
        return tuple(map(slice, begin, end))

    def union(self, other: FieldBox) -> FieldBox:
        """Return the smallest box that contains both."""
        return FieldBox.between(np.minimum(self.low, other.low), np.maximum(self.high, other.high))


@dataclass(frozen=True, eq=False)
class LevelField:
    """The level field of one blend.

    It is stored only where the density is positive: on average 40 % of the cells that all blends of three shapes
    together need (docs/performance, "Live blends").

    Attributes
    ----------
    box : FieldBox
        The cells where values are stored, on the common grid; elsewhere the field is -1.
    values : (nx, ny, nz) float16
        density / level - 1, at most 4.
    volume : float
        Volume enclosed by the surface, in cells.
    cells : float
        Number of cells inside, with those close to the surface counted in part.
    span : (2, 3) int64
        In cells of the common grid, the first cell and the cell after the last that the surface of a mixture can reach.
    colors : ColorField or None
        Colors of the blend; None if it carries none.
    """

    box: FieldBox
    values: NDArray[np.float16]
    volume: float
    cells: float
    span: NDArray[np.int64]
    colors: ColorField | None = None

    __repr__ = one_line("values", "volume", "cells")

    @property
    def nbytes(self) -> int:
        """Memory that it takes."""
        return self.values.nbytes + (0 if self.colors is None else self.colors.nbytes)

    @property
    def reach(self) -> NDArray[np.bool_]:
        """Cells that a surface of a mixture can reach, (nx, ny, nz)."""
        return self.values > np.float16(_LEAST_LEVEL)

    @classmethod
    def of(
        cls, density: NDArray[np.floating], low: ArrayLike, level: float, volume: float, box: FieldBox
    ) -> LevelField:
        """Compute the field of a blend.

        Parameters
        ----------
        density : (mx, my, mz)
            Not negative, prepared for surface extraction; zero outside the array.
        low : (3,) int
            Its first cell on the common grid.
        level : float
            Density on the surface.
        volume : float
            Volume enclosed by the surface, in cells.
        box : FieldBox
            The density outside this box is cut off.

        Raises
        ------
        InputError
            The density does not exceed the level anywhere.
        """
        own = FieldBox.between(low, np.add(low, density.shape))
        values = np.full(box.shape, OUTSIDE, np.float16)
        values[box.overlap(own)] = np.minimum(density[own.overlap(box)] / level - 1.0, _DEEPEST)
        return cls.of_values(values, volume, box)

    @classmethod
    def of_values(cls, values: NDArray[np.floating], volume: float, box: FieldBox) -> LevelField:
        """Create a field from its values, (nx, ny, nz) in a box; other parameters as for :meth:`of`."""
        values = values.astype(np.float16, copy=False)
        if not (values > 0).any():
            raise InputError("A blend that fills no cell has no level field; use a finer resolution.")
        span = np.stack(bounding_box(values > np.float16(_LEAST_LEVEL))) + box.low
        own = FieldBox.between(*(np.stack(bounding_box(values > np.float16(OUTSIDE))) + box.low))
        return cls(own, values[box.overlap(own)].copy(), float(volume), _cells_inside(values), span)

    def difference(self, other: LevelField) -> float:
        """Return how much two blends differ, as a fraction of their mean mass, 0 to 2.

        Mass is the density of the field, 1 in solid parts: this is the L1 distance of two densities of mass 1.
        """
        box = self.box.union(other.box)
        own, others = _densities(self._values_in(box)), _densities(other._values_in(box))
        return 2.0 * float(np.abs(own - others).sum(dtype=np.float64) / (own + others).sum(dtype=np.float64))

    def _values_in(self, box: FieldBox) -> NDArray[np.float16]:
        values = np.full(box.shape, OUTSIDE, np.float16)
        values[box.overlap(self.box)] = self.values[self.box.overlap(box)]
        return values


@dataclass(frozen=True)
class MixedField:
    """A mixture of the fields of several blends.

    Attributes
    ----------
    values : (nx, ny, nz) float32
        The mixed values.
    low : (3,) int64
        Its first cell on the common grid; values outside are -1.
    level : float
        Value on the surface.
    volume : float
        Volume that the surface should enclose, in cells.
    """

    values: NDArray[np.float32]
    low: NDArray[np.int64]
    level: float
    volume: float

    __repr__ = one_line("values", "level", "volume")

    def surface(self) -> TriangleMesh:
        """Extract the surface by marching cubes, in cells of the common grid, closed and oriented outward."""
        sample, low = padded_box(self.values, self.values > self.level, 1, OUTSIDE)
        # Marching cubes places samples at integer coordinates; here they are at cell centers.
        return marching_cubes(sample, self.level).moved(self.low + low + 0.5)


def mixed(fields: Sequence[LevelField], shares: Sequence[float]) -> MixedField:
    """Mix level fields, and find the level that encloses the interpolated volume.

    The volume inside a level is proportional to the number of cells inside it. The ratio is known for every field, and
    interpolated.

    Parameters
    ----------
    fields : sequence of LevelField
        At least one field.
    shares : sequence of float
        One per field, not negative, of sum 1.
    """
    low, high = common_bounds([field.span for field in fields])
    box = FieldBox.between(low - 1, high + 1)
    values = np.full(box.shape, OUTSIDE, np.float32)
    for field, share in zip(fields, shares, strict=True):
        part = np.multiply(field.values[field.box.overlap(box)], np.float32(share), dtype=np.float32)
        part -= np.float32(share * OUTSIDE)
        values[box.overlap(field.box)] += part
    volume = float(np.dot(shares, [field.volume for field in fields]))
    wanted = volume * float(np.dot(shares, [field.cells / field.volume for field in fields]))
    return MixedField(values, box.low, _enclosing_level(values, wanted), volume)


def colors_at(
    fields: Sequence[LevelField], shares: Sequence[float], points: NDArray[np.float64]
) -> NDArray[np.float32] | None:
    """Return the colors of a mixture at points, (n, 3) in cells of the common grid; None if no field has colors."""
    known = [(field.colors, share) for field, share in zip(fields, shares, strict=True) if field.colors is not None]
    return mixed_colors(*zip(*known, strict=True), points) if known else None


def _enclosing_level(values: NDArray[np.float32], wanted: float) -> float:
    """Return the level with this many cells inside, by Newton's method; values too close to it are moved away."""
    flat = values.reshape(-1)
    ramp = _RAMP / 2.0
    near = np.flatnonzero((flat > _LEAST_LEVEL - ramp) & (flat < _MOST_LEVEL + ramp))
    close = flat[near]
    level, inside = 0.0, np.count_nonzero(flat >= _MOST_LEVEL + ramp)
    for _ in range(_NEWTON_STEPS):
        share = (close - np.float32(level)) / np.float32(_RAMP) + np.float32(0.5)
        on_ramp = np.count_nonzero((share > 0.0) & (share < 1.0))
        excess = inside + float(np.clip(share, 0.0, 1.0).sum(dtype=np.float64)) - wanted
        if on_ramp == 0 or abs(excess) < _CELL_TOLERANCE * wanted:
            break
        level = min(max(level + excess * _RAMP / on_ramp, _LEAST_LEVEL), _MOST_LEVEL)
    touching = near[np.abs(close - np.float32(level)) < _CLEARANCE]
    is_inside = flat[touching] > level
    flat[touching] = level + np.where(is_inside, _CLEARANCE, -_CLEARANCE).astype(np.float32)
    return level


def _densities(values: NDArray[np.float16]) -> NDArray[np.float32]:
    """Convert level fields to densities, which are one half on the surface."""
    return np.clip(0.5 * values.astype(np.float32) + np.float32(0.5), 0.0, 1.0)


def _cells_inside(values: NDArray[np.floating]) -> float:
    """Count the cells inside the level zero; cells close to it count in part."""
    share = values.astype(np.float32) / np.float32(_RAMP) + np.float32(0.5)
    return float(np.clip(share, 0.0, 1.0).sum(dtype=np.float64))
