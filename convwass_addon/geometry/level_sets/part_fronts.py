# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts that only one of several solids has: how far along a part every cell lies, and how far the part goes.

What solids share is their core. A part that touches several large components of the core is a link.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation, find_objects, gaussian_filter, label, maximum_filter
from skimage.graph import MCP_Geometric

from ..arrays.steps import linear_step
from ..grids.boxes import Box, grown_box

# Components of an intersection are large from this fraction of the largest one on.
_LARGE = 0.05
# Links join components from this fraction of the largest one on: smaller ones may be gone in the next blend.
_LINKED = 0.1
# Links that fill at most this fraction of their solid are light. A block that becomes two pads is none between them:
# held whole, it would have far too much volume.
_LIGHT = 0.4
# Distances are smoothed and extended beyond a part by a Gaussian of this many cells, truncated at so many deviations.
_BLUR, _TRUNCATE = 1.0, 3.0
# Cells around a part in its box.
_MARGIN = int(np.ceil(_BLUR * _TRUNCATE)) + 1
# Cells whose distances differ by less than this count as equally far.
_LAYER = 0.5
# Height where there is no part nearby.
_FAR = np.float32(1e3)
# A part is slender where its solid fills less than the first fraction of the space around, and broad from the second
# on; at a flat face, a half is filled. Around is within a Gaussian of so many cells, and at least of this fraction of
# the longest side, truncated at so many deviations. Chosen by eye on a cup whose handle retracts while its wall grows,
# and on a ball to a knot.
_SLENDER, _BROAD = 0.35, 0.5
_AROUND, _ABOUT, _REACH = 4.0, 1.0 / 16.0, 2.0
# The fronts of links are further by the first number times their weight to the power of the second, so that links close
# late and completely.
_CLOSED, _LATE = 3.0, 5
# Links taper within this number of halves of their thickness.
_TAPER = 2.0
# Where it is not slender, a front is held back by this many cells.
_HELD = 4.0
# Parts up to this length, in cells, need no front; fronts of parts that are longer by the second number count fully.
SHORT, _LONGER = 3.0, 2.0
# Nor do stout parts: those whose largest depth is more than the second fraction of their length. Up to the first, parts
# are not stout. The corner of a cube has 0.58.
_LEAN, _STOUT = 0.35, 0.65
# Cells around what is farther than `SHORT` from the other solids that count as the same part.
_BASE = int(np.ceil(SHORT)) + 1


def shared_core(solids: Sequence[NDArray[np.bool_]]) -> NDArray[np.bool_] | None:
    """Return the large components of the intersection of solids; None if they have nothing in common.

    Small ones, such as where two limbs cross, belong to the parts of the solids.
    """
    common = np.logical_and.reduce(list(solids))
    return _large_components(common, _LARGE) > 0 if common.any() else None


def _large_components(cells: NDArray[np.bool_], share: float) -> NDArray[np.int32]:
    """Return the numbers, from 1, of components of at least a share of the largest one; 0 in all other cells."""
    names, _ = label(cells, np.ones((3,) * cells.ndim))
    sizes = np.bincount(names.ravel())
    sizes[0] = 0
    large = (sizes >= share * sizes.max()) & (sizes > 0)
    return (np.cumsum(large) * large).astype(np.int32)[names]


@dataclass(frozen=True)
class SeparatePart:
    """Some of the parts of a solid, in a box of its grid.

    Attributes
    ----------
    box : Box
        Large enough for :class:`PartFronts`.
    cells : (mx, my, mz) bool
        The cells of the parts in the box.
    without_front : (mx, my, mz) float32
        How little a front counts in each cell: 0 if fully, up to 1 if not at all.
    links : (mx, my, mz) float32
        Half the thickness of links in cells, 0 elsewhere.
    """

    box: Box
    cells: NDArray[np.bool_]
    without_front: NDArray[np.float32]
    links: NDArray[np.float32]

    @property
    def fronted(self) -> NDArray[np.bool_]:
        """The cells in which a front counts."""
        return self.cells & (self.without_front < 1.0)


def linked_components(core: NDArray[np.bool_]) -> NDArray[np.int32]:
    """Return the numbers, from 1, of the components of a core that links join; 0 in all other cells."""
    return _large_components(core, _LINKED)


