# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Register two shapes to each other from their map or, where that fails, from other starts.

Maps without guides confuse left and right, or map two fingers to one. Such errors cause stretch, distance and
round-trip errors. So each shape is also registered from its position at rest, by growing from where both coincide, and
by the inverse of the other shape's registration, and at every vertex the best result is taken.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...geometry.deformation.poisson_deformation import deformation_gradients
from ...geometry.deformation.registration import Stage
from ...geometry.meshes.mesh import is_level
from ...progress import Control
from ..workers import both_ways
from .carriers import Carrier, coarser
from .grown_registration import grown_points
from .laid_meshes import Laid, home_distances, registered
from .mirrored_sides import MirroredSides
from .pair_proposals import FROM_MAP, DraftPair, Proposal, agree, all_mended, evened, symmetrized, total_cost, trusted

# Number of vertices of the coarse meshes on which several starts are tried.
_DRAFT_VERTICES = 1500
# Strain at which robust weights fall, so that joints bend and the parts between them keep their lengths, and the stages
# with these weights (docs/performance, "Maps and registrations").
_GIVE = 0.2
_TIGHTENING = (Stage(30.0, 20.0, 0.05, 2, _GIVE), Stage(100.0, 0.0, 0.04, 6, _GIVE, 0.1))
# Another registration is taken if its energy, or what its confidence lacks, is less than this share, so that rounding
# does not decide.
_CLEARLY = 0.95
# Registrations of symmetric shapes are made symmetric if their cost is then at most this number of times as large. For
# fourteen pairs that look as good or better then, it is 0.96 to 1.05 and once 1.12 times; from a horse with a raised
# leg to a bird, whose wing was torn, 1.23 and 1.26 times.
_MOST_FOR_EVENNESS = 1.15
# The final registration. With a smaller give, proportions of different builds are met less closely; without any, or
# with more rounds, skin slides along a raised arm by a fifth of its length.
_FINISHING = (Stage(300.0, 0.0, 0.03, 4, 0.8),)
# With less confidence, strain is also spread, and what has clearly more confidence is taken. Between shapes of one
# build, strain belongs in joints. Where parts have no counterpart, their strain would fold and tear the surface.
_CONFIDENT, _SPREADING = 0.95, (Stage(300.0, 0.0, 0.03, 8),)
# The final registration of flat shapes: outlines show every bump that a closer one gives to the surface.
_FINISHING_FLAT = (Stage(100.0, 0.0, 0.06, 6),)
# If the misfit is at most this, no other starts are tried.
_FINE = 0.35
# If 99 % of the area have a round-trip error below the first number, and the misfit is below the second, a grown
# registration has lost no limb, and no map is needed. It follows guides within the first number.
_NO_LIMB, _FINE_GROWN = 0.15, 0.5
# Round-trip error, in sizes of the surface, at which the confidence is 0.6.
_MISSED = 0.08
_NO_PAIRS = np.empty((0, 2), np.int64)


@dataclass(frozen=True)
class LaidPair:
    """Two shapes registered to each other.

    Attributes
    ----------
    first, second : Laid
        Each shape on the other.
    confidence : float
        Mean confidence in the positions by area, 0 to 1; the lower one of both shapes.
    is_grown : bool
        Whether the registration was grown from where the shapes coincide, instead of started from the map.
    """

    first: Laid
    second: Laid
    confidence: float
    is_grown: bool = False


@dataclass(frozen=True)
class GrownPair:
    """Coarse meshes of two shapes, registered by growing from where the shapes coincide.

    Attributes
    ----------
    drafts : (Carrier, Carrier)
        The coarse meshes.
    found : list of Proposal
        The registrations.
    fits : bool
        Whether they are good enough to need no map.
    """

    drafts: tuple[Carrier, Carrier]
    found: list[Proposal]
    fits: bool

    def followed(self, pairs: NDArray[np.int64]) -> NDArray[np.bool_]:
        """Return whether both registrations bring the vertices of pairs, (k, 2), near to each other, (k,)."""
        near = np.ones(len(pairs), bool)
        for k, (own, other) in enumerate((self.drafts, self.drafts[::-1])):
            apart = self.found[k].points[own.places(pairs[:, k])] - other.rest.vertices[pairs[:, 1 - k]]
            near &= np.linalg.norm(apart, axis=1) < _NO_LIMB * other.mesh.root_area
        return near


