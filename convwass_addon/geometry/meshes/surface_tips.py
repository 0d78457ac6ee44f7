# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Find the tips of the limbs of a surface: where the mean distance to all other points has a prominent maximum.

The mean geodesic distance (Hilaga et al. 2001) is large at the ends of heads, tails, legs and fingers, and does not
depend on the pose. A maximum counts by its persistence (Edelsbrunner et al. 2002): how far the distance falls on the
way to a higher one. An ear is near the tip of the head, and has little.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from .edges import vertex_components
from .mesh import TriangleMesh
from .surface_graph import surface_distances, surface_graph

# Number of points, evenly spread, from which the mean distance is computed.
_SOURCES = 40


@dataclass(frozen=True)
class SurfaceTip:
    """The end of a limb.

    Attributes
    ----------
    vertex : int
        Its vertex.
    distances : (n,) float64
        Distances of all vertices from it on the surface, in sizes of the surface, the square root of its area;
        infinite on other components.
    """

    vertex: int
    distances: NDArray[np.float64]


def surface_tips(mesh: TriangleMesh, persistence: float) -> list[SurfaceTip]:
    """Return the tips of limbs, the farthest ones first.

    Parameters
    ----------
    mesh : TriangleMesh
        With area. Tips are found on its largest component.
    persistence : float
        How much farther a tip is from all points on average than the point from which it can be told apart from a
        farther one, in sizes of the surface.
    """
    graph, size = surface_graph(mesh), mesh.root_area
    heights = _mean_distances(mesh, graph) / size
    tips = [vertex for vertex, prominence in _maxima(heights, graph) if prominence >= persistence]
    return [SurfaceTip(vertex, surface_distances(graph, [vertex])[0] / size) for vertex in tips]


def _mean_distances(mesh: TriangleMesh, graph: csr_array) -> NDArray[np.float64]:
    """Return the mean distances of the vertices from the surface, (n,), minus infinity off the largest component."""
    areas, labels = mesh.vertex_areas, vertex_components(mesh)
    reached = labels == np.bincount(labels[labels >= 0], areas[labels >= 0]).argmax()
    outermost = np.where(reached, np.linalg.norm(mesh.vertices - mesh.area_center, axis=1), -np.inf).argmax()
    distances = surface_distances(graph, [outermost])
    while len(distances) < min(_SOURCES, np.count_nonzero(reached)):
        farthest = np.where(reached, distances.min(axis=0), -np.inf).argmax()
        distances = np.vstack([distances, surface_distances(graph, [farthest])])
    nearest = distances[:, reached].argmin(axis=0)
    weights = np.bincount(nearest, areas[reached], len(distances))
    means = np.full(len(reached), -np.inf)
    means[reached] = weights @ distances[:, reached] / weights.sum()
    return means


def _maxima(heights: NDArray[np.float64], graph: csr_array) -> Iterator[tuple[int, float]]:
    """Yield the local maxima of a function and their persistences, by joining the sets in which it is high."""
    peak = np.full(len(heights), -1)
    members: dict[int, list[int]] = {}
    persistences: dict[int, float] = {}
    for vertex in np.argsort(-heights, kind="stable"):
        if not np.isfinite(heights[vertex]):
            break
        around = peak[graph.indices[graph.indptr[vertex] : graph.indptr[vertex + 1]]]
        peaks = sorted(set(around[around >= 0].tolist()), key=lambda own: (-heights[own], own))
        if not peaks:
            members[int(vertex)] = []
            peaks = [int(vertex)]
        highest, *others = peaks
        for own in others:
            persistences[own] = heights[own] - heights[vertex]
            peak[members[own]] = highest
            members[highest] += members.pop(own)
        peak[vertex] = highest
        members[highest].append(int(vertex))
    lowest = heights[np.isfinite(heights)].min()
    for own in members:
        persistences[own] = heights[own] - lowest
    yield from sorted(persistences.items(), key=lambda item: -heights[item[0]])
