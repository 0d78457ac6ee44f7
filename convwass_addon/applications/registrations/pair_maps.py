# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The map between two shapes, with guides, or without those that make it worse."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from ...geometry.meshes.mesh import TriangleMesh, is_level
from ...geometry.meshes.mirror_planes import MirrorPlanes
from ...geometry.meshes.normals import triangle_normals
from ...progress import Control, Work, as_part, within
from ..soft_maps.map_sides import MapSide
from ..soft_maps.map_solving import soft_map_steps
from ..soft_maps.soft_map_settings import SoftMapSettings
from ..soft_maps.surface_maps import PointMap, SurfaceMap
from .carriers import Carrier
from .coinciding_places import coinciding_places
from .laid_meshes import Laid
from .mirrored_sides import Groups, MirroredSides, height_groups

# Chosen by eye; `python3 run.py bench coherence` measures what they give.
# Guides are left out only if the map without them is better by more than this: in doubt, the user is right.
_MARGIN = 0.08
# A guide is doubtful if the map without guides misses it by more than this, in sizes of the surface.
_ASTRAY = 0.15
# Maximum number of maps with guides before all guides are left out, and the radius around a guide in which the
# confidence of the map is averaged, in sizes of the surface.
_TRIES, _AROUND = 4, 0.2
# With this score, a map from guides alone is good enough.
_BEYOND_DOUBT = 0.9
# With a lower score, a map that prefers the same heights, with this weight, is tried, and taken if it has at least this
# share of the other's score: rounding decides which of two doubtful maps has more, but upside down is wrong.
_FAIR, _HEIGHTS, _UPRIGHT = 0.5, 6.0, 0.85
# Weight of the sides of symmetric shapes relative to everything else that distinguishes points. With 1, a dog becomes a
# bird symmetrically on 0.63 to 0.81 of the surface, with 3 on 0.96, and with 10 on less, because limbs then fold.
_SIDED = 3.0
_NO_PAIRS = np.empty((0, 2), np.int64)

DOUBTED = 0.2
"""With a lower score, there is no good map; chosen by eye on pairs of the benchmark."""


@dataclass(frozen=True)
class PairMap:
    """The chosen map between two shapes.

    Attributes
    ----------
    found : SurfaceMap or None
        Points on either mesh for the vertices of the other; None if no map was needed.
    pairs : (k, 2) int64
        The guides that the map follows, as vertices of the two meshes.
    score : float
        Quality of the map, 0 to 1.
    """

    found: SurfaceMap | None
    pairs: NDArray[np.int64]
    score: float

    @classmethod
    def unneeded(cls) -> PairMap:
        """Return the record of shapes whose correspondence is known without a map."""
        return cls(None, _NO_PAIRS, 1.0)

    def starts(self, one: Carrier, other: Carrier) -> tuple[Laid, Laid]:
        """Return where the map sends the vertices of either shape, with confidences, for registrations."""
        return _start(one, other, self.found.forward), _start(other, one, self.found.backward)


@dataclass(frozen=True)
class _MapShapes:
    """Two shapes to map onto each other.

    Attributes
    ----------
    both : (Carrier, Carrier)
        The shapes.
    vertices : int
        Approximate number of vertices of the coarse meshes on which maps are solved.
    control : Control
        Stops the work.
    """

    both: tuple[Carrier, Carrier]
    vertices: int
    control: Control


