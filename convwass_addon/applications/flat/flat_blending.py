# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Blends of flat shapes: barycenters, and the outlines and images extracted from them."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from ...geometry.level_sets.flat_mending import FlatMending
from ...progress import UNINTERRUPTED, Control
from ..morphs.blend_solver import BlendSolver, SolvedBlend
from ..morphs.blending import HandOver
from ..morphs.coinciding_solids import CoincidingSolids
from ..morphs.layouts import Blend
from ..morphs.spare_threads import at_once
from ..morphs.thin_shapes import wall_share
from ..motions.motion import motion_figures
from .flat_frames import FlatDensity, FlatFrame
from .flat_origins import FlatOrigins, MovedOrigins
from .flat_outlines import blend_outline, filled_area, half_max_outline, prepared_density
from .flat_problem import FlatProblem
from .flat_regions import colored_regions


def solve_flat_blends(
    problem: FlatProblem,
    blends: Sequence[Blend],
    control: Control = UNINTERRUPTED,
    hand_over: HandOver = at_once,
) -> list[FlatFrame]:
    """Solve a run of blends, each started from the previous one; parameters as for :func:`.solve_blends`."""
    solver = BlendSolver(problem.transport, control)
    frames = []
    for blend in blends:
        if blend.source is not None:
            frames.append(hand_over(partial(input_frame, problem, blend)))
        else:
            frames.append(hand_over(partial(_frame, problem, solver.solve(blend, problem.blend_areas(blend)))))
    return [frame() for frame in frames]


def _frame(problem: FlatProblem, solved: SolvedBlend) -> FlatFrame:
    return surfaced_frame(problem, solved, FlatOrigins.of(problem, solved) if problem.settings.carry else None)


def input_frame(problem: FlatProblem, blend: Blend) -> FlatFrame:
    """Return the frame of an unblended input; it has a density if densities are requested."""
    record = {
        "weights": blend.weights,
        "input": blend.source,
        "cell": problem.lattice.spacing,
        "area": problem.transport.input_volume(blend.source),
        **motion_figures(problem.motion),
    }
    if problem.settings.output == "outlines":
        return FlatFrame(blend, None, record)
    occupancy = problem.transport.occupancy(blend.source)
    return FlatFrame(blend, problem.outlines[blend.source], record, _image(problem, blend, occupancy))


def surfaced_frame(
    problem: FlatProblem,
    solved: SolvedBlend,
    origins: FlatOrigins | MovedOrigins | None,
    solids: CoincidingSolids | None = None,
) -> FlatFrame:
    """Extract the frame of a blend from the barycenters of its parts.

    Parameters
    ----------
    problem : FlatProblem
        The shapes and the settings.
    solved : SolvedBlend
        The blend.
    origins : FlatOrigins, MovedOrigins or None
        Origins of its matter.
    solids : CoincidingSolids, optional
        The mean of moved shapes: where they agree, it replaces the barycenter.
    """
    settings, blend = problem.settings, solved.blend
    merged = solved.merged()
    interpolated = merged.volume * problem.fullness(blend)
    # Moved shapes nearly coincide, so the matter between them does not spread.
    spreads = settings.output == "outlines" and solids is None
    area = max(interpolated, filled_area(merged.density)) if spreads else interpolated
    if settings.level == "half-max" and solids is None:
        mending = half_max_outline(merged.density)
    else:
        mending = _outline(problem, blend, prepared_density(merged.density, area, solids), area)
    record = {
        **solved.figures(),
        "sigma": max(solved.sigmas),
        "sigma_wanted": settings.sigma,
        "wall": wall_share(merged.density),
        "area_wanted": area * problem.lattice.spacing**2,
        "area_interpolated": interpolated * problem.lattice.spacing**2,
        **solved.part_figures(problem.transport, merged),
    }
    density = _image(problem, blend, _mass_per_cell(solved)) if settings.output == "densities" else None
    return finished_frame(problem, blend, mending, record, origins, density)


def coinciding_frame(
    problem: FlatProblem, blend: Blend, solids: CoincidingSolids, origins: MovedOrigins | None
) -> FlatFrame:
    """Return the mean of moved shapes that coincide, without transport."""
    area = problem.silhouette(blend)
    mending = _outline(problem, blend, solids.density, area)
    wanted = area * problem.lattice.spacing**2
    record = {"converged": True, "area_wanted": wanted, "area_interpolated": wanted}
    return finished_frame(problem, blend, mending, record, origins)


def _outline(problem: FlatProblem, blend: Blend, prepared: NDArray[np.floating], area: float) -> FlatMending:
    shapes = [problem.connectivity[index] for index in np.flatnonzero(blend.weights)]
    return blend_outline(prepared, area, shapes, problem.settings)


def finished_frame(
    problem: FlatProblem,
    blend: Blend,
    mending: FlatMending,
    figures: dict[str, object],
    origins: FlatOrigins | MovedOrigins | None,
    density: FlatDensity | None = None,
) -> FlatFrame:
    """Convert an outline from cells to scene space, and complete its record."""
    lattice = problem.lattice
    outline = lattice.to_scene(mending.drawn.outline, blend.weights)
    record = {
        "weights": blend.weights,
        **figures,
        "cells": lattice.shape,
        "cell": lattice.spacing,
        "level": mending.drawn.level,
        "area": outline.area,
        **mending.record(),
        **motion_figures(problem.motion),
    }
    regions = colored_regions(problem, blend, mending, origins) if problem.layers and origins is not None else ()
    return FlatFrame(blend, outline, record, density, origins, regions)


def _mass_per_cell(solved: SolvedBlend) -> NDArray[np.float64]:
    return sum(
        part.density * (mass / part.density.size) for part, mass in zip(solved.parts, solved.volumes, strict=True)
    )


def _image(problem: FlatProblem, blend: Blend, cells: NDArray[np.floating]) -> FlatDensity:
    corner = problem.lattice.corner(blend.weights)
    return FlatDensity(cells.astype(np.float32), problem.lattice.spacing, (float(corner[0]), float(corner[1])))
