# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Match the connected components of two meshes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...geometry.arrays.components import component_labels
from ...geometry.arrays.label_sums import label_sums
from ...geometry.meshes.edges import faces_between, vertex_components
from ...geometry.meshes.mesh import TriangleMesh
from .map_sides import MapSide

# Weights of the differences between components: of the logarithms of their size and of their three extents, and of
# their distance relative to the largest component.
_SIZE, _EXTENT, _PLACE = 1.0, 1.0, 1.5
# Components with a larger difference are not matched.
_WORST = 6.0
# Lower limit of extents, relative to the longest.
_FLAT = 0.05


@dataclass(frozen=True)
class PieceMatch:
    """Matched components of two meshes, between which a map is solved separately.

    Attributes
    ----------
    source, target : (k,) int64
        Their vertices on each side.
    pairs : (p, 2) int64
        Marked pairs on them, as vertices of the whole meshes.
    is_guessed : bool
        Whether the pairs were guessed rather than marked.
    """

    source: NDArray[np.int64]
    target: NDArray[np.int64]
    pairs: NDArray[np.int64]
    is_guessed: bool = False


def matched_pieces(source: MapSide, target: MapSide, pairs: NDArray[np.int64]) -> list[PieceMatch]:
    """Match the components of two meshes by marked pairs, (k, 2), and the others by similarity.

    Components that pairs connect with several others are matched as one group. Unmatched components have no
    counterpart.
    """
    labels = [vertex_components(side.mesh) for side in (source, target)]
    counts = [int(own.max()) + 1 for own in labels]
    couples = _matched_labels(
        [own[pairs[:, place]] for place, own in enumerate(labels)], counts, labels, (source, target)
    )
    matches = [
        PieceMatch(
            np.flatnonzero(np.isin(labels[0], here)),
            np.flatnonzero(np.isin(labels[1], there)),
            pairs[np.isin(labels[0][pairs[:, 0]], here)],
        )
        for here, there in couples
    ]
    # Solve components with pairs and large ones first, because they help with the others.
    return sorted(matches, key=lambda match: (not len(match.pairs), -len(match.source)))


def part_of(side: MapSide, vertices: NDArray[np.int64]) -> MapSide:
    """Return the part of a side with exactly these vertices, (v,), in this order; whole components."""
    mesh = side.mesh
    if len(vertices) == len(mesh.vertices):
        return side
    part = TriangleMesh(mesh.vertices[vertices], faces_between(mesh.faces, vertices, len(mesh.vertices)))
    return MapSide(part, side.name, {name: weights[vertices] for name, weights in side.groups.items()})


def faces_of(mesh: TriangleMesh, vertices: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the indices of the triangles that `part_of` keeps, (f,), in order."""
    is_kept = np.zeros(len(mesh.vertices), bool)
    is_kept[vertices] = True
    return np.flatnonzero(is_kept[mesh.faces].all(axis=1))


def _matched_labels(
    named: list[NDArray[np.int64]], counts: list[int], labels: list[NDArray[np.int64]], sides: tuple[MapSide, MapSide]
) -> Iterator[tuple[NDArray[np.int64], NDArray[np.int64]]]:
    """Yield the labels of matched components."""
    if counts == [1, 1]:
        yield np.zeros(1, np.int64), np.zeros(1, np.int64)
        return
    # A bipartite graph of the source's components, followed by the target's.
    ends = (named[0], named[1] + counts[0])
    groups = component_labels(*ends, counts[0] + counts[1])
    for group in np.unique(groups[np.unique(ends[0])]):
        members = np.flatnonzero(groups == group)
        yield members[members < counts[0]], members[members >= counts[0]] - counts[0]
    free = [np.setdiff1d(np.arange(count), own) for count, own in zip(counts, named, strict=True)]
    if not (len(free[0]) and len(free[1])):
        return
    # Imported here: SciPy loads a hundred modules for it, which most sessions do not need.
    from scipy.optimize import linear_sum_assignment

    descriptors = [
        _descriptors(side.mesh, own, count)[chosen]
        for side, own, count, chosen in zip(sides, labels, counts, free, strict=True)
    ]
    apart = np.abs(descriptors[0][:, None] - descriptors[1][None]).sum(axis=2)
    for here, there in zip(*linear_sum_assignment(np.minimum(apart, _WORST)), strict=True):
        if apart[here, there] < _WORST:
            yield free[0][[here]], free[1][[there]]


def _descriptors(mesh: TriangleMesh, labels: NDArray[np.int64], count: int) -> NDArray[np.float64]:
    """Return descriptors of the components of a mesh, (count, 7), whose differences are distances."""
    areas = np.where(labels >= 0, mesh.vertex_areas, 0.0)
    own = np.maximum(labels, 0)
    sums = np.maximum(np.bincount(own, areas, count), np.finfo(float).tiny)
    centers = label_sums(own, areas[:, None] * mesh.vertices, count) / sums[:, None]
    used = labels >= 0
    extents = np.stack([_extent(x[used], labels[used], count) for x in mesh.vertices.T], axis=1)
    extents = np.sort(np.maximum(extents, _FLAT * extents.max(axis=1, keepdims=True)), axis=1)
    # Everything is relative to the largest component, because small ones may be anywhere.
    largest = int(sums.argmax())
    size = max(float(extents[largest].max()), np.finfo(float).tiny)
    return np.concatenate(
        [
            _SIZE * np.log(sums / sums[largest])[:, None],
            _EXTENT * np.log(np.maximum(extents / size, 1e-9)) / 3.0,
            _PLACE * (centers - centers[largest]) / size,
        ],
        axis=1,
    )


def _extent(values: NDArray[np.float64], labels: NDArray[np.int64], count: int) -> NDArray[np.float64]:
    """Return the range of the values on every component, (count,)."""
    low, high = np.full(count, np.inf), np.full(count, -np.inf)
    np.minimum.at(low, labels, values)
    np.maximum.at(high, labels, values)
    return high - low
