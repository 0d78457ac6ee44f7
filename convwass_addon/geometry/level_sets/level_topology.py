# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Components and Euler number of a marching cubes surface, counted on the cells without extracting the surface."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray
from skimage.measure import marching_cubes

from ..grids.labelling import Pieces

_CORNERS = np.array(list(np.ndindex(2, 2, 2)))
# Offsets of cells that share only an edge, each with the offsets of the two cells between them.
_ACROSS = [
    (np.array(offset), [np.where(np.arange(3) == axis, offset, 0) for axis in np.flatnonzero(offset)])
    for offset in np.ndindex(3, 3, 3)
    for offset in [np.array(offset) - 1]
    if np.abs(offset).sum() == 2
]


def pieces_above(density: NDArray[np.floating], level: float) -> Pieces:
    """Return the components of the set where a density, (nx, ny, nz), exceeds a level."""
    return _joined_across(Pieces.of(density > level), density, level)


def hollows_below(density: NDArray[np.floating], level: float) -> Pieces:
    """Return the components of the complement that do not touch the boundary of the grid."""
    return _joined_across(Pieces.of(density <= level), density, level).within()


def euler_number(density: NDArray[np.floating], level: float) -> int:
    """Vertices - triangles / 2 of the closed isosurface of a density, (nx, ny, nz), that is zero outside the grid."""
    return round(float(euler_numbers_within(np.pad(density, 1)[None], level)[0]))


def euler_numbers_within(windows: NDArray[np.floating], level: float) -> NDArray[np.float64]:
    """Return the same for parts of a grid, (k, mx, my, mz), cut open at their boundaries, (k,).

    A change inside a part changes this by the same amount as the Euler number of the whole surface.
    """
    codes = _corner_codes(windows > level)
    mixed = np.flatnonzero((codes > 0) & (codes < 255))
    found = codes[mixed]
    table = _cube_table()
    shares = table.share[found]
    unclear = np.flatnonzero(table.ambiguous[found])
    if len(unclear):
        part, *low = np.unravel_index(mixed[unclear], windows.shape)
        corners = np.stack(low, axis=-1)[:, None] + _CORNERS
        shares[unclear] = _shares(windows[part[:, None], *np.moveaxis(corners, 2, 0)] / level - 1.0)
    return np.bincount(mixed // max(windows[0].size, 1), shares, minlength=len(windows))


def _corner_codes(inside: NDArray[np.bool_]) -> NDArray[np.uint8]:
    """Return which corners of every cube are inside, as bits in the order of `_CORNERS`, at its first corner.

    Parameters
    ----------
    inside : (k, mx, my, mz) bool
        Parts of a grid.

    Returns
    -------
    (k * mx * my * mz,) uint8
        Zero at the last cells of every axis, where no cube begins. Shifts of the flat array are several times as fast
        as shifts along the axes of small parts.
    """
    codes = inside.ravel().view(np.uint8).copy()
    for doubling, axis in enumerate((3, 2, 1)):
        step = int(np.prod(inside.shape[axis + 1 :]))
        codes[: len(codes) - step] |= codes[step:] << np.uint8(2**doubling)
    boxes = codes.reshape(inside.shape)
    boxes[:, -1], boxes[:, :, -1], boxes[..., -1] = 0, 0, 0
    return codes


@dataclass(frozen=True)
class _CubeTable:
    """Contribution of a cube to the Euler number by which corners are inside, (256,), and where it is ambiguous."""

    share: NDArray[np.float64]
    ambiguous: NDArray[np.bool_]


@cache
def _cube_table() -> _CubeTable:
    inside = (np.arange(256)[:, None] >> np.arange(8)) & 1 > 0
    share = np.zeros(256)
    share[1:255] = _shares(np.where(inside[1:255], 1.0, -1.0))
    ambiguous = np.zeros(256, bool)
    # Two opposite corners of a face against the other two, or two opposite corners of the cube against all others.
    for axis in range(3):
        for side in (0, 1):
            a, b, c, d = inside[:, _CORNERS[:, axis] == side].T
            ambiguous |= (a == d) & (b == c) & (a != b)
    for corner in range(4):
        pair = np.isin(np.arange(8), [corner, 7 - corner])
        ambiguous |= (inside == pair).all(axis=1) | (inside != pair).all(axis=1)
    return _CubeTable(share, ambiguous)


def _shares(cubes: NDArray[np.floating]) -> NDArray[np.float64]:
    """Return the contributions of cubes to the Euler number, (n,), from the excess density at their corners, (n, 8)."""
    # Cubes stand in a row, and the mask skips those between them. Releases differ in which corner of a cube the mask
    # uses.
    row = np.ascontiguousarray(cubes.reshape(-1, 2, 2, 2).transpose(1, 2, 0, 3).reshape(2, 2, -1), np.float32)
    wanted = np.zeros(row.shape, bool)
    wanted[0, 0, ::2] = wanted[1, 1, 1::2] = True
    vertices, faces, _, _ = marching_cubes(row, 0.0, mask=wanted)
    owner = (vertices[:, 2] // 2).astype(np.int64)
    inside = cubes.reshape(-1, 2, 2, 2) > 0.0
    crossed = sum(np.count_nonzero(np.diff(inside, axis=axis), axis=(1, 2, 3)) for axis in (1, 2, 3))
    # A vertex on an edge belongs to four cubes, a vertex inside a cube only to that one.
    own_vertices, own_faces = (np.bincount(own, minlength=len(cubes)) for own in (owner, owner[faces[:, 0]]))
    return own_vertices - 0.75 * crossed - 0.5 * own_faces


def _joined_across(pieces: Pieces, density: NDArray[np.floating], level: float) -> Pieces:
    """Merge components that touch along an edge if the surface does: Nielson and Hamann's asymptotic decider (1991)."""
    if pieces.count < 2:
        return pieces
    # Checking all but the largest component visits every pair.
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
