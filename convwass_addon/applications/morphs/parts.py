# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts of shapes that travel together: the head of one becomes the head of the other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter
from scipy.spatial import cKDTree

from ...geometry.arrays.label_sums import label_sums
from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.solids.thicken import surface_points
from ...progress import Control
from .part_labels import Matching, PartNotice
from .volumes import Lattice, voxelized

# Parts of fewer cells are merged with the rest.
_LEAST_CELLS = 20.0
# One part fades into the next over this fraction of the longest side, at least a cell. Parts that end abruptly leave
# cracks and ridges where they come to lie slightly apart or inside each other; fading leaves few.
_FADE = 1.0 / 40.0
# Name of everything that is in no part.
_REST = "the rest"


@dataclass(frozen=True)
class SplitShapes:
    """Shapes divided into parts.

    Attributes
    ----------
    names : tuple of str
        One per part.
    densities : tuple of list of (nx, ny, nz) float32
        For every part, its occupancy in every shape.
    volumes : (p, k) float64
        Volumes of the parts in cells.
    notices : tuple of PartNotice
        Messages to the user.
    """

    names: tuple[str, ...]
    densities: tuple[list[NDArray[np.float32]], ...]
    volumes: NDArray[np.float64]
    notices: tuple[PartNotice, ...]


def voxelized_parts(
    shape: TriangleMesh,
    name: str,
    index: int,
    lattice: Lattice,
    thickness: float,
    matching: Matching,
    control: Control,
) -> list[NDArray[np.float32]]:
    """Voxelize shape `index` and divide it into its parts; parameters as for :func:`.voxelized`."""
    filled = voxelized(shape, name, index, lattice, thickness, control)
    return part_volumes(filled, lattice.to_cells(shape, index), matching.faces[index], matching.count)


def part_volumes(
    filled: NDArray[np.float32], corners: NDArray[np.float64], faces: NDArray[np.int64], count: int
) -> list[NDArray[np.float32]]:
    """Divide the occupancy of a shape into parts, which add up to it.

    A cell belongs to the part whose surface is nearest; where parts meet, they fade into each other.

    Parameters
    ----------
    filled : (nx, ny, nz) float32
        Occupancy.
    corners : (m, 3, 3) float64
        Triangles in cells.
    faces : (m,) int64
        Part of every triangle.
    count : int
        Number of parts; those without a triangle are empty.
    """
    if count == 1:
        return [filled]
    labels = nearest_labels(filled > 0, corners, faces)
    present = np.unique(labels[labels >= 0])
    empty = np.broadcast_to(np.float32(0), filled.shape)
    parts = [empty] * count
    if len(present) == 1:
        parts[present[0]] = filled
        return parts
    fade = max(1.0, _FADE * max(filled.shape))
    whole = np.maximum(gaussian_filter(filled, fade), np.finfo(np.float32).tiny)
    for part in present:
        share = gaussian_filter(np.where(labels == part, filled, np.float32(0)), fade)
        parts[part] = np.where(filled > 0, filled * (share / whole), np.float32(0))
    return parts


def nearest_labels(
    inside: NDArray[np.bool_], corners: NDArray[np.float64], faces: NDArray[np.int64]
) -> NDArray[np.int16]:
    """Return the label of the surface nearest to every cell center, (nx, ny, nz); -1 where `inside` is not set.

    Parameters
    ----------
    inside : (nx, ny, nz) bool
        Cells to label.
    corners : (m, 3, 3) float64
        Triangles in cells.
    faces : (m,) int64
        Label of every triangle, not negative.
    """
    present = np.unique(faces)
    points = [_mean_points(surface_points(corners[faces == label]), inside.shape) for label in present]
    owners = np.repeat(present, [len(own) for own in points]).astype(np.int16)
    nearest = cKDTree(np.concatenate(points)).query(np.argwhere(inside) + 0.5)[1]
    result = np.full(inside.shape, -1, np.int16)
    result[inside] = owners[nearest]
    return result


def _mean_points(points: NDArray[np.float64], shape: tuple[int, int, int]) -> NDArray[np.float64]:
    """Return the mean point of every cell that has points, (q, 3): searching all points takes ten times as long."""
    cells = np.ravel_multi_index(np.floor(points).astype(np.int64).T, shape, mode="clip")
    counts = np.bincount(cells)
    hit = np.flatnonzero(counts)
    return label_sums(cells, points, len(counts))[hit] / counts[hit, None]


def joined(matching: Matching, volumes: Sequence[list[NDArray[np.float32]]]) -> SplitShapes:
    """Collect the parts of all shapes; parts that are too small on some shape join the rest.

    Parameters
    ----------
    matching : Matching
        The parts.
    volumes : sequence of list of (nx, ny, nz) float32
        For every shape, from :func:`part_volumes`.
    """
    parts = [[shape[p] for shape in volumes] for p in range(matching.count)]
    cells = np.array([[part.sum(dtype=np.float64) for part in row] for row in parts])
    rest, names, notices = len(matching.names), [*matching.names, _REST], list(matching.notices)
    kept = []
    for index in range(rest):
        if cells[index].min() < _LEAST_CELLS:
            notices.append(PartNotice("TOO_SMALL", names[index]))
            _merge(parts, cells, index, rest)
        else:
            kept.append(index)
    if cells[rest].min() >= _LEAST_CELLS or not kept:
        kept.append(rest)
    elif cells[rest].max() > 0:
        # The rest is too small on some shape to be a part of its own.
        largest = max(kept, key=lambda index: cells[index].sum())
        notices.append(PartNotice("NO_REST", names[largest]))
        _merge(parts, cells, rest, largest)
    return SplitShapes(
        tuple(names[index] for index in kept),
        tuple(parts[index] for index in kept),
        cells[kept],
        tuple(notices),
    )


def _merge(parts: list[list[NDArray[np.float32]]], cells: NDArray[np.float64], source: int, target: int) -> None:
    parts[target] = [one + other for one, other in zip(parts[target], parts[source], strict=True)]
    cells[target] += cells[source]
