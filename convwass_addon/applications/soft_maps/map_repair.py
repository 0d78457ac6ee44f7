# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Fill in doubtful regions of a map from their surroundings."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array

from ...errors import InputError
from ...geometry.algebra.factorization import factorize
from ...geometry.deformation.edge_energy import EdgeEnergy
from ...geometry.meshes.closest_points import ClosestPoints
from ...geometry.meshes.edges import vertex_components
from ...geometry.meshes.facing_points import FacingPointFinder
from ...geometry.meshes.laplacian import laplacian
from ...geometry.meshes.mesh import TriangleMesh
from ...sentence import Sentence
from .map_frames import map_frames, nearest_turns
from .surface_maps import PointMap, SurfaceMap

# Distance from the other surface, relative to its size, at which a filled-in point has a confidence of 0.6.
_FAR = 0.08


def repaired_map(found: SurfaceMap, source: TriangleMesh, target: TriangleMesh, threshold: float = 0.3) -> SurfaceMap:
    """Return a map with doubtful points filled in, in both directions; the distributions are not changed.

    Parameters
    ----------
    found : SurfaceMap
        The map.
    source, target : TriangleMesh
        Its meshes.
    threshold : float
        Points with less confidence are doubtful.

    Raises
    ------
    InputError
        A threshold outside 0 to 1, meshes that do not match the map, or no confident point at all.
    """
    forward = repaired_points(found.forward, source, target, threshold)
    backward = repaired_points(found.backward, target, source, threshold)
    notices = list(found.notices)
    filled = int((forward.faces != found.forward.faces).sum() + (backward.faces != found.backward.faces).sum())
    notices.append(Sentence("{count} points of the map were filled in from their neighbors.", {"count": filled}))
    return replace(found, forward=forward, backward=backward, notices=tuple(notices))


def repaired_points(points: PointMap, own: TriangleMesh, other: TriangleMesh, threshold: float = 0.3) -> PointMap:
    """Return points with doubtful ones filled in from the confident ones around them.

    A doubtful region is mapped to the other surface as a patch of its own shape, rotated and scaled like its
    surroundings, fixed at its rim, and projected to the surface. Components without confident vertices are not changed.

    Parameters
    ----------
    points : PointMap
        A point on `other` for every vertex of `own`.
    own, other : TriangleMesh
        The meshes.
    threshold : float
        Points with less confidence are doubtful.

    Raises
    ------
    InputError
        A threshold outside 0 to 1, meshes that do not match the map, or no confident point at all.
    """
    if not 0 <= threshold <= 1:
        raise InputError("The threshold must lie between 0 and 1.")
    if len(points) != len(own.vertices) or points.faces.max(initial=-1) >= len(other.faces):
        raise InputError("The map belongs to other meshes; compute it again.")
    good = points.found & (points.confidence >= threshold)
    pieces = vertex_components(own)
    has_good = np.zeros(pieces.max() + 2, bool)
    has_good[pieces[good]] = True
    # The last entry is for vertices that no triangle uses.
    has_good[-1] = False
    doubtful = ~good & has_good[pieces]
    if not good.any():
        raise InputError(
            "No point of the map is confident enough to repair others from; add pairs, and compute it again."
        )
    if not doubtful.any():
        return points
    return _filled(points, own, other, good, doubtful)


def _filled(
    points: PointMap, own: TriangleMesh, other: TriangleMesh, good: NDArray[np.bool_], doubtful: NDArray[np.bool_]
) -> PointMap:
    energy = EdgeEnergy.of(own)
    unknown, known = np.flatnonzero(doubtful), np.flatnonzero(good)
    inner = energy.stiffness[unknown][:, unknown]
    factor, across = factorize(csc_array(inner)), energy.stiffness[unknown][:, known]

    def extended(values: NDArray[np.float64], pulls: NDArray[np.float64] | float = 0.0) -> NDArray[np.float64]:
        """Extend values at confident vertices, (k, d), into the doubtful region."""
        return factor.solve(np.ascontiguousarray((pulls - across @ values).T)).T

    trusted = replace(points, faces=np.where(good, points.faces, -1).astype(np.int32))
    frames = map_frames(trusted, own, other, laplacian(own))
    shrinks = np.zeros(len(good))
    shrinks[known] = -np.log(frames.stretches[known])
    turns = frames.turns.copy()
    shrinks[unknown] = extended(shrinks[known, None])[:, 0]
    turns[unknown] = nearest_turns(extended(turns[known].reshape(-1, 9)).reshape(-1, 3, 3), frames.side)
    # Map directions at a vertex to directions at its point.
    gradients = np.swapaxes(turns, 1, 2) * np.exp(shrinks)[:, None, None]
    pulls = energy.pulls(gradients[own.faces].mean(axis=1))[unknown]
    places = extended(points.at(other, other.vertices)[known], pulls)
    normals = own.vertex_normals[unknown]
    # Both surfaces face outward, even if the map reverses orientation.
    facing = np.einsum("nji,nj->ni", turns[unknown], normals)
    landed = _projected(points, other, known, places, facing)
    figures = np.stack([points.spread, points.entropy, points.confidence], axis=1).astype(np.float64)
    rest = extended(figures[known])
    miss = landed.distances / other.root_area
    rest[:, 2] = np.clip(rest[:, 2] * np.exp(-0.5 * np.square(miss / _FAR)), 0.0, 1.0)
    return _with(points, unknown, landed.triangles, landed.shares, rest)


def _projected(
    points: PointMap,
    other: TriangleMesh,
    known: NDArray[np.int64],
    places: NDArray[np.float64],
    facing: NDArray[np.float64],
) -> ClosestPoints:
    """Project points to the components of the other surface that contain the confident points."""
    pieces = vertex_components(other)[other.faces[:, 0]]
    faces = np.flatnonzero(np.isin(pieces, pieces[points.faces[known]]))
    finder = FacingPointFinder(replace(other, faces=other.faces[faces]))
    landed = finder.find(places, facing)
    return replace(landed, triangles=faces[landed.triangles])


def _with(
    points: PointMap,
    chosen: NDArray[np.int64],
    triangles: NDArray[np.int64],
    shares: NDArray[np.float64],
    figures: NDArray[np.float64],
) -> PointMap:
    """Return points with some of them replaced."""
    changed = {
        "faces": triangles,
        "barycentric": shares,
        "spread": figures[:, 0],
        "entropy": figures[:, 1],
        "confidence": figures[:, 2],
    }
    fields = {}
    for name, values in changed.items():
        fields[name] = getattr(points, name).copy()
        fields[name][chosen] = values
    return PointMap(**fields)
