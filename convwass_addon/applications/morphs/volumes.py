# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes as distributions on one grid: each is voxelized relative to its own center of mass."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...geometry.meshes.centroid import centroid
from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.solids.occupancy import occupancy
from ...geometry.solids.orientation import orient_outward
from ...geometry.solids.solid_volume import solid_volume
from ...geometry.solids.thicken import LEAST_CELLS, LEAST_THICKNESS, shell_occupancy
from ...progress import UNINTERRUPTED, Control
from ..memory import available_memory, check_memory
from .centered_grid import CenteredGrid
from .memory_needs import peak_bytes


@dataclass(frozen=True)
class Lattice(CenteredGrid):
    """The grid shared by all shapes of a morph in space."""

    multiple = 8

    @classmethod
    def around(
        cls, shapes: Sequence[TriangleMesh], resolution: int, sigma: float, workers: int = 1, parts: int = 1
    ) -> Lattice:
        """Return a grid with `resolution` cells along its longest side that holds all shapes.

        Parameters
        ----------
        shapes : sequence of TriangleMesh
            All shapes.
        resolution : int
            Cells along the longest side.
        sigma : float
            Blur in cells.
        workers, parts : int
            Number of solving threads, and of parts of every shape; both take memory.

        Raises
        ------
        InputError
            A resolution too small for a shape and its blur.
        ResourceError
            A grid too large for the memory.
        """
        # The centers of solids must not depend on which way their faces point.
        centers = np.stack([centroid(orient_outward(shape)) for shape in shapes])
        lattice = cls.of_bounds([shape.bounds for shape in shapes], centers, resolution, sigma)
        check_memory(lattice.memory(shapes, workers, parts), resolution, workers)
        return lattice

    def memory(self, shapes: Sequence[TriangleMesh], workers: int, parts: int) -> int:
        """Peak memory in bytes of a job with these shapes, solving threads, and parts of every shape."""
        cells = float(np.prod(self.shape))
        filled = max(abs(shape.volume) for shape in shapes) / (self.spacing**3 * cells)
        return peak_bytes(cells, filled, len(shapes), workers, parts)

    def shell_cells(self, thickness: float) -> float:
        """Convert the thickness of a sheet from scene units to cells, at least two.

        Raises
        ------
        InputError
            The thickness exceeds the grid.
        """
        most = max(self.shape) * self.spacing
        if thickness > most:
            raise InputError(
                "A thickness of {thickness:.3g} is more than the shapes are large; take less than {most:.3g}.",
                thickness=thickness,
                most=most,
            )
        return max(thickness / self.spacing, LEAST_THICKNESS)

    def to_cells(self, mesh: TriangleMesh, index: int) -> NDArray[np.float64]:
        """Convert the triangles of input `index` to cells, (m, 3, 3)."""
        return (mesh.corners - self.centers[index] - self.origin) / self.spacing

    def to_scene(self, mesh: TriangleMesh, weights: NDArray[np.float64]) -> TriangleMesh:
        """Convert a surface from cells to scene space, at the weighted mean of the centers."""
        return TriangleMesh(mesh.vertices * self.spacing + self.origin + weights @ self.centers, mesh.faces)


def fitting_workers(lattice: Lattice, shapes: Sequence[TriangleMesh], parts: int, most: int) -> int:
    """Return how many threads, from one to `most`, can solve at the same time in the available memory."""
    free = available_memory()
    if free is None:
        return most
    return next((count for count in range(most, 1, -1) if lattice.memory(shapes, count, parts) <= free), 1)


def voxelized(
    shape: TriangleMesh,
    name: str,
    index: int,
    lattice: Lattice,
    thickness: float,
    control: Control = UNINTERRUPTED,
) -> NDArray[np.float32]:
    """Return the occupancy of a shape on its grid, values in [0, 1].

    Parameters
    ----------
    shape, name
        The input and its name, for messages.
    index : int
        Its index among the inputs.
    lattice : Lattice
        The grid.
    thickness : float
        Thickness in scene units for a shape that encloses nothing; 0 rejects it.
    control : Control
        Stops the work.

    Raises
    ------
    InputError
        The shape encloses nothing, or is too small compared with the others.
    """
    outward = orient_outward(shape)
    control.check()
    corners = lattice.to_cells(outward, index)
    filled = occupancy(corners, lattice.shape, control)
    if filled.sum() < LEAST_CELLS and thickness > 0:
        cells = lattice.shell_cells(thickness)
        filled = shell_occupancy(corners, lattice.shape, cells)
    if filled.sum() < LEAST_CELLS:
        raise _refusal(outward, name, lattice, thickness)
    return filled


def _refusal(outward: TriangleMesh, name: str, lattice: Lattice, thickness: float) -> InputError:
    """Return the error for a shape that fills too few cells: it encloses nothing, or the others are much larger."""
    extent = outward.longest_side
    if extent > 0.0:
        alone = extent / max(lattice.shape)  # the size of a cell if there were no other shape
        if thickness > 0 or solid_volume(outward) >= LEAST_CELLS * alone**3:
            return InputError(
                "'{name}' is too small next to the other shapes on this grid: it is {extent:.2g} cells long. Set Scale "
                "to Equal Volume (--scale equal-volume), scale it up, or use a finer resolution.",
                name=name,
                extent=extent / lattice.spacing,
            )
    return InputError(
        "'{name}' encloses no volume at this resolution, so there is nothing to move. Give it thickness (the "
        "Thickness setting, --thickness, or a Solidify modifier); a small solid needs more resolution.",
        name=name,
    )
