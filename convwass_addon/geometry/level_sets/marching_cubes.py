# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Marching cubes on whole arrays, for surfaces that are drawn anew many times per second.

On a side of a cube whose corners are alternately inside and outside, the corners inside are always separated. Both
cubes of the side decide the same, so the surface is closed and every edge has two faces. The variant of
scikit-image (Lewiner et al. 2003), which :mod:`.isosurface` uses for final surfaces, decides by the values instead;
it takes more than twice the time (docs/performance, "Live blends").

Corners of a cube are numbered by their offsets: bit `axis` of the number is the offset along that axis.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from itertools import chain, pairwise

import numpy as np
from numpy.typing import NDArray

from ..meshes.mesh import TriangleMesh

# The lower corner and the axis of each edge of a cube.
_EDGES = tuple((corner, axis) for axis in range(3) for corner in range(8) if not corner >> axis & 1)


def marching_cubes(values: NDArray[np.floating], level: float) -> TriangleMesh:
    """Return the surface around the values above a level, closed and oriented outward.

    Parameters
    ----------
    values : (nx, ny, nz)
        Samples at integer coordinates. The outermost ones must not exceed the level.
    level : float
        Value on the surface.

    Raises
    ------
    ValueError
        An outermost sample exceeds the level.
    """
    inside = values > level
    if np.count_nonzero(inside) > np.count_nonzero(inside[1:-1, 1:-1, 1:-1]):
        raise ValueError("the outermost samples must not exceed the level")
    _, ny, nz = values.shape
    # On flat arrays, the cubes that continue from the end of one row to the start of the next are all outside.
    samples, is_inside, strides = values.ravel(), inside.ravel(), (ny * nz, nz, 1)
    crossed = [np.flatnonzero(is_inside[:-stride] != is_inside[stride:]) for stride in strides]
    return TriangleMesh(_crossings(samples, level, crossed, strides), _faces(is_inside, crossed, strides))


def _crossings(
    samples: NDArray[np.floating], level: float, crossed: list[NDArray[np.intp]], strides: tuple[int, int, int]
) -> NDArray[np.float64]:
    """Return where the grid edges cross the level, (n, 3); `crossed` has their lower ends for each axis."""
    rows, along_z = np.divmod(np.concatenate(crossed).astype(np.int32), np.int32(strides[1]))
    vertices = np.empty((len(rows), 3))
    vertices[:, 0], vertices[:, 1] = np.divmod(rows, np.int32(strides[0] // strides[1]))
    vertices[:, 2] = along_z
    begin = 0
    for axis, (lower, stride) in enumerate(zip(crossed, strides, strict=True)):
        first = samples[lower]
        vertices[begin : begin + len(lower), axis] += (level - first) / (samples[lower + stride] - first)
        begin += len(lower)
    return vertices


def _faces(
    is_inside: NDArray[np.bool_], crossed: list[NDArray[np.intp]], strides: tuple[int, int, int]
) -> NDArray[np.int32]:
    """Return the triangles of all cubes, (m, 3); `crossed` has the lower ends of the crossed edges for each axis."""
    vertex_at, begin = np.empty((3, len(is_inside)), np.int32), 0
    for axis, lower in enumerate(crossed):
        vertex_at[axis, lower] = np.arange(begin, begin + len(lower), dtype=np.int32)
        begin += len(lower)
    cases = is_inside.view(np.uint8)
    for axis, stride in enumerate(strides):
        cases = cases[:-stride] | cases[stride:] << (1 << axis)
    # All corners outside is case 0, all inside is case 255.
    cubes = np.flatnonzero(cases - np.uint8(1) < 254)
    table, cases = _table(), cases[cubes]
    counts = table.counts[cases]
    rows = np.repeat(table.starts[cases] - np.cumsum(counts) + counts, counts)
    rows += np.arange(len(rows))
    edges = [axis * len(is_inside) + sum((corner >> a & 1) * strides[a] for a in range(3)) for corner, axis in _EDGES]
    places = np.array(edges, np.int32)[table.triangles][rows]
    places += np.repeat(cubes.astype(np.int32), counts)[:, None]
    return vertex_at.ravel()[places]


@dataclass(frozen=True)
class _Table:
    """The triangles of all 256 cases.

    Attributes
    ----------
    triangles : (t, 3) int64
        Indices into `_EDGES`, sorted by case.
    starts : (256,) int64
        The first triangle of each case.
    counts : (256,) int64
        The number of triangles of each case.
    """

    triangles: NDArray[np.int64]
    starts: NDArray[np.int64]
    counts: NDArray[np.int64]


@cache
def _table() -> _Table:
    found = [[triangle for loop in _loops(case) for triangle in _fan(loop)] for case in range(256)]
    counts = np.array([len(triangles) for triangles in found])
    return _Table(np.array(list(chain.from_iterable(found))), np.cumsum(counts) - counts, counts)


def _loops(case: int) -> list[list[int]]:
    """Return the closed polygons that separate the inside corners of a case, as lists of crossed edges."""
    following: dict[int, int] = {}
    for corners in _sides():
        is_inside = [bool(case >> corner & 1) for corner in corners]
        for i in range(4):
            if is_inside[i] and not is_inside[i - 1]:
                last = next(k for k in range(i, i + 4) if not is_inside[(k + 1) % 4])
                entered = _edge(corners[i - 1], corners[i])
                following[entered] = _edge(corners[last % 4], corners[(last + 1) % 4])
    loops = []
    while following:
        edge, loop = next(iter(following)), []
        while edge in following:
            loop.append(edge)
            edge = following.pop(edge)
        loops.append(loop)
    return loops


def _fan(loop: list[int]) -> list[tuple[int, int, int]]:
    """Divide a polygon into triangles without a diagonal in a side of the cube, which the next cube could have, too."""
    turned = (loop[i:] + loop[:i] for i in range(len(loop)))
    first, *others = next(
        own for own in turned if not any(_planes(own[0]) & _planes(opposite) for opposite in own[2:-1])
    )
    return [(first, *pair) for pair in pairwise(others)]


def _sides() -> list[tuple[int, int, int, int]]:
    """Return the corners of the sides of a cube, counterclockwise seen from outside."""
    sides = []
    for axis in range(3):
        u, v, up = 1 << (axis + 1) % 3, 1 << (axis + 2) % 3, 1 << axis
        sides += [(0, v, u + v, u), (up, up + u, up + u + v, up + v)]
    return sides


def _edge(one: int, other: int) -> int:
    """Return the edge between two corners."""
    return _EDGES.index((min(one, other), (one ^ other).bit_length() - 1))


def _planes(edge: int) -> set[tuple[int, int]]:
    """Return the sides that contain an edge: the axis and the offset of each."""
    corner, own = _EDGES[edge]
    return {(axis, corner >> axis & 1) for axis in range(3) if axis != own}
