# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Flat shapes as closed curves around regions and holes, to which points are added where others have more of these."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ...geometry.plane.closed_curves import ClosedCurve, boundary_of, opened_curve
from ...geometry.plane.planar_fill import Boundary
from ...geometry.plane.ring_nesting import outline_of
from .outline_curves import OutlineCurve, sharp_corners

# Corners at which curves touch are cut by this, relative to the square root of the area.
_GAP = 2e-3
# Pieces of a region are smaller by this share than what is cut from it, so that they do not touch.
_PIECE = 1e-3
# Width of a slit that connects a hole to the outside, relative to the square root of the area.
_SLIT = 0.004
# Extent of a hole or a region that grows from a point, relative to the square root of the area.
_POINT = 0.004
# Least distance of such a hole from the outline, relative to the square root of the area; and cells along both sides
# of the grid on which its place is sought.
_INSIDE, _CELLS = 0.03, 64


@dataclass(frozen=True)
class OutlinedRegion:
    """A connected area of a flat shape.

    Attributes
    ----------
    outer : int
        Index of the curve around it.
    holes : tuple of int
        Indices of the curves around its holes.
    points : tuple of int
        Indices of tiny curves that are holes of other shapes.
    is_point : bool
        Whether it is itself a tiny copy of a region of another shape.
    """

    outer: int
    holes: tuple[int, ...]
    points: tuple[int, ...] = ()
    is_point: bool = False

    @property
    def rim(self) -> tuple[int, ...]:
        """Indices of the curves that bound it."""
        return (self.outer, *self.holes)

    @property
    def curves(self) -> tuple[int, ...]:
        """Indices of all its curves."""
        return (*self.rim, *self.points)

    def moved(self, first: int) -> OutlinedRegion:
        """Return the region with indices that are larger by a number."""
        holes, points = (tuple(index + first for index in own) for own in (self.holes, self.points))
        return replace(self, outer=self.outer + first, holes=holes, points=points)


