# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The transported parts of a flat input: areas filled by curves, or the values of an image."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...geometry.arrays.bounds import common_bounds
from ...geometry.plane.coverage import coverage
from ...geometry.plane.pixels import means_in_cells
from ...geometry.plane.planar_fill import Boundary, filled_boundary
from .flat_shapes import FlatImage, FlatInput, FlatShape

# A shape that fills less of the square around it than this fraction is a line.
_LEAST_SHARE = 1e-6
# Pixels of at least this value belong to a silhouette.
_HALF = 0.5


class FlatPieces(Protocol):
    """An input divided into parts, independent of a grid."""

    @property
    def center(self) -> NDArray[np.float64]:
        """Center of mass, (2,), scene units."""

    @property
    def bounds(self) -> NDArray[np.float64]:
        """Low and high corner of everything that has mass, (2, 2)."""

    def densities(self, corner: NDArray[np.float64], spacing: float, shape: tuple[int, int]) -> list[NDArray]:
        """Occupancy of the cells of a grid, (nx, ny) for every part."""


@dataclass(frozen=True)
class FilledPieces:
    """Areas filled by curves.

    Attributes
    ----------
    parts : tuple of Boundary
        Boundary of every part.
    """

    parts: tuple[Boundary, ...]

    @property
    def center(self) -> NDArray[np.float64]:
        """Center of mass, (2,)."""
        filled = [part for part in self.parts if part.area > 0]
        areas = np.array([part.area for part in filled])
        return areas @ np.stack([part.center for part in filled]) / areas.sum()

    @property
    def bounds(self) -> NDArray[np.float64]:
        """Low and high corner, (2, 2)."""
        return common_bounds([part.bounds for part in self.parts if len(part.starts)])

    def densities(self, corner: NDArray[np.float64], spacing: float, shape: tuple[int, int]) -> list[NDArray]:
        """Exact areas, (nx, ny) for every part."""
        return [coverage(part.moved(-corner / spacing, 1.0 / spacing), shape) for part in self.parts]


@dataclass(frozen=True)
class ImagePieces:
    """An image, which is a single part.

    Attributes
    ----------
    values : (w, h) float64
        Values of the pixels.
    pixel : float
        Size of a pixel, scene units.
    corner : (2,) float64
        Lower left corner.
    """

    values: NDArray[np.float64]
    pixel: float
    corner: NDArray[np.float64]

    @property
    def center(self) -> NDArray[np.float64]:
        """Center of mass, (2,)."""
        mass = self.values / self.values.sum()
        places = [np.arange(n) + 0.5 for n in mass.shape]
        return self.corner + self.pixel * np.array([mass.sum(axis=1) @ places[0], mass.sum(axis=0) @ places[1]])

    @property
    def bounds(self) -> NDArray[np.float64]:
        """Low and high corner of the pixels that are not zero, (2, 2)."""
        filled = [np.flatnonzero((self.values > 0).any(axis=axis)) for axis in (1, 0)]
        return self.corner + self.pixel * np.array([[own[0] for own in filled], [own[-1] + 1 for own in filled]])

    def densities(self, corner: NDArray[np.float64], spacing: float, shape: tuple[int, int]) -> list[NDArray]:
        """Means over the cells, (nx, ny), by exact areas."""
        return [means_in_cells(self.values, (self.corner - corner) / spacing, self.pixel / spacing, shape)]


def flat_pieces(shape: FlatInput, name: str, letters: Sequence[NDArray[np.int64]] | None) -> FlatPieces:
    """Convert an input to parts.

    Parameters
    ----------
    shape : FlatShape or FlatImage
        The input.
    name : str
        Name of the shape, for messages.
    letters : sequence of (m,) int64 or None
        Indices of the rings of every part; None for one part.

    Raises
    ------
    InputError
        Curves or images that fill nothing, or curves with too many intersections.
    """
    if isinstance(shape, FlatImage):
        return _image_pieces(shape, name)
    if not shape.rings:
        raise InputError("'{name}' has no closed curve, so there is nothing to move.", name=name)
    chosen = [np.arange(len(shape.rings))] if letters is None else letters
    pieces = FilledPieces(tuple(filled_by(shape, rings) for rings in chosen))
    extent = np.ptp(np.concatenate(shape.rings), axis=0).max()
    if sum(part.area for part in pieces.parts) <= _LEAST_SHARE * extent**2:
        raise InputError(
            "'{name}' fills no area, so there is nothing to move. Its curves must be closed and must not cancel each "
            "other out; a line needs a width.",
            name=name,
        )
    return pieces


def filled_by(shape: FlatShape, rings: NDArray[np.int64]) -> Boundary:
    """Return the boundary of the union of a shape's layers, each of which some rings fill by the rule."""
    layers = [filled_layer(shape, layer) for layer in layers_of(shape, rings)]
    return layers[0] if len(layers) == 1 else layers[0].united(layers[1:])


def filled_layer(shape: FlatShape, layer: NDArray[np.int64]) -> Boundary:
    """Return the boundary of what the rings of one layer fill by the rule of their shape."""
    return filled_boundary([shape.rings[i] for i in layer], shape.rule)


def layers_of(shape: FlatShape, rings: NDArray[np.int64] | None = None) -> list[NDArray[np.int64]]:
    """Return the indices of some or all rings of every color, in the order in which the colors first occur."""
    rings = np.arange(len(shape.rings)) if rings is None else rings
    if shape.colors is None:
        return [rings]
    _, first, color = np.unique(shape.colors[rings], axis=0, return_index=True, return_inverse=True)
    return [rings[color.ravel() == index] for index in np.argsort(first)]


def _image_pieces(image: FlatImage, name: str) -> ImagePieces:
    values = np.asarray(image.values, dtype=np.float64)
    if image.kind == "silhouette":
        values = (values >= _HALF).astype(np.float64)
    if values.sum() <= 0:
        raise InputError("'{name}' is empty: no pixel of it has anything to move.", name=name)
    return ImagePieces(values, float(image.pixel), np.array(image.corner, dtype=np.float64))
