# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The map between two shapes: with the guides, or without them where they make it worse."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...geometry.mesh import TriangleMesh
from ...progress import Control, Work, within
from ..soft_maps.map_sides import MapSide
from ..soft_maps.map_solving import soft_map_steps
from ..soft_maps.soft_map_settings import SoftMapSettings
from ..soft_maps.surface_maps import PointMap, SurfaceMap
from .carriers import Carrier
from .coinciding_places import coinciding_places

# Chosen by eye; `python3 run.py bench coherence` measures what they give.
# Guides are left out where the map without them is better by more than this: who clicks is right in case of doubt.
_MARGIN = 0.08
# A guide is doubted that the map without guides misses by more than this, in sizes of the surface.
_ASTRAY = 0.15
# How many times guides are tried before they are all left out, and how far around a guide the map tells how it fits, in
# sizes of the surface.
_TRIES, _AROUND = 4, 0.2
# A map of this score is not tried otherwise.
_BEYOND_DOUBT = 0.9
# Fewer places in which shapes coincide leave open how they are turned.
_FEWEST = 4
_NO_PAIRS = np.empty((0, 2), np.int64)


@dataclass(frozen=True)
class PairMap:
    """The map between two shapes that was chosen.

    Attributes
    ----------
    found : SurfaceMap or None
        Points of either mesh for the vertices of the other; None where none was needed.
    pairs : (k, 2) int64
        The guides that it follows, as vertices of the two meshes.
    score : float
        How good it is, 0 to 1.
    score_without : float or None
        How good the map without guides is, where there are guides.
    guides : int
        How many guides there were.
    """

    found: SurfaceMap | None
    pairs: NDArray[np.int64]
    score: float
    score_without: float | None
    guides: int

    @classmethod
    def none(cls) -> PairMap:
        """Return no map at all."""
        return cls(None, _NO_PAIRS, 0.0, None, 0)


def pair_map(
    first: Carrier, second: Carrier, pairs: NDArray[np.int64], settings: SoftMapSettings, control: Control
) -> Work[PairMap]:
    """Solve the map between two shapes, with guides and without, and keep the better one.

    Guides that lie in a plane fit a mirror image just as well, and a wrong one spoils a map that is right without it.
    Where the map is worse with guides, those are left out that it misses without any, if they are the fewer, or else,
    one by one, those around which it is least confident.

    Parameters
    ----------
    first, second : Carrier
        The shapes.
    pairs : (k, 2) int64
        Vertices of their meshes that belong together: the guides.
    settings : SoftMapSettings
        How maps are solved.
    control : Control
        Stops the work.

    Raises
    ------
    InputError
        The meshes cannot be mapped.
    """
    seeds = coinciding_places(first.mesh, second.mesh)
    if not len(pairs):
        return (yield from _without_guides(first, second, seeds, settings, control))
    plain = yield from within(_soft_map(first, second, _NO_PAIRS, settings, control), 0.0, 0.2)
    without = _score(first, second, plain)
    sound = _missed(first, second, plain, pairs) < _ASTRAY
    chosen, begin = pairs, 0.2
    for number in range(_TRIES):
        work = _with_guides(first, second, chosen, seeds, settings, control)
        found = yield from within(work, begin, begin + 0.5 * (1.0 - begin))
        begin += 0.5 * (1.0 - begin)
        if found.score >= without - _MARGIN:
            return replace(found, score_without=without, guides=len(pairs))
        if number == 0 and 2 * sound.sum() >= len(pairs) > sound.sum():
            # Most guides say what the map says without them.
            chosen = pairs[sound]
        elif len(chosen) > 2:
            # The map may be wrong without guides, and most of these right: the one that fits least is left out.
            around = _confidence_around(first, second, found.found, chosen)
            chosen = np.delete(chosen, around.argmin(), axis=0)
        else:
            break
    return PairMap(plain, pairs[:0], without, without, len(pairs))


def _with_guides(
    first: Carrier,
    second: Carrier,
    pairs: NDArray[np.int64],
    seeds: Sequence[NDArray[np.int64]],
    settings: SoftMapSettings,
    control: Control,
) -> Work[PairMap]:
    """Solve the map that follows guides, alone and with places where the shapes coincide, and keep the better one."""
    starts = [pairs, *(np.concatenate([pairs, _beside(own, pairs, first, second)]) for own in seeds[:1])]
    tried = []
    for number, start in enumerate(starts):
        begin, end = number / len(starts), (number + 1) / len(starts)
        found = yield from within(_soft_map(first, second, start, settings, control), begin, end)
        tried.append(PairMap(found, pairs, _score(first, second, found), None, len(pairs)))
        if tried[-1].score >= _BEYOND_DOUBT:
            break
    return max(tried, key=lambda one: one.score)


