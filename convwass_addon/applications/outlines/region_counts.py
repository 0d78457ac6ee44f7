# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Flat shapes of different numbers of regions: regions of one are divided, or those of the other grow from points."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from ...geometry.plane.closed_curves import ClosedCurve, boundary_of
from ...geometry.plane.line_cuts import cut_at_share
from ...geometry.plane.planar_fill import Boundary
from ...geometry.plane.ring_nesting import outline_of
from .outlined_shape import OutlinedShape

# Directions in which the centers of regions are compared.
_DIRECTIONS = np.eye(2)
# Largest share of the area of a piece that a cut separates from it, and that is left with the other piece.
_FRAGMENTS = 0.25


@dataclass(frozen=True)
class _Regions:
    """The regions of a shape, and their centers relative to that of the shape, and areas."""

    filled: tuple[Boundary, ...]
    centers: NDArray[np.float64]
    areas: NDArray[np.float64]

    @classmethod
    def of(cls, shape: OutlinedShape) -> _Regions:
        filled = tuple(boundary_of(shape.rim(region)) for region in shape.regions)
        centers = np.array([own.center for own in filled]) - shape.filled.center
        return cls(filled, centers, np.array([own.area for own in filled]))


def with_equal_counts(
    shapes: Sequence[OutlinedShape], pairs: Sequence[tuple[int, int]], least_share: float
) -> list[OutlinedShape]:
    """Return shapes of which those that occur together have equal numbers of regions.

    Every region of the shape that has more belongs to one of the other shape, near it and similar in size. Regions of
    the latter to which several belong are divided between them by straight cuts, in proportion to their areas.

    Parameters
    ----------
    shapes : sequence of OutlinedShape
        The shapes.
    pairs : sequence of (int, int)
        Shapes that occur together in a blend.
    least_share : float
        Regions with less than this share of the area of all that belong to the same one get no part of it, but grow
        from a point; the largest one never does.

    Returns
    -------
    list of OutlinedShape
        The shapes.
    """
    found = list(shapes)
    most = max(len(shape.regions) for shape in shapes)
    # Counts only grow, and at most to the largest one.
    for _ in range(most * len(shapes)):
        for one, other in pairs:
            few, many = sorted((one, other), key=lambda index: len(found[index].regions))
            if len(found[few].regions) < len(found[many].regions):
                found[few] = _with_regions_of(found[few], found[many], least_share)
    return found


def _with_regions_of(few: OutlinedShape, many: OutlinedShape, least_share: float) -> OutlinedShape:
    """Return a shape with as many regions as another one that has more."""
    ours, theirs = _Regions.of(few), _Regions.of(many)
    owner = _owners(few.region_places, many.region_places, theirs.areas)
    pieces, points = [], []
    for region, filled in enumerate(ours.filled):
        own = np.flatnonzero(owner == region)
        large = own[theirs.areas[own] >= min(least_share * theirs.areas[own].sum(), theirs.areas[own].max())]
        parts = _parts(filled, theirs.centers[large], theirs.areas[large])
        pieces.append(parts.pieces)
        points.extend(np.setdiff1d(own, large[parts.owners]).tolist())
    shape = few.divided(pieces)
    for index in points:
        shape = shape.with_region(many.rim(many.regions[index]), few.filled.center + theirs.centers[index])
    return shape


def _owners(ours: NDArray[np.float64], theirs: NDArray[np.float64], areas: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return the region of ours that each of theirs belongs to, (n,); every one of ours has at least one.

    The total work is least: area by squared distance of their places, see :attr:`.OutlinedShape.region_places`.
    """
    work = areas[:, None] * np.square(theirs[:, None] - ours).sum(axis=2)
    nearest = work.argmin(axis=1)
    rows, columns = linear_sum_assignment(
        np.column_stack([work, np.tile(work.min(axis=1)[:, None], len(theirs) - len(ours))])
    )
    return np.where(columns < len(ours), columns, nearest[rows])


@dataclass(frozen=True)
class _Parts:
    """A region divided between some of several others: the pieces, and the indices of those that have one."""

    pieces: list[Boundary]
    owners: list[int]


def _parts(filled: Boundary, centers: NDArray[np.float64], areas: NDArray[np.float64]) -> _Parts:
    """Divide a region between others, (k,), in proportion to their areas.

    As long as a cut would leave more than two pieces, the innermost of the others is left out.
    """
    chosen = np.arange(len(areas))
    while (pieces := _divided(filled, centers[chosen], areas[chosen])) is None:
        away = np.square(centers[chosen] - _mean(centers, areas, chosen)).sum(axis=1)
        chosen = np.delete(chosen, away.argmin())
    return _Parts(pieces, chosen.tolist())


def _divided(filled: Boundary, centers: NDArray[np.float64], areas: NDArray[np.float64]) -> list[Boundary] | None:
    """Divide a region between others, (k,); None if a cut would leave more than two pieces."""
    if len(centers) == 1:
        return [filled]
    groups = _separated(centers)
    if groups is None:
        return None
    behind, beyond = groups
    normal = _mean(centers, areas, beyond) - _mean(centers, areas, behind)
    pieces = _connected(*cut_at_share(filled, normal, areas[behind].sum() / areas.sum()))
    if pieces is None:
        return None
    found: list[Boundary | None] = [None] * len(centers)
    for group, piece in zip(groups, pieces, strict=True):
        divided = _divided(piece, centers[group], areas[group])
        if divided is None:
            return None
        for index, own in zip(group.tolist(), divided, strict=True):
            found[index] = own
    return found


def _separated(centers: NDArray[np.float64]) -> tuple[NDArray[np.int64], NDArray[np.int64]] | None:
    """Divide points into two groups at the widest gap along an axis; None if they coincide."""
    heights = centers @ _DIRECTIONS.T
    order = heights.argsort(axis=0, kind="stable")
    gaps = np.diff(np.take_along_axis(heights, order, axis=0), axis=0)
    place, axis = np.unravel_index(gaps.argmax(), gaps.shape)
    if gaps[place, axis] <= 0.0:
        return None
    return order[: place + 1, axis], order[place + 1 :, axis]


def _mean(points: NDArray[np.float64], weights: NDArray[np.float64], chosen: NDArray[np.int64]) -> NDArray[np.float64]:
    return weights[chosen] @ points[chosen] / weights[chosen].sum()


def _connected(behind: Boundary, beyond: Boundary) -> tuple[Boundary, Boundary] | None:
    """Return the pieces on both sides of a cut in one piece each: small fragments are left with the other side."""
    sides = [_regions_of(side) for side in (behind, beyond)]
    if any(not side for side in sides):
        return None
    found = []
    for (largest, *own), (_, *others) in (sides, sides[::-1]):
        if sum(piece.area for piece in own) > _FRAGMENTS * largest.area:
            return None
        whole = largest.united(others) if others else largest
        if len(_regions_of(whole)) != 1:
            return None
        found.append(whole)
    return found[0], found[1]


def _regions_of(filled: Boundary) -> list[Boundary]:
    """Return the regions of a filled area, the largest first."""
    return [boundary_of([ClosedCurve(ring) for ring in region.rings]) for region in outline_of(filled).regions]
