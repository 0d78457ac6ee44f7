# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Regions of one color within flat blends: the layers of the inputs, carried along by the transport maps.

Matter of a blend that comes from one layer on every input has one color, the mean of theirs. A region of the blend is
where these layers are the same; it is read like an outline, from a field that is positive there.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_erosion

from ...errors import InputError
from ...geometry.contours import outline_at_level
from ...geometry.flat_mending import FlatMending
from ...geometry.outlines import Outline, ring_area
from ..morphs.layouts import Blend
from .flat_frames import ColoredOutline
from .flat_origins import FlatOrigins, MovedOrigins
from .flat_problem import FlatProblem

# How fast a field leaves zero at a border between layers, beside its fall at the edge of the blend; and by how much
# regions reach over such a border, so that curves fitted to either side leave no gap; and at most where three
# meet, or two at the edge of the blend.
_STEEP, _OVERLAP, _MEETING = 4.0, 0.15, 3.0
_ALL_AROUND = np.ones((3, 3), bool)
# Fields are lifted by this: beyond the grid there is nothing.
_LIFT = 16.0
# What is smaller, in cells, is no region and no hole.
_LEAST_CELLS = 4.0


def colored_regions(
    problem: FlatProblem, blend: Blend, mending: FlatMending, origins: FlatOrigins | MovedOrigins
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
    origins : FlatOrigins or MovedOrigins
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
