# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Blends of flat shapes: barycenters, and the outlines and images that are read from them."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from ...progress import UNINTERRUPTED, Control
from ..morphs.blend_solver import BlendSolver, SolvedBlend
from ..morphs.blending import HandOver
from ..morphs.layouts import Blend
from ..morphs.spare_threads import at_once
from ..morphs.thin_shapes import wall_share
from .flat_frames import FlatDensity, FlatFrame
from .flat_origins import FlatOrigins
from .flat_outlines import blend_outline, filled_area, own_outline
from .flat_problem import FlatProblem
from .flat_regions import colored_regions


def solve_flat_blends(
    problem: FlatProblem,
    blends: Sequence[Blend],
    control: Control = UNINTERRUPTED,
    hand_over: HandOver = at_once,
) -> list[FlatFrame]:
    """Solve a run of blends, each started from the one before; the parameters are those of :func:`.solve_blends`."""
    solver = BlendSolver(problem.transport, control)
    frames = []
    for blend in blends:
        if blend.source is not None:
            frames.append(hand_over(partial(_input_frame, problem, blend)))
        else:
            frames.append(hand_over(partial(_frame, problem, solver.solve(blend, problem.blend_areas(blend)))))
    return [frame() for frame in frames]


def _input_frame(problem: FlatProblem, blend: Blend) -> FlatFrame:
    """Frame of an input as it is: its density where densities are asked for."""
    record = {
        "weights": blend.weights,
        "input": blend.source,
        "cell": problem.lattice.spacing,
        "area": problem.transport.input_volume(blend.source),
    }
    if problem.settings.output == "outlines":
        return FlatFrame(blend, None, record)
    occupancy = problem.transport.occupancy(blend.source)
    own = own_outline(occupancy, problem.silhouettes[blend.source])
    outline = problem.lattice.to_scene(own.outline, blend.weights)
    return FlatFrame(blend, outline, record, _image(problem, blend, occupancy))


def _frame(problem: FlatProblem, solved: SolvedBlend) -> FlatFrame:
    """Read a blend from the barycenters of its parts."""
    lattice, settings, blend = problem.lattice, problem.settings, solved.blend
    merged = solved.merged()
    shapes = [problem.connectivity[index] for index in np.flatnonzero(blend.weights)]
    interpolated = merged.volume * problem.fullness(blend)
    area = max(interpolated, filled_area(merged.density)) if settings.output == "outlines" else interpolated
    mending = blend_outline(merged.density, area, shapes, settings)
    outline = lattice.to_scene(mending.drawn.outline, blend.weights)
    record = {
        "weights": blend.weights,
        **solved.figures(),
        "sigma": max(solved.sigmas),
        "wall": wall_share(merged.density),
        "cells": lattice.shape,
        "cell": lattice.spacing,
        "level": mending.drawn.level,
        "area": outline.area,
        "area_wanted": area * lattice.spacing**2,
        "area_interpolated": interpolated * lattice.spacing**2,
        **mending.record(),
        **solved.part_figures(problem.transport, merged),
    }
    density = _image(problem, blend, _mass_per_cell(solved)) if settings.output == "densities" else None
    origins = FlatOrigins.of(problem, solved) if settings.carry else None
    regions = colored_regions(problem, blend, mending, origins) if problem.layers and origins is not None else ()
    return FlatFrame(blend, outline, record, density, origins, regions)


def _mass_per_cell(solved: SolvedBlend) -> NDArray[np.float64]:
    return sum(
        part.density * (mass / part.density.size) for part, mass in zip(solved.parts, solved.volumes, strict=True)
    )


def _image(problem: FlatProblem, blend: Blend, cells: NDArray[np.floating]) -> FlatDensity:
    corner = problem.lattice.corner(blend.weights)
    return FlatDensity(cells.astype(np.float32), problem.lattice.spacing, (float(corner[0]), float(corner[1])))
