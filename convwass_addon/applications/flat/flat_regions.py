# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Regions of one color within flat blends: the layers of the inputs, carried along by the transport maps.

Matter of a blend that comes from one layer on every input has one color, the mean of theirs. A region of the blend is
where these layers are the same; it is read like an outline, from a field that is positive there.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_erosion, distance_transform_edt, gaussian_filter, map_coordinates

from ...errors import InputError
from ...geometry.contours import outline_at_level
from ...geometry.coverage import coverage
from ...geometry.flat_mending import FlatMending
from ...geometry.outlines import Outline, ring_area
from ...geometry.planar_fill import filled_boundary
from ..morphs.layouts import Blend
from .flat_frames import ColoredOutline
from .flat_origins import FlatOrigins
from .flat_pieces import layers_of
from .flat_shapes import FlatImage, FlatInput

if TYPE_CHECKING:
    from .flat_lattice import FlatLattice
    from .flat_problem import FlatProblem

# Cells over which the borders between layers are smoothed.
_BLUR = 0.7
# How fast a field leaves zero at a border between layers, beside its fall at the edge of the blend; and by how much
# regions reach over such a border, so that curves fitted to either side leave no gap; and at most where three
# meet, or two at the edge of the blend.
_STEEP, _OVERLAP, _MEETING = 4.0, 0.15, 3.0
_ALL_AROUND = np.ones((3, 3), bool)
# Fields are lifted by this: beyond the grid there is nothing.
_LIFT = 16.0
# What is smaller, in cells, is no region and no hole.
_LEAST_CELLS = 4.0


@dataclass(frozen=True)
class InputLayers:
    """The layers of an input on the grid of the morph.

    Attributes
    ----------
    colors : (l, 4) float64
        Red, green, blue, opacity, linear.
    shares : (l, nx, ny) float32 or None
        How much of every cell belongs to each; beyond the input as where it is nearest. None where there is one.
    """

    colors: NDArray[np.float64]
    shares: NDArray[np.float32] | None

    def margins(self, cells: NDArray[np.float64]) -> NDArray[np.float64]:
        """By how much the share of every layer is beyond that of all others at places, (n, 2) in cells: (l, n)."""
        if self.shares is None:
            return np.ones((1, len(cells)))
        found = np.stack([map_coordinates(own, cells.T - 0.5, order=1, mode="nearest") for own in self.shares])
        top, second = np.sort(found, axis=0)[[-1, -2]]
        return np.where(found == top, found - second, found - top)


def input_layers(
    shapes: Sequence[FlatInput], centers: NDArray[np.float64], lattice: FlatLattice
) -> tuple[InputLayers, ...]:
    """Draw the layers of shapes on a grid; nothing where all shapes have one color at the most, or some have none.

    Parameters
    ----------
    shapes : sequence of FlatShape or FlatImage
        The inputs.
    centers : (k, 2)
        Where the grid stands on each.
    lattice : FlatLattice
        The grid.
    """
    if any(isinstance(shape, FlatImage) or shape.colors is None for shape in shapes):
        return ()
    if all(len(layers_of(shape, np.arange(len(shape.rings)))) == 1 for shape in shapes):
        return ()
    return tuple(_drawn(shape, lattice, center) for shape, center in zip(shapes, centers, strict=True))


def _drawn(shape: FlatInput, lattice: FlatLattice, center: NDArray[np.float64]) -> InputLayers:
    layers = layers_of(shape, np.arange(len(shape.rings)))
    colors = np.stack([shape.colors[layer[0]] for layer in layers]).astype(np.float64)
    if len(layers) == 1:
        return InputLayers(colors, None)
    corner, scale = lattice.origin + center, 1.0 / lattice.spacing
    filled = [filled_boundary([shape.rings[i] for i in layer], shape.rule) for layer in layers]
    shares = np.stack([coverage(own.moved(-corner * scale, scale), lattice.shape) for own in filled])
    # What comes later is painted over what comes before.
    beyond = np.ones(lattice.shape)
    for own in shares[::-1]:
        own *= beyond
        beyond = beyond - own
    whole = shares.sum(axis=0)
    nearest = distance_transform_edt(whole < 0.5, return_distances=False, return_indices=True)
    known = np.where(whole >= 0.5, shares / np.maximum(whole, 0.5), 0.0)
    known = known[(slice(None), *nearest)]
    return InputLayers(colors, np.stack([gaussian_filter(own, _BLUR) for own in known]).astype(np.float32))


