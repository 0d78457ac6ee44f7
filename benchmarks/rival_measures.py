# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What becomes of two shapes on the way from one to the other: figures that mean the same for every method."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from convwass_addon.applications.morphs.volumes import Lattice
from convwass_addon.geometry.edges import face_components
from convwass_addon.geometry.mesh import TriangleMesh
from convwass_addon.geometry.occupancy import occupancy
from convwass_addon.transport import Grid, distance_matrix

# Distances are measured with blocks of cells joined so that so many are left along the longest side.
_DISTANCE_CELLS = 40
_DISTANCE_TOLERANCE = 1e-3


@dataclass(frozen=True)
class Passage:
    """Frames from one solid to another, in figures.

    Attributes
    ----------
    outside : float
        Share of the volume between the ends that lies where neither of the two solids is, the mean of the frames: what
        is under way. A fade has nothing there.
    detour : float
        W2 from the first solid to the middle frame and on to the second, over W2 from the first to the second, all as
        distributions of mass 1. It is 1 where all mass goes straight, and up to the square root of 2 where half of the
        first is replaced by half of the second.
    volumes : (n,) float64
        Of the frames, over the straight line between the volumes of the two solids.
    pieces, handles : int
        The most of a mesh between the ends.
    smallest : float
        Share that the smallest piece has of its mesh's volume, the least of all between the ends.
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
            Outward; the first and the last one are those at the ends.
        shapes : sequence of TriangleMesh
            The two that they were made of.
        times : (n,)
            From 0 to 1.
        lattice : Lattice
            About the shapes, both of which stand where the first one does.
        """
        filled, ends = (np.stack([solid(mesh, lattice) for mesh in meshes]) for meshes in (frames, shapes))
        volumes = ends.sum(axis=(1, 2, 3), dtype=np.float64)
        line = np.array([(1.0 - t) * volumes[0] + t * volumes[1] for t in times])
        found = [Hold.of(frame) for frame in frames[1:-1]]
        return cls(
            float(np.mean([_share_outside(frame, ends) for frame in filled[1:-1]])),
            detour(filled[len(filled) // 2], ends),
            filled.sum(axis=(1, 2, 3), dtype=np.float64) / line,
            max(len(hold.shares) for hold in found),
            max(hold.handles for hold in found),
            min(float(hold.shares.min()) for hold in found),
            overlap(filled[-1], ends[1]),
        )


@dataclass(frozen=True)
class Hold:
    """How a closed mesh hangs together.

    Attributes
    ----------
    shares : (n,) float64
        Of every piece in the volume of all.
    handles : int
        Of all pieces together.
    """

    shares: NDArray[np.float64]
    handles: int

    @classmethod
    def of(cls, mesh: TriangleMesh) -> Hold:
        """Count; bubbles, whose surfaces look inward, are no pieces."""
        volumes = np.bincount(face_components(mesh.faces), weights=mesh.face_volumes)
        edges = np.sort(np.stack([mesh.faces, np.roll(mesh.faces, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
        euler = len(np.unique(mesh.faces)) - len(np.unique(edges, axis=0)) + len(mesh.faces)
        solid = volumes[volumes > 0]
        return cls(solid / solid.sum(), len(volumes) - euler // 2)


def solid(mesh: TriangleMesh, lattice: Lattice) -> NDArray[np.float32]:
    """Return which part of every cell a mesh fills that stands where the lattice's first shape does."""
    return occupancy(lattice.to_cells(mesh, 0), lattice.shape)


def overlap(one: NDArray[np.floating], other: NDArray[np.floating]) -> float:
    """Intersection over union of two solids on the same cells."""
    return float(np.minimum(one, other).sum(dtype=np.float64) / np.maximum(one, other).sum(dtype=np.float64))


def detour(middle: NDArray[np.floating], ends: NDArray[np.floating]) -> float:
    """How much longer the way from the first to the second is by way of the middle, in W2; see `Passage`."""
    block = max(1, round(max(middle.shape) / _DISTANCE_CELLS))
    solids = np.stack([_joined(one, block) for one in (ends[0], middle, ends[1])])
    grid = Grid(solids.shape[1:], sigma=1.0)
    lengths = np.sqrt(np.maximum(distance_matrix(solids, grid, tolerance=_DISTANCE_TOLERANCE).values, 0.0))
    return float((lengths[0, 1] + lengths[1, 2]) / lengths[0, 2])


def _share_outside(filled: NDArray[np.floating], ends: NDArray[np.floating]) -> float:
    # By cells: parts of a cell that are filled need not be the same part.
    return float(filled[(ends <= 0.0).all(axis=0)].sum(dtype=np.float64) / filled.sum(dtype=np.float64))


def _joined(filled: NDArray[np.floating], block: int) -> NDArray[np.float64]:
    """Sum up blocks of cells; what does not fill a block is padded by empty cells."""
    padded = np.pad(filled.astype(np.float64), [(0, -n % block) for n in filled.shape])
    sides = [part for n in padded.shape for part in (n // block, block)]
    return padded.reshape(sides).sum(axis=(1, 3, 5))
