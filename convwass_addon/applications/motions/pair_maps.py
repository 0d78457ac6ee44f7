# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The map between two shapes: with the guides, or without them where they make it worse."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...geometry.mesh import TriangleMesh
from ...progress import Control, Work, within
from ..soft_maps.map_sides import MapSide
from ..soft_maps.map_solving import soft_map_steps
from ..soft_maps.soft_map_settings import SoftMapSettings
from ..soft_maps.surface_maps import PointMap, SurfaceMap
from .carriers import Carrier

# Guides are left out where the map without them is better by more than this: who clicks is right in case of doubt.
_MARGIN = 0.08
# A guide is doubted that the map without guides misses by more than this, in sizes of the surface.
_ASTRAY = 0.15


@dataclass(frozen=True)
class PairMap:
    """The map between two shapes that was chosen.

    Attributes
    ----------
    found : SurfaceMap
        Points of either mesh for the vertices of the other.
    pairs : (k, 2) int64
        The guides that it follows, as vertices of the two meshes.
    score : float
        How good it is, 0 to 1.
    score_without : float or None
        How good the map without guides is, where there are guides.
    guides : int
        How many guides there were.
    """

    found: SurfaceMap
    pairs: NDArray[np.int64]
    score: float
    score_without: float | None
    guides: int


def pair_map(
    first: Carrier, second: Carrier, pairs: NDArray[np.int64], settings: SoftMapSettings, control: Control
) -> Work[PairMap]:
    """Solve the map between two shapes, with guides and without, and keep the better one.

    Guides that lie in a plane fit a mirror image just as well, and a wrong one spoils a map that is right without it.

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
    if not len(pairs):
        found = yield from _soft_map(first, second, pairs, settings, control)
        return PairMap(found, pairs, _score(first, second, found), None, 0)
    plain = yield from within(_soft_map(first, second, pairs[:0], settings, control), 0.0, 0.33)
    without = _score(first, second, plain)
    best = PairMap(plain, pairs[:0], without, without, len(pairs))
    kept = _missed(first, second, plain, pairs) < _ASTRAY
    tries = [pairs] if kept.all() or not kept.any() else [pairs, pairs[kept]]
    for number, chosen in enumerate(tries):
        begin = 0.33 * (1 + number)
        found = yield from within(_soft_map(first, second, chosen, settings, control), begin, begin + 0.33)
        score = _score(first, second, found)
        if score >= without - _MARGIN:
            return PairMap(found, chosen, score, without, len(pairs))
    return best


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
