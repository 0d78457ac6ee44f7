# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Which limbs of flat shapes the others have not, such as the lowest stroke of an E that becomes an F.

An outline with a limb that is mapped to one without it becomes a wedge on the way. Without the limb, they match better.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ...geometry.plane.closed_curves import ClosedCurve, boundary_of
from ...geometry.plane.outline_limbs import OutlineLimb, outline_limbs, without_limb
from ...progress import Control
from .matched_outlines import rough_work
from .outline_curves import OutlineCurve
from .outline_pairs import KnownMatches, region_pairs
from .outlined_shape import OutlinedRegion, OutlinedShape

# Limbs vanish if outlines match with less than this share of the work without one, and with its square without two. By
# eye, an E that becomes an F (0.01), a y that becomes a K (0.39) and a 1 that becomes a 7 (0.59) are better so, and a K
# that becomes a 0 (0.44 without three limbs) is not.
_CLEARLY_LESS = 0.63
# Least and largest share of the area of a region that a limb has.
_AREAS = 0.02, 0.3
# Bodies match with less work than this; a d and an F without arms (0.45) do not.
_MOST_WORK = 0.36
# Outlines that match with less work than the first number keep all limbs, and with less than the second one those that
# are left. The search ends when one limb less leaves more than the third share of the work, and after the last number.
_ALIKE, _MATCHED, _LESS, _MOST = 0.15, 0.03, 0.9, 4

Place = tuple[int, int]
"""A shape and one of its regions."""


@dataclass(frozen=True)
class ShapeBody:
    """A flat shape without some of its limbs.

    Attributes
    ----------
    shape : OutlinedShape
        The shape without them.
    limbs : tuple of OutlineLimb
        The limbs, each of the outline that is left without those before it.
    """

    shape: OutlinedShape
    limbs: tuple[OutlineLimb, ...] = ()


@dataclass(frozen=True)
class _Region:
    """A region of a shape without some of its limbs.

    Attributes
    ----------
    outer : ClosedCurve
        The curve around what is left.
    holes : tuple of ClosedCurve
        Those around its holes.
    area : float
        The area inside the curve around the whole region.
    limbs : tuple of OutlineLimb
        The limbs that it lacks, in the order in which they were cut off.
    """

    outer: ClosedCurve
    holes: tuple[ClosedCurve, ...]
    area: float
    limbs: tuple[OutlineLimb, ...] = ()

    @classmethod
    def of(cls, shape: OutlinedShape, region: OutlinedRegion) -> _Region:
        """Return a whole region of a shape."""
        outer, *holes = shape.rim(region)
        return cls(outer, tuple(holes), boundary_of([outer]).area)

    @cached_property
    def outline(self) -> OutlineCurve:
        """The curve around what is left, with what it is compared by."""
        return OutlineCurve(self.outer, boundary_of([self.outer, *self.holes]), boundary_of([self.outer]).center)

    def shorter(self) -> Iterator[_Region]:
        """Yield the region without one more limb."""
        for limb in outline_limbs(self.outer, self.holes, tuple(share * self.area for share in _AREAS)):
            yield replace(self, outer=without_limb(limb), limbs=(*self.limbs, limb))


@dataclass(frozen=True)
class _Regions:
    """The regions of all shapes.

    Attributes
    ----------
    regions : mapping of (int, int) to _Region
        By shape and by index in it.
    links : tuple of ((int, int), (int, int))
        Regions that become each other.
    """

    regions: Mapping[Place, _Region]
    links: tuple[tuple[Place, Place], ...]

    def work(self, link: tuple[Place, Place]) -> float:
        """Return the mean work of all matches of two regions that become each other."""
        own = [each for each in self.links if set(each) & set(link)]
        return float(np.mean([rough_work(*(self.regions[place].outline for place in each)) for each in own]))

    def limb_count(self, link: tuple[Place, Place]) -> int:
        """Return the number of limbs that two regions lack."""
        return sum(len(self.regions[place].limbs) for place in link)

    def are_symmetric(self, link: tuple[Place, Place]) -> bool:
        """Return whether both of two regions that become each other have an axis of symmetry."""
        return all(self.regions[place].outline.axes.is_best.any() for place in link)

    def shorter(self, link: tuple[Place, Place]) -> Iterator[_Regions]:
        """Yield the regions without one more limb of those that become each other."""
        for place in link:
            for region in self.regions[place].shorter():
                yield replace(self, regions={**self.regions, place: region})


