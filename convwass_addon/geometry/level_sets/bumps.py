# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Smooth local changes of a density."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

# Extent of a bump, in radii.
_REACH = 4.0


@dataclass(frozen=True)
class Bump:
    """A local change of a density around a cell.

    Attributes
    ----------
    spans : tuple of slice
        The box that it affects.
    factor : (mx, my, mz)
        Factor of the density in the box.
    """

    spans: tuple[slice, ...]
    factor: NDArray[np.floating]

    @classmethod
    def to(cls, density: NDArray[np.floating], place: tuple[int, ...], wanted: float, radius: float) -> Bump:
        """Return the bump of this radius (in cells) that changes the density of a cell to `wanted`."""
        spans = around(density.shape, place, _REACH * radius)
        share = wanted / float(density[place]) - 1.0
        for axis, at in zip(np.ogrid[spans], place, strict=True):
            share = share * np.exp(-((axis - at) ** 2) / (2.0 * radius**2))
        return cls(spans, (1.0 + share).astype(density.dtype))

    def apply(self, density: NDArray[np.floating]) -> None:
        """Apply the bump to a density in place."""
        density[self.spans] *= self.factor


def around(shape: tuple[int, ...], place: tuple[int, ...], reach: float) -> tuple[slice, ...]:
    """Return the box of cells within `reach` of a cell along every axis, clipped to the grid."""
    cells = int(np.ceil(reach))
    return tuple(slice(max(at - cells, 0), min(at + cells + 1, n)) for at, n in zip(place, shape, strict=True))
