# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Prepare what all blends of some shapes have in common."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...progress import UNINTERRUPTED, Control, Progress, Work
from ...sentence import Sentence
from ..workers import frame_workers
from .morph_inputs import MorphInputs
from .morph_problem import MorphProblem
from .morph_settings import MorphSettings
from .parts import joined, voxelized_parts
from .volumes import Lattice, fitting_workers

VOXEL_SHARE = 0.08
"""Share of the progress that voxelizing takes."""


def prepared_problem(
    inputs: MorphInputs, settings: MorphSettings, workers: int, threads: int = 1, control: Control = UNINTERRUPTED
) -> Work[MorphProblem]:
    """Voxelize the shapes with progress, and return the problem shared by all runs.

    Memory is checked for `workers` solving threads; up to `threads` voxelize, as far as memory allows.
    """
    problem = yield from sketchable_problem(inputs, settings, workers, threads, control)
    return with_connectivity(problem, min(threads, len(inputs.shapes)), control)


def sketchable_problem(
    inputs: MorphInputs, settings: MorphSettings, workers: int, threads: int = 1, control: Control = UNINTERRUPTED
) -> Work[MorphProblem]:
    """Like :func:`prepared_problem`, without what only finished blends need."""
    shapes, names, matching = inputs.shapes, inputs.names, inputs.matching
    yield Progress(0.0, Sentence("Laying out the grid"))
    lattice = Lattice.around(shapes, settings.resolution, settings.sigma, workers, matching.count)
    control.check()

    def volumes_of(index: int) -> list[NDArray[np.float32]]:
        return voxelized_parts(shapes[index], names[index], index, lattice, settings.thickness, matching, control)

    volumes = []
    with frame_workers(fitting_workers(lattice, shapes, matching.count, min(threads, len(shapes)))) as executor:
        for index, own in enumerate(executor.map(volumes_of, range(len(shapes)))):
            volumes.append(own)
            message = Sentence("Voxelized {name}", {"name": names[index]})
            yield Progress(VOXEL_SHARE * (index + 1) / len(shapes), message)
    problem = MorphProblem.for_sketches(joined(matching, volumes), lattice, settings, shapes)
    problem.transport.require_reachable_limit()
    return problem


def with_connectivity(problem: MorphProblem, threads: int, control: Control = UNINTERRUPTED) -> MorphProblem:
    """Return a problem with the connectivity of its shapes, determined in up to `threads` threads."""
    with frame_workers(threads) as executor:
        return problem.with_connectivity(executor, control)
