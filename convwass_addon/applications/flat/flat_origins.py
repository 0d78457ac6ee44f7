# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the matter of a flat blend comes from; :mod:`.origins` says how that is known."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..morphs.blend_solver import SolvedBlend
from ..morphs.origins import Displacements, part_transports
from .flat_motion import MovedPart
from .flat_problem import FlatProblem

# Which part has most of the mass is kept for every so many cells.
_STRIDE = 2


@dataclass(frozen=True)
class FlatOrigins:
    """The transport maps of a flat blend onto its inputs.

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
        Low corner of the grid about the blend, scene units.
    corners : (k, 2) float64
        The same about every input.
    """

    maps: tuple[Displacements, ...]
    active: NDArray[np.int64]
    owners: NDArray[np.int16]
    spacing: float
    corner: NDArray[np.float64]
    corners: NDArray[np.float64]

    @classmethod
    def of(cls, problem: FlatProblem, solved: SolvedBlend) -> FlatOrigins:
        """Read the maps of a blend off the potentials of its parts."""
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
        """Places that matter comes from.

        Parameters
        ----------
        points : (n, 2)
            In or on the blend, scene units.

        Returns
        -------
        (k, n, 2) float64
            On every input, where it stands in its plane; for an input of weight 0, which no map leads to, the point
            itself, moved as the centers of mass are.
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
    """Where the matter of a blend of moving shapes comes from: through the transport, and back along the motion.

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
        Low corner of the grid about the blend, scene units.
    corners : (k, 2) float64
        The same about every input.
    transported : FlatOrigins or None
        Onto the moved shapes; None where these coincide.
    """

    parts: Sequence[Sequence[MovedPart]]
    active: NDArray[np.int64]
    owners: NDArray[np.int16]
    spacing: float
    corner: NDArray[np.float64]
    corners: NDArray[np.float64]
    transported: FlatOrigins | None

    def at(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Places that matter comes from, (k, n, 2); see :meth:`FlatOrigins.at`."""
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