def pair_map(
    first: Carrier,
    second: Carrier,
    pairs: NDArray[np.int64],
    vertices: int,
    control: Control,
    sides: MirroredSides | None = None,
) -> Work[PairMap]:
    """Solve the map between two shapes with and without guides, and return the better one.

    Guides in a plane fit a mirror image just as well, and a wrong guide spoils a map that is right without it. If the
    guides make the map worse, those that contradict the map without guides are left out, provided that they are a
    minority. Otherwise guides are left out one by one, starting where the confidence around them is lowest. The map
    without guides follows those that it does not contradict.

    Parameters
    ----------
    first, second : Carrier
        The two shapes.
    pairs : (k, 2) int64
        Corresponding vertices of their meshes: the guides.
    vertices : int
        Approximate number of vertices of the coarse meshes on which maps are solved.
    control : Control
        Stops the work.
    sides : MirroredSides, optional
        Left and right of the two shapes, which the map keeps; guides must not contradict them.

    Raises
    ------
    InputError
        The meshes cannot be mapped.
    """
    shapes = _MapShapes((first, second), vertices, control)
    seeds = coinciding_places(first.mesh, second.mesh)
    groups = None if sides is None else sides.both_groups
    if not len(pairs):
        return (yield from _without_guides(shapes, seeds, groups))
    plain = yield from within(_solved(shapes, _NO_PAIRS, groups), 0.0, 0.2)
    sound = _missed(first, second, plain.found, pairs) < _ASTRAY
    chosen, begin = pairs, 0.2
    for number in range(_TRIES):
        work = _with_guides(shapes, chosen, seeds, groups)
        found = yield from within(work, begin, begin + 0.5 * (1.0 - begin))
        begin += 0.5 * (1.0 - begin)
        if found.score >= plain.score - _MARGIN:
            return found
        if sound.all():
            break
        if number == 0 and 2 * sound.sum() >= len(pairs) > sound.sum():
            # Most guides agree with the map without guides.
            chosen = pairs[sound]
        elif len(chosen) > 2:
            # The map without guides may be wrong and most guides right: leave out the one with the lowest confidence
            # around it.
            around = _confidence_around(first, second, found.found, chosen)
            chosen = np.delete(chosen, around.argmin(), axis=0)
        else:
            break
    return replace(plain, pairs=pairs[sound])


def _with_guides(
    shapes: _MapShapes,
    pairs: NDArray[np.int64],
    seeds: NDArray[np.int64],
    groups: tuple[Groups, Groups] | None,
) -> Work[PairMap]:
    """Solve the map from the guides, also together with coinciding points and without groups; return the best one."""
    starts = [pairs]
    if len(seeds):
        starts.append(np.concatenate([pairs, _beside(seeds, pairs, shapes)]))
    ways = list(product([groups, None] if groups else [None], starts))
    tried = []
    for number, (own, start) in enumerate(ways):
        found = yield from as_part(_solved(shapes, start, own), number, len(ways))
        tried.append(replace(found, pairs=pairs))
        if tried[-1].score >= _BEYOND_DOUBT:
            break
    return max(tried, key=lambda one: one.score)


def _without_guides(
    shapes: _MapShapes, seeds: NDArray[np.int64], groups: tuple[Groups, Groups] | None
) -> Work[PairMap]:
    """Solve the map from coinciding points, or without any.

    If there is no good map, points that coincide may not correspond, and the map is also solved without them. Shapes
    without sides are mapped once more if the score is low, with a preference for the same heights: a tree would become
    a snowman upside down.
    """
    tried = [(yield from within(_solved(shapes, seeds, groups), 0.0, 0.5))]
    if len(seeds) and tried[0].score < DOUBTED:
        tried.append((yield from within(_solved(shapes, _NO_PAIRS, groups), 0.5, 0.75)))
    if groups is None and max(one.score for one in tried) < _FAIR and not is_level(shapes.both[0].mesh.vertices):
        heights = height_groups(shapes.both[0].mesh), height_groups(shapes.both[1].mesh)
        upright = yield from within(_solved(shapes, seeds, heights, weight=_HEIGHTS), 0.75, 1.0)
        if upright.score >= _UPRIGHT * max(one.score for one in tried):
            return upright
    return max(tried, key=lambda one: one.score)


def mirrored_map(
    first: Carrier, second: Carrier, vertices: int, control: Control, sides: MirroredSides | None
) -> Work[PairMap]:
    """Solve the map between two shapes without guides; with sides, it is attracted to what it is in the mirror."""
    groups, planes = (None, None) if sides is None else (sides.both_groups, sides.planes)
    return _solved(_MapShapes((first, second), vertices, control), _NO_PAIRS, groups, planes)


def limb_map(
    first: Carrier,
    second: Carrier,
    pairs: NDArray[np.int64],
    vertices: int,
    control: Control,
    sides: MirroredSides,
) -> Work[PairMap]:
    """Solve the map that joins the tips of limbs, (k, 2), and keeps left and right; they do not count as guides."""
    return _solved(_MapShapes((first, second), vertices, control), pairs, sides.both_groups)