def _without_guides(
    first: Carrier,
    second: Carrier,
    seeds: Sequence[NDArray[np.int64]],
    settings: SoftMapSettings,
    control: Control,
) -> Work[PairMap]:
    """Solve the map from where the shapes coincide, and otherwise while that does not give a map beyond doubt.

    Shapes may coincide in places that do not belong together: the places are tried again without those that the map
    without any misses.
    """
    tried: list[PairMap] = []

    def attempt(start: NDArray[np.int64]) -> Work[bool]:
        begin, end = (number / (2 * len(seeds) + 1) for number in (len(tried), len(tried) + 1))
        found = yield from within(_soft_map(first, second, start, settings, control), begin, end)
        tried.append(PairMap(found, _NO_PAIRS, _score(first, second, found), None, 0))
        return tried[-1].score >= _BEYOND_DOUBT

    for start in (*seeds, _NO_PAIRS):
        if (yield from attempt(start)):
            return tried[-1]
    plain = tried[-1].found
    for own in seeds:
        sound = _missed(first, second, plain, own) < _ASTRAY
        if not sound.all() and sound.sum() >= _FEWEST and (yield from attempt(own[sound])):
            return tried[-1]
    return max(tried, key=lambda one: one.score)


def _beside(seeds: NDArray[np.int64], pairs: NDArray[np.int64], first: Carrier, second: Carrier) -> NDArray[np.int64]:
    """Return the seeds, (s, 2), that are far enough from all pairs on both shapes to say nothing against them."""
    far = np.ones(len(seeds), bool)
    for side, carrier in enumerate((first, second)):
        places, marked = carrier.mesh.vertices[seeds[:, side]], carrier.mesh.vertices[pairs[:, side]]
        apart = np.linalg.norm(places[:, None] - marked[None], axis=2).min(axis=1, initial=np.inf)
        far &= apart > _ASTRAY * carrier.size
    return seeds[far]


def _soft_map(
    first: Carrier, second: Carrier, pairs: NDArray[np.int64], settings: SoftMapSettings, control: Control
) -> Work[SurfaceMap]:
    sides = (MapSide(carrier.mesh, carrier.name) for carrier in (first, second))
    return soft_map_steps(*sides, pairs, settings, control)


def _missed(first: Carrier, second: Carrier, found: SurfaceMap, pairs: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return how far off a map leads the ends of pairs, (k,), in sizes of the surfaces; the better way counts."""
    here, there = pairs.T
    ways = (
        (found.forward, second, here, there),
        (found.backward, first, there, here),
    )
    missed = []
    for points, other, own, partners in ways:
        places = points.positions(other.mesh)[own]
        apart = np.linalg.norm(places - other.mesh.vertices[partners], axis=1) / other.size
        missed.append(np.where(np.isfinite(apart), apart, np.inf))
    return np.minimum(*missed)


def _confidence_around(
    first: Carrier, second: Carrier, found: SurfaceMap, pairs: NDArray[np.int64]
) -> NDArray[np.float64]:
    """Return how confident a map is around the ends of pairs, (k,): the less confident way counts."""
    sides = (first, found.forward, pairs[:, 0]), (second, found.backward, pairs[:, 1])
    means = []
    for carrier, points, vertices in sides:
        mesh = carrier.mesh
        near = np.linalg.norm(mesh.vertices[vertices][:, None] - mesh.vertices, axis=2) < _AROUND * carrier.size
        weights = near * mesh.vertex_areas
        confidence = np.where(points.found, points.confidence, 0.0)
        means.append(weights @ confidence / np.maximum(weights.sum(axis=1), np.finfo(float).tiny))
    return np.minimum(*means)


def _score(first: Carrier, second: Carrier, found: SurfaceMap) -> float:
    """Return how good a map is, 0 to 1: the lower confidence of the two ways, where the surface is not turned over."""
    return min(
        _confidence(first.mesh, second.mesh, found.forward), _confidence(second.mesh, first.mesh, found.backward)
    )


def _confidence(mesh: TriangleMesh, other: TriangleMesh, points: PointMap) -> float:
    """Return the mean confidence over the area of the triangles that face the right way."""
    known = points.found[mesh.faces].all(axis=1)
    images = np.where(points.found[:, None], points.positions(other), 0.0)[mesh.faces]
    normals = np.cross(images[:, 1] - images[:, 0], images[:, 2] - images[:, 0])
    sides = other.corners[np.maximum(points.faces[mesh.faces[:, 0]], 0)]
    facing = np.cross(sides[:, 1] - sides[:, 0], sides[:, 2] - sides[:, 0])
    upright = known & (np.einsum("nd,nd->n", normals, facing) >= 0)
    areas = np.linalg.norm(np.cross(*(mesh.corners[:, k] - mesh.corners[:, 0] for k in (1, 2))), axis=1)
    confidence = points.confidence.astype(np.float64)[mesh.faces].mean(axis=1)
    return float((areas * confidence * upright).sum() / areas.sum())
