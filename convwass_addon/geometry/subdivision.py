# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangles cut until no edge is long, so that a surface can bend wherever it has to."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .mesh import TriangleMesh

# An edge is halved in every round.
_MOST_ROUNDS = 12


@dataclass(frozen=True)
class Subdivision:
    """A mesh with some triangles cut.

    Attributes
    ----------
    mesh : TriangleMesh
        The same surface. The vertices of the mesh that was cut come first.
    parents : (m,) int64 or None
        The triangle that each of its triangles is a part of; None where nothing was cut.
    """

    mesh: TriangleMesh
    parents: NDArray[np.int64] | None


def with_short_edges(mesh: TriangleMesh, longest: float, most_vertices: int) -> Subdivision:
    """Halve all edges that are longer than `longest`, again and again; the surface stays what it is.

    Parameters
    ----------
    mesh : TriangleMesh
        Of any topology. Triangles that share an edge share its halves.
    longest : float
        In the units of the mesh.
    most_vertices : int
        Cutting ends before there are more.
    """
    found = Subdivision(mesh, None)
    for _ in range(_MOST_ROUNDS):
        finer = _halved(found.mesh, longest)
        if finer is None or len(finer.mesh.vertices) > most_vertices:
            break
        found = finer if found.parents is None else Subdivision(finer.mesh, found.parents[finer.parents])
    return found


def _halved(mesh: TriangleMesh, longest: float) -> Subdivision | None:
    """Halve every long edge once; None where there is none."""
    faces, count = mesh.faces, len(mesh.vertices)
    # The edge of column c leads from corner c to the next.
    ends = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=2), axis=2).reshape(-1, 2)
    lengths = np.linalg.norm(mesh.vertices[ends[:, 0]] - mesh.vertices[ends[:, 1]], axis=1)
    long = lengths > longest
    if not long.any():
        return None
    keys, index = np.unique(ends[long, 0] * count + ends[long, 1], return_inverse=True)
    middles = np.full(len(ends), -1, np.int64)
    middles[long] = count + index
    middles = middles.reshape(-1, 3)
    vertices = np.concatenate([mesh.vertices, mesh.vertices[np.stack(np.divmod(keys, count), axis=1)].mean(axis=1)])
    parts, parents = _cut(faces, middles, vertices)
    return Subdivision(TriangleMesh(vertices, parts), parents)


def _cut(
    faces: NDArray[np.int64], middles: NDArray[np.int64], vertices: NDArray[np.float64]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Cut triangles at the middles of their edges, -1 where there is none; return the parts and whose they are."""
    number = (middles >= 0).sum(axis=1)
    parts, owners = [faces[number == 0]], [np.flatnonzero(number == 0)]
    # Corners are rolled so that the only edge that is cut, or the only one that is not, is the first.
    for wanted, is_odd in ((1, True), (2, False)):
        chosen = np.flatnonzero(number == wanted)
        owners += [chosen] * (wanted + 1)
        first = ((middles[chosen] >= 0) == is_odd).argmax(axis=1)
        order = (first[:, None] + np.arange(3)) % 3
        rows = np.arange(len(first))[:, None]
        a, b, c = faces[chosen][rows, order].T
        ab, bc, ca = middles[chosen][rows, order].T
        if wanted == 1:
            parts += [np.stack([a, ab, c], axis=1), np.stack([ab, b, c], axis=1)]
            continue
        parts.append(np.stack([bc, c, ca], axis=1))
        # The quadrilateral is cut along its shorter diagonal.
        across = np.linalg.norm(vertices[a] - vertices[bc], axis=1) <= np.linalg.norm(
            vertices[b] - vertices[ca], axis=1
        )
        parts.append(np.where(across[:, None], np.stack([a, b, bc], axis=1), np.stack([a, b, ca], axis=1)))
        parts.append(np.where(across[:, None], np.stack([a, bc, ca], axis=1), np.stack([b, bc, ca], axis=1)))
    whole = np.flatnonzero(number == 3)
    a, b, c = faces[whole].T
    ab, bc, ca = middles[whole].T
    parts += [np.stack(part, axis=1) for part in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))]
    return np.concatenate(parts), np.concatenate([*owners, *[whole] * 4])
