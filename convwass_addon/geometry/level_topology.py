# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Pieces and Euler number of a level set, counted on the cells as marching cubes would draw it, without drawing it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray
from skimage.measure import marching_cubes

from .labelling import Pieces

_CORNERS = np.array(list(np.ndindex(2, 2, 2)))
# Cells across an edge from each other: their difference, and the two cells that lie between them.
_ACROSS = [
    (np.array(offset), [np.where(np.arange(3) == axis, offset, 0) for axis in np.flatnonzero(offset)])
    for offset in np.ndindex(3, 3, 3)
    for offset in [np.array(offset) - 1]
    if np.abs(offset).sum() == 2
]


def pieces_above(density: NDArray[np.floating], level: float) -> Pieces:
    """Return the pieces of the set where a density, (nx, ny, nz), exceeds a level."""
    return _joined_across(Pieces.of(density > level), density, level)


def hollows_below(density: NDArray[np.floating], level: float) -> Pieces:
    """Return the pieces of the rest that do not reach the walls of the grid, (x, y, z)."""
    return _joined_across(Pieces.of(density <= level), density, level).within()


def euler_number(density: NDArray[np.floating], level: float) -> int:
    """Vertices - triangles / 2 of the closed surface at a level of a density, (nx, ny, nz), surrounded by zeros."""
    return round(float(euler_numbers_within(np.pad(density, 1)[None], level)[0]))


def euler_numbers_within(windows: NDArray[np.floating], level: float) -> NDArray[np.float64]:
    """Return the same for parts of a grid, (k, mx, my, mz), cut open at their walls, (k,).

    What changes inside a part changes this as it changes the surface's Euler number.
    """
    inside = (windows > level).view(np.uint8)
    codes = np.zeros((len(windows), *np.subtract(windows.shape[1:], 1)), np.uint8)
    for bit, corner in enumerate(_CORNERS):
        at_corner = tuple(slice(c, c + n) for c, n in zip(corner, codes.shape[1:], strict=True))
        codes |= inside[(slice(None), *at_corner)] << np.uint8(bit)
    mixed = np.flatnonzero((codes > 0) & (codes < 255))
    found = codes.ravel()[mixed]
    table = _cube_table()
    shares = table.share[found]
    unclear = np.flatnonzero(table.ambiguous[found])
    if len(unclear):
        part, *low = np.unravel_index(mixed[unclear], codes.shape)
        corners = np.stack(low, axis=-1)[:, None] + _CORNERS
        shares[unclear] = _shares(windows[part[:, None], *np.moveaxis(corners, 2, 0)] / level - 1.0)
    return np.bincount(mixed // max(codes[0].size, 1), shares, minlength=len(windows))


@dataclass(frozen=True)
class _CubeTable:
    """What a cube adds to the Euler number by which of its corners are inside, (256,), and where that is open."""

    share: NDArray[np.float64]
    ambiguous: NDArray[np.bool_]


@cache
def _cube_table() -> _CubeTable:
    inside = (np.arange(256)[:, None] >> np.arange(8)) & 1 > 0
    share = np.zeros(256)
    share[1:255] = _shares(np.where(inside[1:255], 1.0, -1.0))
    ambiguous = np.zeros(256, bool)
    # Two corners across a face with the others on the other side, or two at opposite ends of the cube with all others.
    for axis in range(3):
        for side in (0, 1):
            a, b, c, d = inside[:, _CORNERS[:, axis] == side].T
            ambiguous |= (a == d) & (b == c) & (a != b)
    for corner in range(4):
        pair = np.isin(np.arange(8), [corner, 7 - corner])
        ambiguous |= (inside == pair).all(axis=1) | (inside != pair).all(axis=1)
    return _CubeTable(share, ambiguous)


def _shares(cubes: NDArray[np.floating]) -> NDArray[np.float64]:
    """Return what cubes add to the Euler number, (n,); `cubes` are the excess densities at their corners, (n, 8)."""
    # All in one row; those between them are left out. Where a mask says which depends on the release.
    row = np.ascontiguousarray(cubes.reshape(-1, 2, 2, 2).transpose(1, 2, 0, 3).reshape(2, 2, -1), np.float32)
    wanted = np.zeros(row.shape, bool)
    wanted[0, 0, ::2] = wanted[1, 1, 1::2] = True
    vertices, faces, _, _ = marching_cubes(row, 0.0, mask=wanted)
    owner = (vertices[:, 2] // 2).astype(np.int64)
    inside = cubes.reshape(-1, 2, 2, 2) > 0.0
    crossed = sum(np.count_nonzero(np.diff(inside, axis=axis), axis=(1, 2, 3)) for axis in (1, 2, 3))
    # A vertex on an edge belongs to four cubes, one inside a cube to that alone.
    own_vertices, own_faces = (np.bincount(own, minlength=len(cubes)) for own in (owner, owner[faces[:, 0]]))
    return own_vertices - 0.75 * crossed - 0.5 * own_faces


def _joined_across(pieces: Pieces, density: NDArray[np.floating], level: float) -> Pieces:
    """Join pieces that touch along an edge where the surface does: Nielson and Hamann's asymptotic decider (1991)."""
    if pieces.count < 2:
        return pieces
    # Every pair of pieces is met from one of both.
    smaller = np.arange(pieces.count + 1) > 0
    smaller[1 + np.argmax(pieces.sizes[1:])] = False
    flat = pieces.cells(smaller)
    cells, names = np.stack(np.unravel_index(flat, pieces.shape), axis=-1), pieces.at(flat)
    pairs = []
    for offset, between in _ACROSS:
        other = cells + offset
        reached = ((other >= 0) & (other < pieces.shape)).all(axis=1)
        own, there, a = cells[reached], other[reached], names[reached]
        b = pieces.at(np.ravel_multi_index(there.T, pieces.shape))
        apart = (b > 0) & (a != b)
        own, there = own[apart], there[apart]
        along = np.prod([density[tuple(place.T)] - level for place in (own, there)], axis=0)
        beside = np.prod([density[tuple((own + step).T)] - level for step in between], axis=0)
        pairs.append(np.stack([a[apart], b[apart]])[:, along > beside])
    first, second = np.concatenate(pairs, axis=1)
    return pieces.joined(first, second)
