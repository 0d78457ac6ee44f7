# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Validate pairs of corresponding vertices, and find contradictory ones."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import InputError
from ...geometry.meshes.edges import proper_part
from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.meshes.surface_graph import edge_distances
from ...sentence import Sentence
from .map_sides import MapSide

# A pair is reported if its distances to most others deviate by this factor from the usual ratio, and by this multiple
# of the median deviation.
_ODD_FACTOR, _ODD_TIMES = 1.8, 3.0
# With fewer pairs, none can be judged by the others.
_FEWEST_JUDGED = 4


def checked_pairs(pairs: ArrayLike, source: MapSide, target: MapSide) -> NDArray[np.int64]:
    """Return distinct pairs of vertices, (k, 2).

    Raises
    ------
    InputError
        Invalid indices, vertices without faces, or a vertex in several pairs.
    """
    found = np.asarray(pairs)
    if not found.size:
        return np.empty((0, 2), np.int64)
    if found.ndim != 2 or found.shape[1] != 2 or found.dtype.kind not in "iu":
        raise InputError("Pairs are two vertex numbers each: one of the source, one of the target.")
    found = np.unique(found.astype(np.int64), axis=0)
    for side, vertices in ((source, found[:, 0]), (target, found[:, 1])):
        _check_vertices(vertices, side)
    return found


def _check_vertices(vertices: NDArray[np.int64], side: MapSide) -> None:
    count = len(side.mesh.vertices)
    wrong = vertices[(vertices < 0) | (vertices >= count)]
    if len(wrong):
        raise InputError(
            "There is no vertex {vertex}; {name} has {count} vertices.",
            vertex=int(wrong[0]),
            name=side.name,
            count=count,
        )
    used, _ = proper_part(side.mesh)
    loose = np.setdiff1d(vertices, used)
    if len(loose):
        raise InputError(
            "Vertex {vertex} of {name} belongs to no face; choose another one.", vertex=int(loose[0]), name=side.name
        )
    single, counts = np.unique(vertices, return_counts=True)
    if (counts > 1).any():
        raise InputError(
            "Vertex {vertex} of {name} is in {count} pairs; keep one of them.",
            vertex=int(single[counts.argmax()]),
            name=side.name,
            count=int(counts.max()),
        )


def odd_pairs(pairs: NDArray[np.int64], source: TriangleMesh, target: TriangleMesh) -> Iterator[int]:
    """Yield the indices of pairs, (k, 2), whose distances along edges to the others do not match."""
    if len(pairs) < _FEWEST_JUDGED:
        return
    here, there = (
        edge_distances(mesh, pairs[:, side])[:, pairs[:, side]] for side, mesh in enumerate((source, target))
    )
    apart = ~np.eye(len(pairs), dtype=bool)
    reached = apart & np.isfinite(here) & np.isfinite(there) & (here > 0) & (there > 0)
    ratios = np.full(here.shape, np.nan)
    ratios[reached] = np.log(here[reached] / there[reached])
    if not reached.any():
        return
    ratios -= np.nanmedian(ratios)
    judged = np.flatnonzero(reached.sum(axis=1) >= _FEWEST_JUDGED - 1)
    oddness = np.array([np.nanmedian(np.abs(ratios[place])) for place in judged])
    if len(judged) < _FEWEST_JUDGED:
        return
    usual = np.median(oddness)
    yield from (int(judged[i]) for i in np.flatnonzero(oddness > max(np.log(_ODD_FACTOR), _ODD_TIMES * usual)))


def pair_notices(
    pairs: NDArray[np.int64], source: TriangleMesh, target: TriangleMesh, named: NDArray[np.int64]
) -> Iterator[Sentence]:
    """Yield warnings about pairs, (k, 2), of vertices of two meshes, which messages call `named`, (k, 2)."""
    for place in odd_pairs(pairs, source, target):
        values = {"source_vertex": int(named[place, 0]), "target_vertex": int(named[place, 1])}
        yield Sentence(
            "The pair of vertex {source_vertex} and vertex {target_vertex} contradicts the others; is it right?", values
        )
