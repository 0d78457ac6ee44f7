# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes as distributions on one grid: each is voxelized about its own center of mass."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..geometry.centroid import centroid
from ..geometry.mesh import TriangleMesh
from ..geometry.occupancy import occupancy
from ..geometry.orientation import orient_outward
from ..geometry.thicken import shell_occupancy
from ..transport import Grid
from .memory import check_memory

# Sides are multiples of this, so that the grid can be halved several times.
_MULTIPLE = 8
# A solid of fewer cells is no shape any more.
_LEAST_CELLS = 20.0
# Sheets are given at least this thickness, in cells: what survives a morph.
_LEAST_THICKNESS = 2.0
# Bytes per cell at the peak: what every job has, and what one more shape in a blend adds.
_BYTES_PER_CELL = 130
_BYTES_PER_SHAPE = 110


@dataclass(frozen=True)
class Lattice:
    """The common grid of a morph, placed about the center of each shape.

    The barycenter of shapes that are moved is the moved barycenter of the shapes, so only their extents about their
    centers matter: shapes far apart in the scene cost no more than shapes in one place.

    Attributes
    ----------
    shape : (int, int, int)
        Cells per axis.
    spacing : float
        Size of a cell in scene units.
    origin : (3,) float64
        Low corner of the grid relative to a shape's center, scene units.
    centers : (k, 3) float64
        Centers of the shapes, scene units.
    """

    shape: tuple[int, int, int]
    spacing: float
    origin: NDArray[np.float64]
    centers: NDArray[np.float64]

    @classmethod
    def around(cls, shapes: Sequence[TriangleMesh], resolution: int, sigma: float) -> Lattice:
        """Lay a grid of `resolution` cells along its longest side around all the shapes.

        Raises
        ------
        InputError
            A resolution too small to hold a shape and its blur.
        ResourceError
            A grid that does not fit in memory.
        """
        margin = 2 + int(np.ceil(2.0 * sigma))
        if resolution < 4 * margin:
            raise InputError(f"Resolution {resolution} is too coarse; use at least {4 * margin}.")
        centers = np.stack([centroid(shape) for shape in shapes])
        low = np.min([shape.bounds[0] - c for shape, c in zip(shapes, centers, strict=True)], axis=0)
        high = np.max([shape.bounds[1] - c for shape, c in zip(shapes, centers, strict=True)], axis=0)
        extent = high - low
        spacing = float(extent.max()) / (resolution - 2 * margin)
        cells = np.ceil(extent / spacing + 2 * margin)
        cells = (np.ceil(cells / _MULTIPLE) * _MULTIPLE).astype(int)
        check_memory(int(cells.prod()) * (_BYTES_PER_CELL + _BYTES_PER_SHAPE * len(shapes)), resolution)
        origin = (low + high) / 2 - cells * spacing / 2
        return cls(tuple(int(n) for n in cells), spacing, origin, centers)

    def to_cells(self, mesh: TriangleMesh, index: int) -> NDArray[np.float64]:
        """Triangles of input `index` in cells, (m, 3, 3)."""
        return (mesh.corners - self.centers[index] - self.origin) / self.spacing

    def to_scene(self, mesh: TriangleMesh, weights: NDArray[np.float64]) -> TriangleMesh:
        """Bring a surface in cells to the scene, at the weighted mean of the centers."""
        return TriangleMesh(mesh.vertices * self.spacing + self.origin + weights @ self.centers, mesh.faces)

    def grid(self, sigma: float) -> Grid:
        """Return the transport domain with a kernel of `sigma` cells."""
        return Grid(self.shape, sigma)


def voxelize(
    shapes: Sequence[TriangleMesh], names: Sequence[str], lattice: Lattice, thickness: float
) -> Iterator[NDArray[np.float32]]:
    """Yield the occupancy of each shape on its grid, values in [0, 1].

    Parameters
    ----------
    shapes, names
        The inputs, and what messages call them.
    lattice : Lattice
        Where the cells are.
    thickness : float
        Thickness in scene units for shapes that enclose nothing; 0 refuses them.

    Raises
    ------
    InputError
        A shape that encloses nothing, or less than a few cells.
    """
    for index, (shape, name) in enumerate(zip(shapes, names, strict=True)):
        corners = lattice.to_cells(orient_outward(shape), index)
        filled = occupancy(corners, lattice.shape)
        if filled.sum() < _LEAST_CELLS and thickness > 0:
            cells = max(thickness / lattice.spacing, _LEAST_THICKNESS)
            filled = shell_occupancy(corners, lattice.shape, cells)
        if filled.sum() < _LEAST_CELLS:
            raise InputError(
                f"'{name}' encloses no volume at this resolution, so there is nothing to move. Give it thickness "
                "(the Thickness setting, --thickness, or a Solidify modifier); a small solid needs more resolution."
            )
        yield filled