def separate_parts(
    solid: NDArray[np.bool_],
    core: NDArray[np.bool_],
    components: NDArray[np.int32],
    depth: NDArray[np.floating],
    beyond: NDArray[np.floating],
    known: float,
) -> list[SeparatePart]:
    """Separate the parts of a solid that need a front, each in its own box, or all in the whole grid if it is smaller.

    Light links always need one.

    The mean of signed distances at the weight w leaves the length r w / (1 - w) of a part of half thickness r; a long
    part vanishes at once. A cone with the depth k x at the distance x from its tip retracts by at most 1 / k times its
    length per unit of the weight. Short and stout parts, like the corners of a cube, therefore need no front. Where
    thin layers connect parts, such as the ears of a head that becomes smaller, each part is judged by itself.

    Parameters
    ----------
    solid : (nx, ny, nz) bool
        Also (nx, ny).
    core : (nx, ny, nz) bool
        A subset of it.
    components : (nx, ny, nz) int32
        Its components that links join; see :func:`linked_components`.
    depth : (nx, ny, nz)
        Distances from the surface of the solid, in cells.
    beyond : (nx, ny, nz)
        Distances from the other solids, in cells; their maximum is the length of a part.
    known : float
        Distances are clipped here.
    """
    cells, filled = solid & ~core, np.count_nonzero(solid)
    names, count = label(cells, np.ones((3,) * cells.ndim))
    linking, links = _linking(names, count, components), np.zeros(cells.shape, np.float32)
    without, boxes = np.ones(cells.shape, np.float32), {}
    for name, box in enumerate(find_objects(names), start=1):
        own = names[box] == name
        if linking[name] and np.count_nonzero(own) <= _LIGHT * filled:
            inner = np.where(own, depth[box], 0.0)
            half = maximum_filter(inner, 2 * int(np.ceil(inner.max())) + 1)
            links[box][own], without[box][own] = half[own], 0.0
        else:
            without[box][own] = _without_fronts(own, depth[box], beyond[box], known)[own]
        if without[box].min(where=own, initial=1.0) < 1.0:
            boxes[name] = grown_box(box, cells.shape, _MARGIN)
    if sum(names[box].size for box in boxes.values()) > cells.size:
        whole = tuple(slice(0, size) for size in cells.shape)
        return [SeparatePart(whole, np.isin(names, list(boxes)), without, links)]
    return [
        SeparatePart(box, own := names[box] == name, without[box], np.where(own, links[box], np.float32(0.0)))
        for name, box in boxes.items()
    ]


def _linking(names: NDArray[np.int32], count: int, components: NDArray[np.int32]) -> NDArray[np.bool_]:
    """Return which of some named parts are links, (count + 1,)."""
    around = np.ones((3,) * names.ndim)
    links = np.zeros(count + 1, bool)
    if components.max() < 2:
        return links
    for name, box in enumerate(find_objects(names), start=1):
        near = grown_box(box, names.shape, 1)
        touched = components[near][binary_dilation(names[near] == name, around)]
        links[name] = len(np.unique(touched[touched > 0])) > 1
    return links


def _without_fronts(
    part: NDArray[np.bool_], depth: NDArray[np.floating], beyond: NDArray[np.floating], known: float
) -> NDArray[np.float32]:
    """Return how little a front counts in every cell of a part, from 0 to 1, by the depth and the length around it."""
    without = np.ones(part.shape, np.float32)
    tips, _ = label(part & (beyond > SHORT), np.ones((3,) * part.ndim))
    for tip, box in enumerate(find_objects(tips), start=1):
        length = float(beyond[box].max(where=tips[box] == tip, initial=0.0))
        around = grown_box(box, part.shape, _BASE)
        near = maximum_filter(tips[around] == tip, 2 * _BASE + 1) & part[around]
        largest = float(depth[around].max(where=near, initial=0.0))
        # Distances may be a cell too short.
        value = _without_front(largest, length if length < known - 1.0 else np.inf)
        without[around][near] = np.minimum(without[around][near], value)
    return without


def _without_front(depth: float, length: float) -> float:
    """Return how little the front of a part of some largest depth and some length counts, from 0 to 1."""
    longer = (length - SHORT) / _LONGER
    if longer <= 0.0:
        return 1.0
    lean = (_STOUT - depth / length) / (_STOUT - _LEAN)
    return 1.0 - float(np.clip(lean, 0.0, 1.0) * min(longer, 1.0))


