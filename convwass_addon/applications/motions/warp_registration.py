# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Register two solids by small elastic steps towards each other, until they meet in the middle."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from ...geometry.grids.divergence import divergence_free
from ...geometry.grids.elastic_steps import elastic_step
from ...geometry.grids.field_extension import extended
from ...geometry.grids.solid_cells import SolidCells
from ...geometry.grids.step_flow import StepFlow
from ...progress import Control, Progress, Work
from ...sentence import Sentence
from ...transport import Grid
from ...transport.meeting import meeting
from ..workers import both_ways

# Values that decrease geometrically from the first round to the last, in cells: blur of the transport plans, distance
# at which mass fades, and size of the parts that move together.
_SIGMAS, _REACHES, _WIDTHS = (2.0, 1.0), (12.0, 6.0), (7.0, 1.5)
# Springs per width: stiffer ones preserve limbs, softer ones fit better. Chosen by eye; `python3 run.py bench
# coherence` measures the effect of all of these.
_STIFFNESS = 0.7
# Cells with a smaller filled fraction do not belong to a solid.
_LEAST_FILLED = 0.1


@dataclass(frozen=True)
class MeetingFlows:
    """Maps that move two solids to where they meet.

    Attributes
    ----------
    first, second : StepFlow
        The map of each solid, in cells.
    """

    first: StepFlow
    second: StepFlow


def meeting_flows(
    first: NDArray[np.float64], second: NDArray[np.float64], rounds: int, control: Control
) -> Work[MeetingFlows]:
    """Move two solids towards each other.

    In every round, one unbalanced plan between the moved solids gives displacements for both. Each solid makes a
    divergence-free elastic step towards them, which is extended outside. Blur, reach and stiffness decrease.

    Parameters
    ----------
    first, second : (nx, ny, nz)
        Filled fractions of the cells of one grid.
    rounds : int
        Number of rounds, at least two.
    control : Control
        Stops the work.
    """
    rests = [np.asarray(solid, np.float64) for solid in (first, second)]
    flows = [StepFlow(rest.shape) for rest in rests]
    solved = None
    for turn in range(rounds):
        yield Progress(turn / rounds, Sentence("Warping the shapes"))
        sigma, reach, width = (_annealed(ends, turn / (rounds - 1)) for ends in (_SIGMAS, _REACHES, _WIDTHS))
        masses = both_ways(lambda k: np.clip(flows[k].carried(rests[k]), 0.0, 1.0))
        met = meeting(*masses, Grid(rests[0].shape, sigma), reach, control, solved)
        solved = met.solved
        both_ways(partial(_advance, flows, masses, met.displacements, _STIFFNESS * width, control))
    return MeetingFlows(*flows)


def _annealed(ends: tuple[float, float], share: float) -> float:
    return ends[0] * (ends[1] / ends[0]) ** share


def _advance(
    flows: Sequence[StepFlow],
    masses: Sequence[NDArray[np.float64]],
    aims: Sequence[NDArray[np.float64]],
    width: float,
    control: Control,
    k: int,
) -> None:
    """Append an elastic step of one of two solids, (nx, ny, nz), towards displacements `aims`, (nx, ny, nz, 3)."""
    flows[k].add(_step(masses[k], aims[k], width, control))


def _step(mass: NDArray[np.float64], aims: NDArray[np.float64], width: float, control: Control) -> NDArray[np.float64]:
    """Return the elastic step of a solid towards displacements of its cells, (nx, ny, nz, 3)."""
    solid = SolidCells.of(mass, _LEAST_FILLED)
    elastic = elastic_step(solid, solid.gathered(aims), solid.filled, width, control)
    kept = divergence_free(solid, elastic, control)
    return extended(solid.scattered(kept), np.where(solid.inside, mass, 0.0))