def colored_regions(
    problem: FlatProblem, blend: Blend, mending: FlatMending, origins: FlatOrigins
) -> tuple[ColoredOutline, ...]:
    """Divide a blend by the colors that it carries.

    Parameters
    ----------
    problem : FlatProblem
        With the layers of its shapes.
    blend : Blend
        Which one.
    mending : FlatMending
        Its outline, in cells, and the density that this was drawn of.
    origins : FlatOrigins
        Where its matter comes from.

    Returns
    -------
    tuple of ColoredOutline
        In scene units, the largest first. Neighbors reach a fraction of a cell into each other.
    """
    lattice, level = problem.lattice, mending.drawn.level
    height = mending.density / level - 1.0
    near = np.argwhere(height > -0.9)
    corner = lattice.corner(blend.weights)
    places = origins.at((near + 0.5) * lattice.spacing + corner)
    active = np.flatnonzero(blend.weights)
    margins = [
        problem.layers[index].margins((places[index] - lattice.origin - lattice.centers[index]) / lattice.spacing)
        for index in active
    ]
    inside = height[tuple(near.T)] > 0
    combined = {
        chosen: _STEEP * np.min([own[layer] for own, layer in zip(margins, chosen, strict=True)], axis=0)
        for chosen in _combinations(margins)
    }
    # Within the blend colors alone say where borders are: a field that is cut off on one side only would move them.
    inner = binary_erosion(height > 0, _ALL_AROUND)[tuple(near.T)]
    cut = np.where(inner, _LIFT, height[tuple(near.T)])
    overlap = np.where(inner, _OVERLAP, _MEETING) + _where_three_meet(list(combined.values()))
    found = []
    for chosen, margin in combined.items():
        if (inside & (margin > 0)).sum() < _LEAST_CELLS:
            continue
        field = np.zeros(lattice.shape)
        field[tuple(near.T)] = _LIFT + np.minimum(cut, margin + overlap)
        outline = _outline(field)
        if outline.regions:
            weights = np.array([blend.weights[index] for index in active])
            colors = [problem.layers[index].colors[layer] for index, layer in zip(active, chosen, strict=True)]
            color = tuple(float(value) for value in weights @ np.stack(colors) / weights.sum())
            layers = dict(zip(active.tolist(), chosen, strict=True))
            found.append(ColoredOutline(lattice.to_scene(outline, blend.weights), color, layers))
    return tuple(sorted(found, key=lambda region: -region.outline.area))


def _combinations(margins: Sequence[NDArray[np.float64]]) -> Iterator[tuple[int, ...]]:
    """Yield a layer per input, as far as these have any place at all."""
    chosen = [[layer for layer, own in enumerate(each) if (own > 0).any()] for each in margins]
    yield from product(*chosen)


def _where_three_meet(margins: Sequence[NDArray[np.float64]]) -> NDArray[np.float64] | float:
    """Return how much more regions must overlap so that nothing is left open between three of them."""
    if len(margins) < 3:
        return 0.0
    third = np.partition(np.stack(margins), -3, axis=0)[-3]
    return np.maximum(_MEETING + third, 0.0)


def _outline(field: NDArray[np.float64]) -> Outline:
    """Draw where a lifted field is positive, without specks."""
    try:
        drawn = outline_at_level(field, _LIFT).outline
    except InputError:
        return Outline(())
    large = [region for region in drawn.regions if ring_area(region.outer) >= _LEAST_CELLS]
    return Outline(tuple(region.without_holes_below(_LEAST_CELLS) for region in large))
