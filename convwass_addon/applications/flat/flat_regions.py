# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Regions of one color in flat blends, from the layers of the inputs and the transport maps.

A region consists of the points whose origins lie on one layer of every input; its color is the mean of the layers'
colors. Its outline is extracted from a field that is positive there.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_erosion

from ...errors import InputError
from ...geometry.level_sets.contours import outline_at_level
from ...geometry.level_sets.flat_mending import FlatMending
from ...geometry.plane.outlines import Outline, ring_area
from ..morphs.layouts import Blend
from .flat_frames import ColoredOutline
from .flat_origins import FlatOrigins, MovedOrigins
from .flat_problem import FlatProblem

# Slope of a field at a border between layers, relative to its slope at the edge of the blend. Regions overlap at such a
# border by the second number, so that fitted curves leave no gap, and by at most the third where three regions meet, or
# two at the edge of the blend.
_STEEP, _OVERLAP, _MEETING = 4.0, 0.15, 3.0
_ALL_AROUND = np.ones((3, 3), bool)
# Added to fields, because they count as zero outside the grid.
_LIFT = 16.0
# Regions and holes of fewer cells are dropped.
_LEAST_CELLS = 4.0


def colored_regions(
    problem: FlatProblem, blend: Blend, mending: FlatMending, origins: FlatOrigins | MovedOrigins
) -> tuple[ColoredOutline, ...]:
    """Divide a blend into regions of one color.

    Parameters
    ----------
    problem : FlatProblem
        The problem, with the layers of its shapes.
    blend : Blend
        The blend.
    mending : FlatMending
        Its outline in cells, and the density that it was extracted from.
    origins : FlatOrigins or MovedOrigins
        Origins of its matter.

    Returns
    -------
    tuple of ColoredOutline
        In scene units, largest first. Neighbors overlap by a fraction of a cell.
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
    # Inside the blend, only colors determine borders: a field that is cut off on one side would move them.
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
    """Yield all combinations of one layer per input that occur anywhere."""
    chosen = [[layer for layer, own in enumerate(each) if (own > 0).any()] for each in margins]
    yield from product(*chosen)


def _where_three_meet(margins: Sequence[NDArray[np.float64]]) -> NDArray[np.float64] | float:
    """Return the additional overlap of regions that closes gaps between three of them."""
    if len(margins) < 3:
        return 0.0
    third = np.partition(np.stack(margins), -3, axis=0)[-3]
    return np.maximum(_MEETING + third, 0.0)


def _outline(field: NDArray[np.float64]) -> Outline:
    """Extract the outline of a lifted field's positive part, without specks."""
    try:
        drawn = outline_at_level(field, _LIFT).outline
    except InputError:
        return Outline(())
    large = [region for region in drawn.regions if ring_area(region.outer) >= _LEAST_CELLS]
    return Outline(tuple(region.without_holes_below(_LEAST_CELLS) for region in large))