def draft_of(shape: Carrier, control: Control, kept: NDArray[np.int64] = _NO_PAIRS[:, 0]) -> Carrier:
    """Return the coarse mesh of a shape on which several starts are tried, with the vertices `kept`, (k,)."""
    return coarser(shape, kept, _DRAFT_VERTICES, control)


def grown_pair(shapes: tuple[Carrier, Carrier], control: Control) -> GrownPair | None:
    """Register two shapes to each other by growing; return None if too little of them coincides as they stand."""
    drafts = both_ways(lambda k: draft_of(shapes[k], control))
    # Each direction needs both, and two threads would compute each twice.
    both_ways(lambda k: drafts[k].unit)
    grown = both_ways(lambda k: grown_points(drafts[k], drafts[1 - k], control))
    if any(points is None for points in grown):
        return None
    pair = DraftPair(drafts, _NO_PAIRS, control)
    found = [pair.judged(k, grown[k]) for k in (0, 1)]
    worse = int(found[1].misfit > found[0].misfit)
    other = found.copy()
    other[worse] = pair.proposed(worse, found[1 - worse].inverse, FROM_MAP)
    best = min(found, other, key=lambda both: total_cost(pair, both))
    near = all(agree(pair, best, k, 0.99, _NO_LIMB) for k in (0, 1))
    fits = near and max(own.misfit for own in best) <= _FINE_GROWN
    return GrownPair(drafts, best, fits)


def laid_on_each_other(
    shapes: tuple[Carrier, Carrier],
    starts: tuple[Laid, Laid] | None,
    pairs: NDArray[np.int64],
    grown: GrownPair | None,
    control: Control,
    sides: MirroredSides | None = None,
) -> LaidPair:
    """Register two shapes to each other, keeping each as similar to itself as possible.

    Parameters
    ----------
    shapes : (Carrier, Carrier)
        The two shapes.
    starts : (Laid, Laid) or None
        The positions and confidences that the map gives to the vertices of each, with confidence 0 where there is no
        map. None if the grown registration is good enough.
    pairs : (k, 2) int64
        Corresponding vertices of the two shapes.
    grown : GrownPair or None
        Another start, which follows the pairs.
    control : Control
        Stops the work.
    sides : MirroredSides, optional
        Left and right of the two shapes, which registrations started from the map should keep.

    Returns
    -------
    LaidPair
        With confidences from the round-trip errors.

    Raises
    ------
    InputError
        The map has no confidence at any vertex.
    """
    both = pairs, pairs[:, ::-1]
    drafts = both_ways(lambda k: draft_of(shapes[k], control, both[k][:, 0])) if grown is None else grown.drafts
    ends = np.stack([drafts[k].places(pairs[:, k]) for k in (0, 1)], axis=1)
    coarse = DraftPair(drafts, ends, control)
    if starts is None:
        drafted, is_grown, kept = [trusted(found) for found in grown.found], True, None
    else:
        rough = [
            Laid(start.points[own.seeds], start.trust[own.seeds]) for start, own in zip(starts, drafts, strict=True)
        ]
        kept = None if sides is None else MirroredSides((drafts[0].mesh, drafts[1].mesh), sides.planes)
        drafted, is_grown = _drafted(coarse, rough, grown, kept)
    drafted = _tightened(coarse, drafted, kept)

    fine = carried(drafts[0], drafted[0]), carried(drafts[1], drafted[1])
    return replace(_finely(shapes, fine, both, control), is_grown=is_grown)


def carried(draft: Carrier, laid: Laid) -> Laid:
    """Return the registration of a coarse mesh at the vertices of the mesh that it represents."""
    gradients = deformation_gradients(draft.mesh.vertices, laid.points, draft.mesh.faces)
    return Laid(draft.carried(laid.points, gradients), laid.trust if draft.blend is None else draft.blend @ laid.trust)


