# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures of the frames between two shapes that are comparable for all methods."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from convwass_addon.applications.morphs.volumes import Lattice
from convwass_addon.geometry.meshes.edges import face_components
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.solids.occupancy import occupancy
from convwass_addon.transport import Grid, distance_matrix

# For distances, blocks of cells are summed so that this many remain along the longest side.
_DISTANCE_CELLS = 40
_DISTANCE_TOLERANCE = 1e-3


@dataclass(frozen=True)
class Passage:
    """Measures of the frames from one solid to another.

    Attributes
    ----------
    outside : float
        Fraction of the volume outside both solids, mean over the frames between the ends: moving material. It is 0 for
        a fade.
    detour : float
        W2 from the first solid to the middle frame plus W2 from there to the second, over W2 from the first to the
        second, all as distributions of mass 1. It is 1 if all mass moves straight, and the square root of 2 if half of
        the first is replaced by half of the second.
    volumes : (n,) float64
        Volumes of the frames over the linearly interpolated volume of the two solids.
    pieces, handles : int
        Largest number in a frame between the ends.
    smallest : float
        Smallest fraction of a frame's volume in a single component, over all frames between the ends.
    arrival : float
        Intersection over union of the last frame and the second solid.
    """

    outside: float
    detour: float
    volumes: NDArray[np.float64]
    pieces: int
    handles: int
    smallest: float
    arrival: float

    @classmethod
    def of(
        cls, frames: Sequence[TriangleMesh], shapes: Sequence[TriangleMesh], times: Sequence[float], lattice: Lattice
    ) -> Passage:
        """Measure frames.

        Parameters
        ----------
        frames : sequence of TriangleMesh
            Oriented outward; the first and the last are at the ends.
        shapes : sequence of TriangleMesh
            The two shapes that the frames were made from.
        times : (n,)
            From 0 to 1.
        lattice : Lattice
            Grid around the shapes, both at the position of the first.
        """
        filled, ends = (np.stack([solid(mesh, lattice) for mesh in meshes]) for meshes in (frames, shapes))
        volumes = ends.sum(axis=(1, 2, 3), dtype=np.float64)
        line = np.array([(1.0 - t) * volumes[0] + t * volumes[1] for t in times])
        found = [Connectivity.of(frame) for frame in frames[1:-1]]
        return cls(
            float(np.mean([_share_outside(frame, ends) for frame in filled[1:-1]])),
            detour(filled[len(filled) // 2], ends),
            filled.sum(axis=(1, 2, 3), dtype=np.float64) / line,
            max(len(each.shares) for each in found),
            max(each.handles for each in found),
            min(float(each.shares.min()) for each in found),
            overlap(filled[-1], ends[1]),
        )


@dataclass(frozen=True)
class Connectivity:
    """Components and handles of a closed mesh.

    Attributes
    ----------
    shares : (n,) float64
        Fraction of the total volume in each component.
    handles : int
        Handles of all components together.
    """

    shares: NDArray[np.float64]
    handles: int

    @classmethod
    def of(cls, mesh: TriangleMesh) -> Connectivity:
        """Compute them; bubbles, whose surfaces face inward, do not count as components."""
        volumes = np.bincount(face_components(mesh.faces), weights=mesh.face_volumes)
        edges = np.sort(np.stack([mesh.faces, np.roll(mesh.faces, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
        euler = len(np.unique(mesh.faces)) - len(np.unique(edges, axis=0)) + len(mesh.faces)
        solid = volumes[volumes > 0]
        return cls(solid / solid.sum(), len(volumes) - euler // 2)


def solid(mesh: TriangleMesh, lattice: Lattice) -> NDArray[np.float32]:
    """Return the filled fraction of every cell for a mesh at the position of the lattice's first shape."""
    return occupancy(lattice.to_cells(mesh, 0), lattice.shape)


def overlap(one: NDArray[np.floating], other: NDArray[np.floating]) -> float:
    """Intersection over union of two solids on the same cells."""
    return float(np.minimum(one, other).sum(dtype=np.float64) / np.maximum(one, other).sum(dtype=np.float64))


def detour(middle: NDArray[np.floating], ends: NDArray[np.floating]) -> float:
    """Return the length of the path from the first to the second via the middle over the direct one, in W2."""
    block = max(1, round(max(middle.shape) / _DISTANCE_CELLS))
    solids = np.stack([_joined(one, block) for one in (ends[0], middle, ends[1])])
    grid = Grid(solids.shape[1:], sigma=1.0)
    lengths = np.sqrt(np.maximum(distance_matrix(solids, grid, tolerance=_DISTANCE_TOLERANCE).values, 0.0))
    return float((lengths[0, 1] + lengths[1, 2]) / lengths[0, 2])


def _share_outside(filled: NDArray[np.floating], ends: NDArray[np.floating]) -> float:
    # Cell by cell, because the filled parts of a cell need not coincide.
    return float(filled[(ends <= 0.0).all(axis=0)].sum(dtype=np.float64) / filled.sum(dtype=np.float64))


def _joined(filled: NDArray[np.floating], block: int) -> NDArray[np.float64]:
    """Sum blocks of cells; incomplete blocks are padded with empty cells."""
    padded = np.pad(filled.astype(np.float64), [(0, -n % block) for n in filled.shape])
    sides = [part for n in padded.shape for part in (n // block, block)]
    return padded.reshape(sides).sum(axis=(1, 3, 5))