def _start(source: Carrier, target: Carrier, points: PointMap) -> Laid:
    """Return mapped positions of a shape's vertices, with confidences."""
    places = np.where(points.found[:, None], points.positions(target.mesh), source.mesh.vertices)
    # Mapped points need some weight, even those without confidence.
    return Laid(places, np.where(points.found, np.maximum(points.confidence.astype(np.float64), 1e-6), 0.0))


def _beside(seeds: NDArray[np.int64], pairs: NDArray[np.int64], shapes: _MapShapes) -> NDArray[np.int64]:
    """Return the coinciding points, (s, 2), that are too far from all pairs on both shapes to contradict them."""
    far = np.ones(len(seeds), bool)
    for side, carrier in enumerate(shapes.both):
        places, marked = carrier.mesh.vertices[seeds[:, side]], carrier.mesh.vertices[pairs[:, side]]
        apart = np.linalg.norm(places[:, None] - marked[None], axis=2).min(axis=1, initial=np.inf)
        far &= apart > _ASTRAY * carrier.mesh.root_area
    return seeds[far]


def _solved(
    shapes: _MapShapes,
    pairs: NDArray[np.int64],
    groups: tuple[Groups, Groups] | None = None,
    mirrors: MirrorPlanes | None = None,
    weight: float = _SIDED,
) -> Work[PairMap]:
    """Solve the map from pairs, (k, 2), which do not count as guides, with a weight of the groups."""
    own = groups or ({}, {})
    mapped = (MapSide(carrier.mesh, carrier.name, own[k]) for k, carrier in enumerate(shapes.both))
    settings = SoftMapSettings(vertices=shapes.vertices, group_weight=weight)
    found = yield from soft_map_steps(*mapped, pairs, settings, shapes.control, mirrors)
    return PairMap(found, _NO_PAIRS, _score(*shapes.both, found))


def _missed(first: Carrier, second: Carrier, found: SurfaceMap, pairs: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return how far a map misses pairs, (k,), in sizes of the surfaces; the better direction counts."""
    here, there = pairs.T
    ways = (
        (found.forward, second, here, there),
        (found.backward, first, there, here),
    )
    missed = []
    for points, other, own, partners in ways:
        places = points.positions(other.mesh)[own]
        apart = np.linalg.norm(places - other.mesh.vertices[partners], axis=1) / other.mesh.root_area
        missed.append(np.where(np.isfinite(apart), apart, np.inf))
    return np.minimum(*missed)


def _confidence_around(
    first: Carrier, second: Carrier, found: SurfaceMap, pairs: NDArray[np.int64]
) -> NDArray[np.float64]:
    """Return the mean confidence of a map around the ends of pairs, (k,), in the less confident direction."""
    sides = (first, found.forward, pairs[:, 0]), (second, found.backward, pairs[:, 1])
    means = []
    for carrier, points, vertices in sides:
        mesh = carrier.mesh
        near = (
            np.linalg.norm(mesh.vertices[vertices][:, None] - mesh.vertices, axis=2) < _AROUND * carrier.mesh.root_area
        )
        weights = near * mesh.vertex_areas
        confidence = np.where(points.found, points.confidence, 0.0)
        means.append(weights @ confidence / np.maximum(weights.sum(axis=1), np.finfo(float).tiny))
    return np.minimum(*means)


def _score(first: Carrier, second: Carrier, found: SurfaceMap) -> float:
    """Return the quality of a map, 0 to 1: the lower confidence of both directions, without flipped triangles."""
    return min(
        _confidence(first.mesh, second.mesh, found.forward), _confidence(second.mesh, first.mesh, found.backward)
    )


def _confidence(mesh: TriangleMesh, other: TriangleMesh, points: PointMap) -> float:
    """Return the mean confidence by area, counting zero for triangles that are flipped."""
    known = points.found[mesh.faces].all(axis=1)
    images = np.where(points.found[:, None], points.positions(other), 0.0)[mesh.faces]
    surface = other.corners[np.maximum(points.faces[mesh.faces[:, 0]], 0)]
    upright = known & ((triangle_normals(images) * triangle_normals(surface)).sum(axis=1) >= 0)
    confidence = points.confidence.astype(np.float64)[mesh.faces].mean(axis=1)
    return float((mesh.face_areas * confidence * upright).sum() / mesh.area)