def _finely(
    shapes: tuple[Carrier, Carrier],
    starts: tuple[Laid, Laid],
    both: tuple[NDArray[np.int64], NDArray[np.int64]],
    control: Control,
) -> LaidPair:
    """Register all vertices of two shapes from starts, and spread strain if that is more consistent."""
    if all(is_level(shape.mesh.vertices) for shape in shapes):
        return _finished(shapes, starts, both, _FINISHING_FLAT, control)
    found = _finished(shapes, starts, both, _FINISHING, control)
    if found.confidence >= _CONFIDENT:
        return found
    spread = _finished(shapes, starts, both, _SPREADING, control)
    return spread if 1.0 - spread.confidence < _CLEARLY * (1.0 - found.confidence) else found


def _finished(
    shapes: tuple[Carrier, Carrier],
    starts: tuple[Laid, Laid],
    both: tuple[NDArray[np.int64], NDArray[np.int64]],
    stages: tuple[Stage, ...],
    control: Control,
) -> LaidPair:
    """Register all vertices of two shapes from starts, and measure the round-trip errors."""

    def finished(k: int) -> NDArray[np.float64]:
        return registered(shapes[k], shapes[1 - k], starts[k], both[k], stages, control).drawn(control)

    found = both_ways(finished)
    homes = [home_distances(shapes[k], shapes[1 - k], *found[:: 1 - 2 * k]) for k in (0, 1)]
    trusts = [np.exp(-0.5 * np.square(home / _MISSED)) for home in homes]
    means = [shape.mesh.vertex_areas @ trust / shape.mesh.area for shape, trust in zip(shapes, trusts, strict=True)]
    return LaidPair(Laid(found[0], trusts[0]), Laid(found[1], trusts[1]), float(min(means)))


def _drafted(
    drafts: DraftPair, starts: list[Laid], grown: GrownPair | None, sides: MirroredSides | None
) -> tuple[list[Laid], bool]:
    """Register coarse meshes from the best of several starts; also return whether the grown one was chosen."""
    best = list(both_ways(lambda k: drafts.proposed(k, starts[k], FROM_MAP)))
    if max(found.misfit for found in best) <= _FINE:
        return [trusted(found) for found in best], False
    is_grown = grown is not None and total_cost(drafts, grown.found) < total_cost(drafts, best)
    best = list(grown.found) if is_grown else best
    tries = [best]
    if not (is_grown and all(agree(drafts, best, k) for k in (0, 1))):
        tries += all_mended(drafts, best)
    kept = min(tries, key=lambda found: total_cost(drafts, found, sides))
    if sides is not None:
        same = symmetrized(drafts, kept, sides)
        kept = min(kept, same, key=lambda found: total_cost(drafts, found, sides))
    return [trusted(found) for found in kept], is_grown


def _tightened(drafts: DraftPair, starts: list[Laid], sides: MirroredSides | None) -> list[Laid]:
    """Register coarse meshes so that limbs keep their lengths and strain concentrates in joints.

    Maps slide along limbs, which look alike all along. Skin under a raised arm is missing on one of the shapes, so it
    can be found only from the other one. Therefore the inverse of the other one is tried, too. Robust weights decide
    differently on the two sides of symmetric shapes, so the result is made symmetric unless that costs much more.
    """
    first = both_ways(lambda k: drafts.registered(k, starts[k], _TIGHTENING))

    def better(k: int) -> Proposal:
        inverse = drafts.judged(1 - k, first[1 - k].points).inverse
        other = drafts.registered(k, inverse, _TIGHTENING)
        best = other if other.laid.energy(_GIVE) < _CLEARLY * first[k].laid.energy(_GIVE) else first[k]
        return drafts.judged(k, best.points)

    found = list(both_ways(better))
    if sides is not None:
        even = evened(drafts, found, sides)
        found = even if total_cost(drafts, even) <= _MOST_FOR_EVENNESS * total_cost(drafts, found) else found
    return [trusted(own) for own in found]
