# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Colors of flat shapes, as layers on the grid of the morph."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt, gaussian_filter, map_coordinates

from ...geometry.plane.coverage import coverage
from .flat_lattice import FlatLattice
from .flat_pieces import filled_layer, layers_of
from .flat_shapes import FlatImage, FlatInput

# Cells over which the borders between layers are smoothed.
_BLUR = 0.7


@dataclass(frozen=True)
class InputLayers:
    """The layers of an input on the grid of the morph.

    Attributes
    ----------
    colors : (l, 4) float64
        Red, green, blue, opacity, linear.
    shares : (l, nx, ny) float32 or None
        Fraction of every cell that belongs to each layer; outside the input, that of the nearest point. None for one
        layer.
    """

    colors: NDArray[np.float64]
    shares: NDArray[np.float32] | None

    def margins(self, cells: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return by how much the fraction of every layer exceeds all others at points, (n, 2) in cells: (l, n)."""
        if self.shares is None:
            return np.ones((1, len(cells)))
        found = np.stack([map_coordinates(own, cells.T - 0.5, order=1, mode="nearest") for own in self.shares])
        top, second = np.sort(found, axis=0)[[-1, -2]]
        return np.where(found == top, found - second, found - top)


def input_layers(shapes: Sequence[FlatInput], lattice: FlatLattice) -> tuple[InputLayers, ...]:
    """Draw the layers of shapes on a grid; return nothing if no shape has several colors, or if one has none.

    Parameters
    ----------
    shapes : sequence of FlatShape or FlatImage
        The inputs.
    lattice : FlatLattice
        The grid, with the center of every shape.
    """
    if any(isinstance(shape, FlatImage) or shape.colors is None for shape in shapes):
        return ()
    if all(len(layers_of(shape)) == 1 for shape in shapes):
        return ()
    return tuple(_drawn(shape, lattice, center) for shape, center in zip(shapes, lattice.centers, strict=True))


def _drawn(shape: FlatInput, lattice: FlatLattice, center: NDArray[np.float64]) -> InputLayers:
    layers = layers_of(shape)
    colors = np.stack([shape.colors[layer[0]] for layer in layers]).astype(np.float64)
    if len(layers) == 1:
        return InputLayers(colors, None)
    corner, scale = lattice.origin + center, 1.0 / lattice.spacing
    filled = [filled_layer(shape, layer) for layer in layers]
    shares = np.stack([coverage(own.moved(-corner * scale, scale), lattice.shape) for own in filled])
    # Later layers cover earlier ones.
    beyond = np.ones(lattice.shape)
    for own in shares[::-1]:
        own *= beyond
        beyond = beyond - own
    whole = shares.sum(axis=0)
    nearest = distance_transform_edt(whole < 0.5, return_distances=False, return_indices=True)
    known = np.where(whole >= 0.5, shares / np.maximum(whole, 0.5), 0.0)
    known = known[(slice(None), *nearest)]
    return InputLayers(colors, np.stack([gaussian_filter(own, _BLUR) for own in known]).astype(np.float32))
