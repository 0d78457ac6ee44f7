# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts of shapes that travel together: the head of one becomes the head of the other."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import reduce

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter
from scipy.spatial import cKDTree

from ...errors import InputError
from ...geometry.mesh import TriangleMesh
from ...geometry.thicken import surface_points
from ...sentence import Sentence
from .volumes import Lattice, voxelized

# A part of fewer cells is no shape of its own any more.
_LEAST_CELLS = 20.0
# One part fades into the next over this share of the longest side, a cell at least. Parts that come to lie a little
# apart, or a little inside each other, leave cracks and ridges where they end at once, and few where they fade.
_FADE = 1.0 / 40.0
# What messages call all that is in no part.
_REST = "the rest"

NOTICES: dict[str, str] = {
    "NOT_ON_ALL": "{name} is not on every shape and travels with the rest.",
    "TOO_SMALL": "{name} is too small at this resolution and travels with the rest.",
    "NO_REST": "Too little is in no part on some of the shapes; it travels with {name}.",
}
"""A template for every kind of notice."""


@dataclass(frozen=True)
class FaceLabels:
    """To which part every triangle of a shape belongs.

    Attributes
    ----------
    names : tuple of str
        Parts of the shape, each once.
    faces : (m,) int64
        Indices in `names`; -1 in no part.
    """

    names: tuple[str, ...]
    faces: NDArray[np.int64]

    def renumbered(self, names: Sequence[str]) -> NDArray[np.int64]:
        """Return indices in other names, (m,); ``len(names)`` for what has none of them."""
        places = {name: index for index, name in enumerate(names)}
        table = np.array([*(places.get(name, len(names)) for name in self.names), len(names)])
        return table[self.faces]


@dataclass(frozen=True)
class PartNotice:
    """One thing that the user should know about the parts.

    Attributes
    ----------
    kind : str
        A key of `NOTICES`.
    name : str
        Of the part that it is about.
    """

    kind: str
    name: str

    @property
    def sentence(self) -> Sentence:
        """What to tell."""
        return Sentence(NOTICES[self.kind], {"name": self.name})

    def __str__(self) -> str:
        return str(self.sentence)


@dataclass(frozen=True)
class Matching:
    """Which triangles of all shapes belong together.

    Attributes
    ----------
    names : tuple of str
        Parts that all shapes have.
    faces : tuple of (m,) int64
        For every shape the part of every triangle; ``len(names)`` is the rest.
    notices : tuple of PartNotice
        What the user should know about it.
    """

    names: tuple[str, ...]
    faces: tuple[NDArray[np.int64], ...]
    notices: tuple[PartNotice, ...] = ()

    @property
    def count(self) -> int:
        """Number of parts, with the rest."""
        return len(self.names) + 1


@dataclass(frozen=True)
class SplitShapes:
    """Shapes in parts.

    Attributes
    ----------
    names : tuple of str
        One per part.
    densities : tuple of list of (nx, ny, nz) float32
        For every part the occupancy of its cells in every shape.
    volumes : (p, k) float64
        Volumes of the parts in cells.
    notices : tuple of PartNotice
        What the user should know about it.
    """

    names: tuple[str, ...]
    densities: tuple[list[NDArray[np.float32]], ...]
    volumes: NDArray[np.float64]
    notices: tuple[PartNotice, ...]


def part_notices(record: Mapping[str, object]) -> list[PartNotice]:
    """Return the notices in the record of a frame, which may come from a file; what is none is left out."""
    found = record.get("notices")
    entries = found if isinstance(found, (list, tuple)) else ()
    return [
        PartNotice(*entry)
        for entry in entries
        if isinstance(entry, (list, tuple))
        and len(entry) == 2
        and all(isinstance(word, str) for word in entry)
        and entry[0] in NOTICES
    ]


def unparted(count: int) -> Matching:
    """All of `count` shapes is the rest: one part."""
    return Matching((), tuple(np.zeros(0, np.int64) for _ in range(count)))


def matched(labels: Sequence[FaceLabels], shape_names: Sequence[str]) -> Matching:
    """Match parts of the same name.

    Parameters
    ----------
    labels : sequence of FaceLabels
        One per shape.
    shape_names : sequence of str
        What messages call the shapes.

    Raises
    ------
    InputError
        No name is on all shapes.
    """
    found = [{label.names[i] for i in np.unique(label.faces) if i >= 0} for label in labels]
    common = set.intersection(*found)
    if not common:
        raise InputError(
            "No part is on all shapes under the same name ({has}). Rename them alike, or turn parts off.",
            has=reduce(_listed, map(_parts_of, shape_names, found)),
        )
    notices = tuple(PartNotice("NOT_ON_ALL", name) for name in sorted(set.union(*found) - common))
    names = tuple(name for name in labels[0].names if name in common)
    return Matching(names, tuple(label.renumbered(names) for label in labels), notices)


def _parts_of(shape: str, parts: set[str]) -> Sentence:
    if not parts:
        return Sentence("{shape} has none", {"shape": shape})
    return Sentence("{shape} has {parts}", {"shape": shape, "parts": ", ".join(sorted(parts))})


def _listed(first: Sentence, second: Sentence) -> Sentence:
    return Sentence("{first}; {second}", {"first": first, "second": second})


def voxelized_parts(
    shape: TriangleMesh,
    name: str,
    index: int,
    lattice: Lattice,
    thickness: float,
    matching: Matching,
    check: Callable[[], None] = lambda: None,
) -> list[NDArray[np.float32]]:
    """Voxelize shape `index`, and split what it fills into its parts; for the parameters see :func:`.voxelized`."""
    filled = voxelized(shape, name, index, lattice, thickness, check)
    return part_volumes(filled, lattice.to_cells(shape, index), matching.faces[index], matching.count)


def part_volumes(
    filled: NDArray[np.float32], corners: NDArray[np.float64], faces: NDArray[np.int64], count: int
) -> list[NDArray[np.float32]]:
    """Split the occupancy of a shape into parts, whose sum it stays.

    A cell belongs to the part whose surface is nearest; where parts meet, one fades into the other.

    Parameters
    ----------
    filled : (nx, ny, nz) float32
        Occupancy.
    corners : (m, 3, 3) float64
        Triangles in cells.
    faces : (m,) int64
        Part of every triangle.
    count : int
        How many parts there are; those without a triangle are empty.
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
    """Label of the surface nearest to the center of every cell, (nx, ny, nz); -1 where `inside` is not set.

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
    """One point per cell that has any, (q, 3): with all of them a search takes ten times as long."""
    cells = np.ravel_multi_index(np.floor(points).astype(np.int64).T, shape, mode="clip")
    counts = np.bincount(cells)
    hit = np.flatnonzero(counts)
    return np.stack([np.bincount(cells, weights=axis)[hit] for axis in points.T], axis=1) / counts[hit, None]


def joined(matching: Matching, volumes: Sequence[list[NDArray[np.float32]]]) -> SplitShapes:
    """Bring the parts of all shapes together; what is too small on some shape joins the rest.

    Parameters
    ----------
    matching : Matching
        The parts.
    volumes : sequence of list of (nx, ny, nz) float32
        For every shape, as :func:`part_volumes` gives them.
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
        # Not all shapes have enough outside of their parts for it to be a part.
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
