# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The grid of a morph, in space or in a plane, relative to the center of every shape."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...geometry.arrays.bounds import common_bounds
from ...transport import Grid
from .moved_room import Room

# Empty cells around moved shapes, for the blur.
_MARGIN = 4


@dataclass(frozen=True)
class CenteredGrid:
    """The grid shared by all shapes of a morph, relative to the center of each.

    Translating shapes translates their barycenter, so only extents relative to the centers matter: shapes far apart in
    the scene cost no more than shapes in one place.

    Attributes
    ----------
    shape : tuple of d int
        Cells per axis.
    spacing : float
        Size of a cell in scene units.
    origin : (d,) float64
        Low corner of the grid relative to a shape's center, scene units.
    centers : (k, d) float64
        Centers of the shapes, scene units.
    """

    multiple: ClassVar[int]
    """Sides are multiples of this, so that the grid can be halved several times."""

    shape: tuple[int, ...]
    spacing: float
    origin: NDArray[np.float64]
    centers: NDArray[np.float64]

    @classmethod
    def of_bounds(
        cls, bounds: Sequence[NDArray[np.float64]], centers: NDArray[np.float64], resolution: int, sigma: float
    ) -> Self:
        """Return a grid with `resolution` cells along its longest side that holds shapes with these bounds, (2, d).

        Raises
        ------
        InputError
            A resolution too small for a shape and its blur of `sigma` cells.
        """
        margin = 2 + int(np.ceil(2.0 * sigma))
        if resolution < 4 * margin:
            raise InputError(
                "Resolution {resolution} is too coarse for a blur of {blur:.3g} cells; use at least {least}, or less "
                "blur.",
                resolution=resolution,
                blur=sigma,
                least=4 * margin,
            )
        low, high = common_bounds(np.stack(bounds) - centers[:, None])
        extent = high - low
        spacing = float(extent.max()) / (resolution - 2 * margin)
        cells = np.ceil(extent / spacing + 2 * margin)
        cells = (np.ceil(cells / cls.multiple) * cls.multiple).astype(int)
        return cls(tuple(cells.tolist()), spacing, (low + high) / 2 - cells * spacing / 2, centers)

    def holding(self, room: Room | None) -> Self:
        """Return the same cells and enough further ones for moved shapes."""
        if room is None:
            return self
        first, end = self._span(room)
        below, end = (-first).clip(min=0), np.maximum(end, self.shape)
        cells = (np.ceil((end + below) / self.multiple - 1e-9) * self.multiple).astype(int)
        return replace(self, shape=tuple(cells.tolist()), origin=self.origin - below * self.spacing)

    def only_holding(self, room: Room) -> Self:
        """Return only the cells that moved shapes need, in the same places.

        The longest side is only enlarged, because some lengths are relative to it and should be the same in all blends.
        """
        first, end = self._span(room)
        longest = int(np.argmax(self.shape))
        first[longest], end[longest] = min(first[longest], 0), max(end[longest], self.shape[longest])
        first, end = np.floor(first / self.multiple) * self.multiple, np.ceil(end / self.multiple) * self.multiple
        cells = tuple(int(n) for n in end - first)
        return replace(self, shape=cells, origin=self.origin + first * self.spacing)

    def _span(self, room: Room) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the first cell needed along each axis, (d,), and where the last one may end, (d,), in cells."""
        margin = _MARGIN + room.slack
        first = np.floor((room.low - self.origin) / self.spacing - margin)
        return first, (room.high - self.origin) / self.spacing + margin

    def grid(self, sigma: float) -> Grid:
        """Return the transport domain with a kernel of `sigma` cells."""
        return Grid(self.shape, sigma)