def shape_bodies(
    shapes: Sequence[OutlinedShape], pairs: Sequence[tuple[int, int]], known: KnownMatches, control: Control
) -> list[ShapeBody]:
    """Return shapes without the limbs that vanish.

    All limbs stay if shapes have different numbers of regions, and those of regions with different numbers of holes,
    where outlines change most.

    Parameters
    ----------
    shapes : sequence of OutlinedShape
        The shapes.
    pairs : sequence of (int, int)
        Shapes that occur together in a blend.
    known : KnownMatches
        Matches of their outlines.
    control : Control
        Stops the work.
    """
    if len({len(shape.regions) for shape in shapes}) > 1:
        return [ShapeBody(shape) for shape in shapes]
    regions = {
        (index, number): _Region.of(shape, own)
        for index, shape in enumerate(shapes)
        for number, own in enumerate(shape.regions)
    }
    links = tuple(
        ((one, own), (other, there)) for one, other in pairs for own, there in region_pairs(shapes[one], shapes[other])
    )
    found = _Regions(regions, links)
    for link in links:
        if len({len(regions[place].holes) for place in link}) > 1:
            continue
        shorter = _without_vanishing(found, link, control)
        if shorter is not found:
            (one, own), (other, there) = link
            whole = known.of(shapes[one], own, shapes[other], there)[0]
            count = shorter.limb_count(link) - found.limb_count(link)
            # Shapes that turn may match with all limbs.
            turned = np.inf if whole.turn == 0.0 else whole.cost
            if turned > max(_ALIKE, shorter.work(link) / _CLEARLY_LESS**count):
                found = shorter
    return [
        _body(shape, [found.regions[index, number] for number in range(len(shape.regions))])
        for index, shape in enumerate(shapes)
    ]


def _without_vanishing(regions: _Regions, link: tuple[Place, Place], control: Control) -> _Regions:
    """Return regions without the limbs of two of them that vanish where these become each other.

    If both are symmetric, so is what is left of them.
    """
    control.check()
    # Matches take longer than the search for limbs, and most shapes have none.
    shorter = list(regions.shorter(link))
    if not shorter:
        return regions
    before = regions.work(link)
    if before < _ALIKE:
        return regions
    symmetric = regions.are_symmetric(link)
    best, least, last = regions, 1.0, before
    for count in range(1, _MOST + 1):
        control.check()
        works = [own.work(link) for own in shorter]
        current, work = shorter[int(np.argmin(works))], min(works)
        if work > _LESS * last:
            break
        last, share = work, work / (before * _CLEARLY_LESS**count)
        if work < _MOST_WORK and share < least and (current.are_symmetric(link) or not symmetric):
            best, least = current, share
        shorter = list(current.shorter(link))
        if work < _MATCHED or not shorter:
            break
    return best


def _body(shape: OutlinedShape, regions: Sequence[_Region]) -> ShapeBody:
    """Return a shape without the limbs that its regions lack."""
    limbs = tuple(limb for region in regions for limb in region.limbs)
    if not limbs:
        return ShapeBody(shape)
    curves = list(shape.curves)
    for own, region in zip(shape.regions, regions, strict=True):
        curves[own.outer] = region.outer
    marks = np.concatenate([limb.cut for limb in limbs])
    return ShapeBody(OutlinedShape(boundary_of(curves), tuple(curves), shape.regions, marks), limbs)
