# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Origins of the matter of flat blends; see :mod:`.origins` for the method."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..morphs.blend_solver import SolvedBlend
from ..morphs.origins import Displacements, part_transports
from .flat_motion import MovedPart
from .flat_problem import FlatProblem

# The part with most of the mass is stored for every second cell.
_STRIDE = 2


@dataclass(frozen=True)
class FlatOrigins:
    """The transport maps of a flat blend to its inputs.

    Attributes
    ----------
    maps : tuple of Displacements
        One per part.
    active : (a,) int64
        Inputs of positive weight.
    owners : (mx, my) int16
        The part that has most of the mass, for every second cell of both axes.
    spacing : float
        Size of a cell in scene units.
    corner : (2,) float64
        Low corner of the grid around the blend, scene units.
    corners : (k, 2) float64
        The same for every input.
    """

    maps: tuple[Displacements, ...]
    active: NDArray[np.int64]
    owners: NDArray[np.int16]
    spacing: float
    corner: NDArray[np.float64]
    corners: NDArray[np.float64]

    @classmethod
    def of(cls, problem: FlatProblem, solved: SolvedBlend) -> FlatOrigins:
        """Compute the maps of a blend from the potentials of its parts."""
        lattice, weights = problem.lattice, solved.blend.weights
        parts = part_transports(solved, problem.transport)
        most = np.stack([part.volume * part.solved.density[::_STRIDE, ::_STRIDE] for part in parts])
        return cls(
            tuple(map(Displacements.of, parts)),
            np.flatnonzero(weights),
            np.argmax(most, axis=0).astype(np.int16),
            lattice.spacing,
            lattice.corner(weights),
            lattice.origin + lattice.centers,
        )

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
        cells = (np.asarray(points, dtype=np.float64) - self.corner) / self.spacing
        found = np.repeat(cells[None], len(self.corners), axis=0)
        places = np.floor(cells / _STRIDE).astype(np.int64)
        owner = self.owners[tuple(np.clip(places, 0, np.subtract(self.owners.shape, 1)).T)]
        for index, own in enumerate(self.maps):
            chosen = np.flatnonzero(owner == index)
            if len(chosen):
                found[np.ix_(self.active, chosen)] += own.at(cells[chosen])
        return found * self.spacing + self.corners[:, None]


@dataclass(frozen=True)
class MovedOrigins:
    """Origins of a blend of moving shapes: through the transport, and back along the motion.

    Attributes
    ----------
    parts : tuple of tuple of MovedPart
        By part, and by input of positive weight.
    active : (a,) int64
        Inputs of positive weight.
    owners : (nx, ny) int16
        The part that each cell belongs to.
    spacing : float
        Size of a cell in scene units.
    corner : (2,) float64
        Low corner of the grid around the blend, scene units.
    corners : (k, 2) float64
        The same for every input.
    transported : FlatOrigins or None
        Maps to the moved shapes; None if these coincide.
    """

    parts: Sequence[Sequence[MovedPart]]
    active: NDArray[np.int64]
    owners: NDArray[np.int16]
    spacing: float
    corner: NDArray[np.float64]
    corners: NDArray[np.float64]
    transported: FlatOrigins | None

    def at(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the origins of points, (k, n, 2); see :meth:`FlatOrigins.at`."""
        points = np.asarray(points, dtype=np.float64)
        places = [points] * len(self.active) if self.transported is None else self.transported.at(points)
        found = points + (self.corners - self.corner)[:, None]
        cells = np.floor((points - self.corner) / self.spacing).astype(np.int64)
        owner = self.owners[tuple(np.clip(cells, 0, np.subtract(self.owners.shape, 1)).T)]
        for index, part in enumerate(self.parts):
            chosen = np.flatnonzero(owner == index)
            for shape, own, moved in zip(self.active, places, part, strict=True):
                if len(chosen):
                    found[shape, chosen] = moved.origins(own[chosen])
        return found