@dataclass(frozen=True)
class PartFronts:
    """The fronts up to which the parts of a solid are included while they grow out of a core or retract into it.

    Every cell of a part has a distance from the core along the part, and a reach: the largest distance to which the
    part goes on from there. At a weight w, the part is included up to the distance w times its reach, so it grows
    evenly, and what is included is connected to the core. An arc between two places of the core opens in its middle.
    Links have a weight of their own: if it is relative to the largest weight of a solid, those of one solid are whole
    until those of another one are.

    Attributes
    ----------
    distance, reach : (nx, ny, nz) float32
        In cells; smoothed, and extended by three cells.
    near : (nx, ny, nz) bool
        Where these are known.
    hold : (nx, ny, nz) float32
        How far a front is held back where the part is not slender, or does not need it, in cells.
    loose : (nx, ny, nz) bool
        Parts that are not connected to the core.
    links : (nx, ny, nz) float32
        1 in links, 0 elsewhere, smoothed likewise.
    thins : (nx, ny, nz) float32
        By how much links can be thinned from each side, in cells: half their thickness, less next to the core.
    """

    distance: NDArray[np.float32]
    reach: NDArray[np.float32]
    near: NDArray[np.bool_]
    hold: NDArray[np.float32]
    loose: NDArray[np.bool_]
    links: NDArray[np.float32]
    thins: NDArray[np.float32]

    @classmethod
    def of(cls, solid: NDArray[np.bool_], core: NDArray[np.bool_], part: SeparatePart) -> PartFronts:
        """Measure some parts of a solid in their box.

        Parameters
        ----------
        solid : (nx, ny, nz) bool
            Also (nx, ny).
        core : (nx, ny, nz) bool
            A subset of it.
        part : SeparatePart
            Some parts of what is in the solid and not in the core.
        """
        around = _filled_around(solid, part.box)
        measured = Along.of(part.cells, core[part.box])
        known = np.isfinite(measured.distance) & part.cells
        slender = linear_step(around[known], _BROAD, _SLENDER)
        hold = np.zeros(known.shape, np.float32)
        hold[known] = _HELD * (1.0 - slender) + part.without_front[known] * measured.reach[known]
        distance = np.where(known, measured.distance - np.float32(0.5), np.float32(0.0))
        share = _smooth(known.astype(np.float32))
        scale = np.float32(1.0) / np.maximum(share, np.float32(1e-3))
        links = (known & (part.links > 0.0)).astype(np.float32)
        thins = np.where(known, np.minimum(part.links, distance / np.float32(_TAPER)), np.float32(0.0))
        # Most parts are no links, and smoothing zeros takes as long as anything else.
        linking, thinned = (_smooth(values) * scale for values in (links, thins)) if links.any() else (links, thins)
        along, far, held = (_smooth(values) * scale for values in (distance, measured.reach, hold))
        return cls(along, far, share > 1e-3, held, part.cells & ~known, linking, thinned)

    def heights(self, weight: float, link_weight: float, beyond: float = 0.0) -> NDArray[np.float32]:
        """Return by how many cells the front is beyond every cell; large far from all parts.

        Parameters
        ----------
        weight, link_weight : float
            Of parts and, instead, of those that are links, from 0 to 1.
        beyond : float
            By how many cells the front is beyond the tips of parts at a weight of 1. The fronts of a link meet, so
            they are three times as far beyond at a link weight of 1, which they approach late.
        """
        share = np.float32(weight) + self.links * np.float32(link_weight - weight)
        further = np.float32(weight) + self.links * np.float32(_CLOSED * link_weight**_LATE - weight)
        return np.where(self.near, share * self.reach + np.float32(beyond) * further - self.distance, _FAR)


@dataclass(frozen=True)
class Along:
    """Measures of every cell of a part, from a core outwards.

    Attributes
    ----------
    distance : (nx, ny, nz) float32
        From the core along the part, in cells from center to center; zero in the core, infinite where no path leads.
    reach : (nx, ny, nz) float32
        The largest distance on any path from here along which distances increase.
    """

    distance: NDArray[np.float32]
    reach: NDArray[np.float32]

    @classmethod
    def of(cls, part: NDArray[np.bool_], core: NDArray[np.bool_]) -> Along:
        """Measure the cells of parts, (nx, ny, nz) or (nx, ny), beside a core."""
        distance = np.full(core.shape, np.inf, np.float32)
        distance[core] = 0.0
        rim = core & binary_dilation(part, np.ones((3,) * core.ndim))
        if not rim.any():
            return cls(distance, np.zeros_like(distance))
        paths = MCP_Geometric(np.where(part | rim, 1.0, np.inf), fully_connected=True)
        found, _ = paths.find_costs([tuple(cell) for cell in np.argwhere(rim)])
        distance[part] = found[part]
        around = np.pad(distance, 1, constant_values=np.inf)
        flat = around.ravel()
        steps = np.ravel_multi_index(np.indices((3,) * core.ndim).reshape(core.ndim, -1), around.shape)
        steps = steps - steps[len(steps) // 2]
        reach = np.zeros(flat.shape, np.float32)
        for layer in reversed(_layers(flat)):
            reach[layer] = np.maximum(flat[layer], reach[layer[:, None] + steps].max(axis=1))
        return cls(distance, reach.reshape(around.shape)[(slice(1, -1),) * core.ndim])


def _layers(distances: NDArray[np.float32]) -> list[NDArray[np.int64]]:
    """Group the cells of finite positive distance by it, in rising order."""
    cells = np.flatnonzero(np.isfinite(distances) & (distances > 0.0))
    cells = cells[np.argsort(distances[cells], kind="stable")]
    return np.split(cells, np.flatnonzero(np.diff((distances[cells] / _LAYER).astype(np.int64))) + 1)


def _filled_around(solid: NDArray[np.bool_], box: Box) -> NDArray[np.float32]:
    """Return the fraction of the space around every cell of a box that a solid fills."""
    width = max(_AROUND, _ABOUT * max(solid.shape))
    outer = grown_box(box, solid.shape, int(np.ceil(_REACH * width)))
    filled = gaussian_filter(solid[outer].astype(np.float32), width, truncate=_REACH)
    return filled[tuple(slice(a.start - b.start, a.stop - b.start) for a, b in zip(box, outer, strict=True))]


def _smooth(values: NDArray[np.float32]) -> NDArray[np.float32]:
    return gaussian_filter(values, _BLUR, truncate=_TRUNCATE)
