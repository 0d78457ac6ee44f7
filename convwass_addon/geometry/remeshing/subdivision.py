# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Subdivide triangles where edges are long or selected, so that a surface can bend anywhere."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..meshes.edges import EdgeUse, edge_ends, edge_lengths, edge_use
from ..meshes.mesh import TriangleMesh

# Every round halves long edges.
_MOST_ROUNDS = 12
# Edges that become long are halved if they are longer than this share of the longest one; the tip of a candle that
# becomes the mouth of a pot would get thousands of triangles.
_SHORTEST = 1.0 / 6.0
# Longer edges, in sizes of the surface (the square root of its area), cannot bend like limbs.
_BENDING = 0.03


@dataclass(frozen=True)
class Subdivision:
    """A mesh with some triangles subdivided.

    Attributes
    ----------
    mesh : TriangleMesh
        The same surface. The vertices of the original mesh come first.
    parents : (m,) int64 or None
        The original triangle of each triangle; None if nothing was subdivided.
    """

    mesh: TriangleMesh
    parents: NDArray[np.int64] | None


Image = Callable[[NDArray[np.float64]], NDArray[np.float64]]
"""Maps points of a surface, (n, 3), to where they move, (n, d)."""


def with_short_edges(mesh: TriangleMesh, longest: float, most_vertices: int, image: Image | None = None) -> Subdivision:
    """Halve all edges longer than `longest` repeatedly; the surface does not change.

    Parameters
    ----------
    mesh : TriangleMesh
        Of any topology. Triangles that share an edge share its midpoint.
    longest : float
        In units of the mesh.
    most_vertices : int
        Subdivision ends before it exceeds this number.
    image : callable, optional
        Edges whose ends move farther apart than `longest` are halved, too, down to a sixth of that.
    """
    found = Subdivision(mesh, None)
    moved = None if image is None else image(mesh.vertices)
    for _ in range(_MOST_ROUNDS):
        finer = _halved(found.mesh, longest, moved)
        if finer is None or len(finer.mesh.vertices) > most_vertices:
            break
        found = finer if found.parents is None else Subdivision(finer.mesh, found.parents[finer.parents])
        if image is not None:
            moved = np.concatenate([moved, image(finer.mesh.vertices[len(moved) :])])
    return found


def bendable(mesh: TriangleMesh, most_vertices: int = 60_000, image: Image | None = None) -> Subdivision:
    """Divide edges that are too long to bend, so that a shape can be deformed like a limb; the surface does not change.

    Parameters
    ----------
    mesh : TriangleMesh
        Of any topology.
    most_vertices : int
        Subdivision ends before it exceeds this number, or that of the mesh.
    image : callable, optional
        Where points of the shape move; edges that become too long are divided, too.
    """
    return with_short_edges(mesh, _BENDING * mesh.root_area, max(len(mesh.vertices), most_vertices), image)


@dataclass(frozen=True)
class HalvedEdges:
    """A mesh with some of its edges halved.

    Attributes
    ----------
    mesh : TriangleMesh
        The same surface. The vertices of the original mesh come first, then the midpoints of edges.
    parents : (m,) int64
        The original triangle of each triangle.
    ends : (s, 2) int64
        The ends of the edge of each new vertex.
    """

    mesh: TriangleMesh
    parents: NDArray[np.int64]
    ends: NDArray[np.int64]


def with_edges_halved(mesh: TriangleMesh, use: EdgeUse, chosen: NDArray[np.bool_]) -> HalvedEdges:
    """Halve some edges and split the adjacent triangles into two, three or four, without cracks.

    Unsplit triangles come first. Among these, rows 2 i and 2 i + 1 that remain such a pair come before others, so that
    two triangles that make a quad stay together.

    Parameters
    ----------
    mesh : TriangleMesh
        Of any topology.
    use : EdgeUse
        `edge_use(mesh.faces)`.
    chosen : (e,) bool
        Mask of the edges, in the order of `use`.
    """
    count = len(mesh.vertices)
    numbers = np.where(chosen, count + np.cumsum(chosen) - 1, -1)
    middles = np.empty(mesh.faces.size, np.int64)
    middles[use.side] = np.repeat(numbers, use.count)
    ends = edge_ends(mesh.faces, use)[chosen]
    first, second = (mesh.vertices.take(end, axis=0) for end in ends.T)
    vertices = np.concatenate([mesh.vertices, 0.5 * (first + second)])
    parts, parents = _cut(mesh.faces, middles.reshape(-1, 3), vertices)
    return HalvedEdges(TriangleMesh(vertices, parts), parents, ends)


def _halved(mesh: TriangleMesh, longest: float, moved: NDArray[np.float64] | None) -> HalvedEdges | None:
    """Halve every edge once that is long, or becomes so with moved vertices; None if there is none."""
    use = edge_use(mesh.faces)
    ends = edge_ends(mesh.faces, use)
    lengths = edge_lengths(mesh.vertices, ends)
    long = lengths > longest
    if moved is not None:
        long |= (lengths > _SHORTEST * longest) & (edge_lengths(moved, ends) > longest)
    return with_edges_halved(mesh, use, long) if long.any() else None


def _cut(
    faces: NDArray[np.int64], middles: NDArray[np.int64], vertices: NDArray[np.float64]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Split triangles at the midpoints of their edges, -1 for none; return the parts and their original triangles."""
    number = (middles >= 0).sum(axis=1)
    whole = number == 0
    rows = np.arange(len(faces))
    paired = whole & whole[np.minimum(rows ^ 1, len(faces) - 1)] & ((rows ^ 1) < len(faces))
    owners = [rows[paired], rows[whole & ~paired]]
    parts = [faces[own] for own in owners]
    # Rotate corners so that the only edge to split, or the only edge not to split, comes first.
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
        # Split the quadrilateral along its shorter diagonal.
        across = np.linalg.norm(vertices[a] - vertices[bc], axis=1) <= np.linalg.norm(
            vertices[b] - vertices[ca], axis=1
        )
        parts.append(np.where(across[:, None], np.stack([a, b, bc], axis=1), np.stack([a, b, ca], axis=1)))
        parts.append(np.where(across[:, None], np.stack([a, bc, ca], axis=1), np.stack([b, bc, ca], axis=1)))
    quartered = np.flatnonzero(number == 3)
    a, b, c = faces[quartered].T
    ab, bc, ca = middles[quartered].T
    parts += [np.stack(part, axis=1) for part in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))]
    return np.concatenate(parts), np.concatenate([*owners, *[quartered] * 4])
