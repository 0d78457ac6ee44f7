# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Flat morphs whose shapes move towards each other: each blend transports only the remaining difference."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from ...progress import Control
from ..morphs.blend_solver import ALONE, BlendSolver
from ..morphs.coinciding_solids import CoincidingSolids
from ..morphs.layouts import Blend
from ..morphs.moved_room import room_of_moved
from ..morphs.parts import SplitShapes
from ..morphs.transport_problem import TransportProblem
from .flat_blending import coinciding_frame, input_frame, surfaced_frame
from .flat_frames import FlatFrame
from .flat_layers import input_layers
from .flat_motion import FlatMotion, MovedPart
from .flat_origins import FlatOrigins, MovedOrigins, PartGrid
from .flat_problem import FlatProblem
from .flat_shapes import FlatInput

# Number of blends at which the extent of moved shapes is measured for the grid.
_SAMPLED_BLENDS = 33
# Blur in cells with which the parts of a blend are distinguished.
_ABOUT = 2.0


@dataclass(frozen=True)
class FlatMovingProblem:
    """The problem shared by all blends of moving flat shapes.

    Attributes
    ----------
    still : FlatProblem
        The shapes at rest, on a grid that also holds the moved shapes; blends get their areas and connectivity.
    motion : FlatMotion
        The positions of the shapes' parts in every blend.
    """

    still: FlatProblem
    motion: FlatMotion

    @classmethod
    def of(
        cls,
        still: FlatProblem,
        shapes: Sequence[FlatInput],
        motion: FlatMotion,
        blends: Sequence[Blend],
        control: Control,
    ) -> FlatMovingProblem:
        """Lay out a grid that holds the moved shapes, (k,), of all `blends`."""

        def bounds(weights: Sequence[float]) -> Iterator[NDArray[np.float64]]:
            return (own.boundary.bounds for part in motion.moved(weights) for own in part if own is not None)

        lattice = still.lattice.holding(room_of_moved(bounds, still.lattice.centers, blends, _SAMPLED_BLENDS, control))
        layers = input_layers(shapes, lattice) if still.layers else ()
        return cls(still.on(lattice, layers), motion)

    def frame(self, blend: Blend, control: Control) -> FlatFrame:
        """Compute one blend; an input with a weight of one is shown unchanged."""
        if blend.source is not None:
            return input_frame(self.still, blend)
        control.check()
        active = np.flatnonzero(blend.weights)
        moved = [[part[index] for index in active] for part in self.motion.moved(blend.weights)]
        filled = self._filled(blend, moved)
        occupancies = [np.clip(sum(own[place] for own in filled), 0.0, 1.0) for place in range(len(active))]
        weights = [blend.weights[index] for index in active]
        solids = CoincidingSolids.of(occupancies, weights, self.still.silhouette(blend))
        if solids.coincide:
            return coinciding_frame(self.still, blend, solids, self._origins(blend, moved, filled, None))
        problem = self._problem_of(blend, filled, active)
        alone = Blend(tuple(weights))
        solved = BlendSolver(problem.transport, control, ALONE).solve(alone, problem.blend_areas(alone))
        transported = FlatOrigins.of(problem, solved) if self.still.settings.carry else None
        origins = self._origins(blend, moved, filled, transported)
        return surfaced_frame(self.still, replace(solved, blend=blend), origins, solids)

    def _filled(self, blend: Blend, moved: Sequence[Sequence[MovedPart]]) -> list[list[NDArray[np.float64]]]:
        """Return the fraction of every cell that each part fills, by part and by input of positive weight."""
        return [[self.still.lattice.filled(own.boundary, blend.weights) for own in part] for part in moved]

    def _problem_of(
        self, blend: Blend, filled: Sequence[list[NDArray[np.float64]]], active: NDArray[np.int64]
    ) -> FlatProblem:
        """Return the problem of the moved parts of one blend, with the areas of the shapes at rest."""
        center = np.asarray(blend.weights) @ self.still.lattice.centers
        lattice = replace(self.still.lattice, centers=np.tile(center, (len(active), 1)))
        names = tuple(part.name for part in self.still.transport.parts)
        volumes = np.stack([part.volumes[active] for part in self.still.transport.parts])
        split = SplitShapes(names, tuple([own.astype(np.float32) for own in part] for part in filled), volumes, ())
        transport = TransportProblem.of(split, lattice, self.still.settings)
        return replace(self.still, transport=transport)

    def _origins(
        self,
        blend: Blend,
        moved: Sequence[Sequence[MovedPart]],
        filled: Sequence[list[NDArray[np.float64]]],
        transported: FlatOrigins | None,
    ) -> MovedOrigins | None:
        if not self.still.settings.carry:
            return None
        weights = [weight for weight in blend.weights if weight > 0]
        about = [gaussian_filter(sum(w * own for w, own in zip(weights, part, strict=True)), _ABOUT) for part in filled]
        grid = PartGrid.of(self.still.lattice, blend.weights, about)
        return MovedOrigins(tuple(tuple(part) for part in moved), grid, transported)