@dataclass(frozen=True)
class OutlinedShape:
    """A flat shape as closed curves.

    Attributes
    ----------
    filled : Boundary
        The shape.
    curves : tuple of ClosedCurve
        Curves around its regions and holes, and points that are those of other shapes.
    regions : tuple of OutlinedRegion
        Its regions, and points that are regions of other shapes.
    marks : (k, 2) float64
        Points of the curves that triangles have as vertices, such as the ends of cuts.
    """

    filled: Boundary
    curves: tuple[ClosedCurve, ...]
    regions: tuple[OutlinedRegion, ...]
    marks: NDArray[np.float64] = field(default_factory=lambda: np.empty((0, 2)))

    @classmethod
    def of(cls, filled: Boundary) -> OutlinedShape:
        """Divide a boundary into curves."""
        outline = outline_of(filled)
        curves = _apart([ClosedCurve(ring) for ring in outline.rings], _GAP * filled.root_area)
        regions, first = [], 0
        for region in outline.regions:
            regions.append(OutlinedRegion(0, tuple(range(1, len(region.rings)))).moved(first))
            first += len(region.rings)
        return cls(filled, tuple(curves), tuple(regions))

    @property
    def region_places(self) -> NDArray[np.float64]:
        """Centers of the regions, relative to that of the shape, and square roots of their areas, (n, 3).

        Their holes are filled for it. Regions with similar rows are near each other and similar in size.
        """
        filled = [boundary_of([self.curves[region.outer]]) for region in self.regions]
        centers = np.array([own.center for own in filled]) - self.filled.center
        return np.column_stack([centers, np.sqrt([own.area for own in filled])])

    def knots(self, index: int) -> NDArray[np.float64]:
        """Return the places on a curve that triangles have as vertices: of its corners and marks."""
        curve = self.curves[index]
        return np.concatenate([sharp_corners(curve), curve.places_of(self.marks)])

    def center(self, index: int) -> NDArray[np.float64]:
        """Center of what a curve encloses, (2,)."""
        return boundary_of([self.curves[index]]).center

    def rim(self, region: OutlinedRegion) -> list[ClosedCurve]:
        """Return the curves around a region and its holes."""
        return [self.curves[index] for index in region.rim]

    def share(self, region: OutlinedRegion) -> float:
        """Return the share of the area that a region has."""
        return boundary_of(self.rim(region)).area / self.filled.area

    def curve(self, index: int) -> OutlineCurve:
        """Return a curve to be matched."""
        around = next(region for region in self.regions if index in region.rim)
        return OutlineCurve(self.curves[index], boundary_of(self.rim(around)), self.center(index))

    def divided(self, pieces: Sequence[Sequence[Boundary]]) -> OutlinedShape:
        """Return the shape with each of its regions divided into pieces; one with a single piece stays as it is."""
        parts: list[OutlinedShape] = []
        for region, own in zip(self.regions, pieces, strict=True):
            if len(own) == 1:
                parts.append(self._only(region))
            else:
                parts.extend(OutlinedShape.of(piece.moved(_PIECE * piece.center, 1.0 - _PIECE)) for piece in own)
        return self._of(parts)

    def _of(self, parts: Iterable[OutlinedShape]) -> OutlinedShape:
        """Return the shape with the regions of parts instead."""
        curves: list[ClosedCurve] = []
        regions: list[OutlinedRegion] = []
        for part in parts:
            regions.extend(each.moved(len(curves)) for each in part.regions)
            curves.extend(part.curves)
        return replace(self, curves=tuple(curves), regions=tuple(regions))

    def _only(self, region: OutlinedRegion) -> OutlinedShape:
        """Return the shape without all other regions."""
        curves = tuple(self.curves[index] for index in region.curves)
        count = len(region.rim)
        alone = replace(region, outer=0, holes=tuple(range(1, count)), points=tuple(range(count, len(curves))))
        return replace(self, curves=curves, regions=(alone,))

    def with_region(self, rim: Sequence[ClosedCurve], place: NDArray[np.float64]) -> OutlinedShape:
        """Return the shape with a tiny copy of another shape's region at a place, (2,)."""
        tiny = self._tiny(rim, place)
        region = OutlinedRegion(0, tuple(range(1, len(tiny))), is_point=True).moved(len(self.curves))
        return replace(self, curves=(*self.curves, *tiny), regions=(*self.regions, region))

    def opened(self, index: int, hole: int, places: tuple[float, float]) -> OutlinedShape:
        """Return the shape with a hole of a region connected to the outside by a slit.

        Parameters
        ----------
        index : int
            Index of the region.
        hole : int
            Index of the curve around the hole.
        places : (float, float)
            Ends of the slit, as places on the curve around the region and on that around the hole.
        """
        region = self.regions[index]
        outer = opened_curve(self.curves[region.outer], self.curves[hole], places, _SLIT * self.filled.root_area)
        holes = tuple(own for own in region.holes if own != hole)
        whole = self._changed(index, replace(region, outer=len(self.curves), holes=holes), [outer])
        # Without the curves that the slit has connected.
        return self._of(whole._only(own) for own in whole.regions)

    def with_point(self, hole: ClosedCurve, place: NDArray[np.float64], region: int) -> OutlinedShape | None:
        """Return the shape with a tiny copy of another shape's hole in a region, near a place; None without room."""
        own = self.regions[region]
        filled = boundary_of(self.rim(own))
        steps = (np.arange(_CELLS) + 0.5) / _CELLS
        x, y = np.meshgrid(*(low + (high - low) * steps for low, high in filled.bounds.T), indexing="ij")
        cells = np.concatenate([place[None], np.stack([x.ravel(), y.ravel()], axis=1)])
        spacing = _INSIDE * self.filled.root_area / 3.0
        around = [self.curves[index] for index in own.curves]
        rim = np.concatenate([curve.resampled(curve.starts[:-1], spacing).points for curve in around])
        free = filled.contains(cells) & (cKDTree(rim).query(cells)[0] > _INSIDE * self.filled.root_area)
        if not free.any():
            return None
        spot = cells[free][np.square(cells[free] - place).sum(axis=1).argmin()]
        return self._changed(region, replace(own, points=(*own.points, len(self.curves))), self._tiny([hole], spot))

    def _changed(self, index: int, region: OutlinedRegion, added: Sequence[ClosedCurve]) -> OutlinedShape:
        """Return the shape with another region in the place of one, and with more curves."""
        regions = (*self.regions[:index], region, *self.regions[index + 1 :])
        return replace(self, curves=(*self.curves, *added), regions=regions)

    def _tiny(self, rim: Sequence[ClosedCurve], place: NDArray[np.float64]) -> list[ClosedCurve]:
        """Return tiny copies of curves, of which the first is around the others, at a place."""
        center = boundary_of(rim[:1]).center
        scale = _POINT * self.filled.root_area / np.ptp(rim[0].points, axis=0).max()
        return [ClosedCurve(place + (curve.points - center) * scale) for curve in rim]


def _apart(curves: list[ClosedCurve], gap: float) -> list[ClosedCurve]:
    """Cut the corners at which curves touch each other or themselves, so that they can move apart."""
    points = np.concatenate([curve.points for curve in curves])
    _, index, counts = np.unique(points, axis=0, return_inverse=True, return_counts=True)
    touches = np.split(counts[index.ravel()] > 1, np.cumsum([len(curve.points) for curve in curves])[:-1])
    found = []
    for curve, own in zip(curves, touches, strict=True):
        lengths = np.diff(curve.starts)
        before, after = (np.minimum(gap, 0.5 * own_lengths) for own_lengths in (np.roll(lengths, 1), lengths))
        kept, cut = curve.starts[:-1][~own], curve.starts[:-1][own]
        places = np.sort(np.concatenate([kept, cut - before[own], cut + after[own]]))
        found.append(ClosedCurve(curve.at(places)) if own.any() else curve)
    return found
