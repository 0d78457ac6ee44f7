# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Origins of the matter of flat blends; see :mod:`.origins` for the method."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..morphs.blend_solver import SolvedBlend
from ..morphs.origins import Displacements, part_transports
from .flat_lattice import FlatLattice
from .flat_motion import MovedPart
from .flat_problem import FlatProblem

# The part with most of the mass is stored for every second cell.
_STRIDE = 2


@dataclass(frozen=True)
class PartGrid:
    """The grid around a flat blend, and the parts that its cells belong to.

    Attributes
    ----------
    active : (a,) int64
        Inputs of positive weight.
    owners : (mx, my) int16
        The part that has most of the mass, for every cell, or for some at even steps.
    spacing : float
        Size of a cell in scene units.
    corner : (2,) float64
        Low corner of the grid around the blend, scene units.
    corners : (k, 2) float64
        The same for every input.
    """

    active: NDArray[np.int64]
    owners: NDArray[np.int16]
    spacing: float
    corner: NDArray[np.float64]
    corners: NDArray[np.float64]

    @classmethod
    def of(cls, lattice: FlatLattice, weights: Sequence[float], masses: Sequence[NDArray[np.float64]]) -> PartGrid:
        """Return the grid of a blend, given the mass of every part in the cells, (mx, my)."""
        owners = np.argmax(np.stack(masses), axis=0).astype(np.int16)
        corners = lattice.origin + lattice.centers
        return cls(np.flatnonzero(weights), owners, lattice.spacing, lattice.corner(weights), corners)

    def points_by_part(self, places: NDArray[np.float64]) -> Iterator[tuple[int, NDArray[np.int64]]]:
        """Yield the parts that points belong to, and which points these are; places as indices in `owners`, (n, 2)."""
        cells = np.clip(np.floor(places).astype(np.int64), 0, np.subtract(self.owners.shape, 1))
        owner = self.owners[tuple(cells.T)]
        for part in np.unique(owner).tolist():
            yield part, np.flatnonzero(owner == part)


@dataclass(frozen=True)
class FlatOrigins:
    """The transport maps of a flat blend to its inputs.

    Attributes
    ----------
    maps : tuple of Displacements
        One per part.
    grid : PartGrid
        The part of every second cell of both axes.
    """

    maps: tuple[Displacements, ...]
    grid: PartGrid

    @classmethod
    def of(cls, problem: FlatProblem, solved: SolvedBlend) -> FlatOrigins:
        """Compute the maps of a blend from the potentials of its parts."""
        parts = part_transports(solved, problem.transport)
        masses = [part.volume * part.solved.density[::_STRIDE, ::_STRIDE] for part in parts]
        return cls(tuple(map(Displacements.of, parts)), PartGrid.of(problem.lattice, solved.blend.weights, masses))

    def at(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the origins of points.

        Parameters
        ----------
        points : (n, 2)
            In or on the blend, scene units.

        Returns
        -------
        (k, n, 2) float64
            On every input, as it stands in its plane; for an input of weight 0, which has no map, the point itself,
            displaced like the centers of mass.
        """
        grid = self.grid
        cells = (np.asarray(points, dtype=np.float64) - grid.corner) / grid.spacing
        found = np.repeat(cells[None], len(grid.corners), axis=0)
        for part, chosen in grid.points_by_part(cells / _STRIDE):
            found[np.ix_(grid.active, chosen)] += self.maps[part].at(cells[chosen])
        return found * grid.spacing + grid.corners[:, None]


@dataclass(frozen=True)
class MovedOrigins:
    """Origins of a blend of moving shapes: through the transport, and back along the motion.

    Attributes
    ----------
    parts : tuple of tuple of MovedPart
        By part, and by input of positive weight.
    grid : PartGrid
        The part of every cell.
    transported : FlatOrigins or None
        Maps to the moved shapes; None if these coincide.
    """

    parts: Sequence[Sequence[MovedPart]]
    grid: PartGrid
    transported: FlatOrigins | None

    def at(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the origins of points, (k, n, 2); see :meth:`FlatOrigins.at`."""
        points, grid = np.asarray(points, dtype=np.float64), self.grid
        places = [points] * len(grid.active) if self.transported is None else self.transported.at(points)
        found = points + (grid.corners - grid.corner)[:, None]
        for part, chosen in grid.points_by_part((points - grid.corner) / grid.spacing):
            for shape, own, moved in zip(grid.active, places, self.parts[part], strict=True):
                found[shape, chosen] = moved.origins(own[chosen])
        return found
