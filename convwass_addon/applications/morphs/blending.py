# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Blends of voxelized shapes: barycenters and their surfaces, for runs of neighboring blends."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...progress import UNINTERRUPTED, Control
from ..motions.motion import motion_figures
from .blend_solver import BlendSolver, PartSketch, SolvedBlend
from .coinciding_solids import CoincidingSolids
from .detail import detailed_blend, starts_of_transport
from .extraction import extract_surface, own_surface
from .kept_blends import KeptBlends
from .layouts import Blend
from .merging import merged_parts
from .morph_problem import MorphFrame, MorphProblem
from .origins import blend_origins, part_transports
from .part_potentials import PartPotentials
from .spare_threads import at_once
from .thin_shapes import thin_parts, wall_share
from .transport_problem import TransportProblem

HandOver = Callable[[Callable[[], "MorphFrame"]], Callable[[], "MorphFrame"]]
"""Takes what makes a frame, and returns what waits for it."""


@dataclass(frozen=True)
class Sketch:
    """The coarse levels of a blend: a preview, and the start of the final solve.

    Attributes
    ----------
    frame : MorphFrame
        The preview: its surface is extracted on a coarser grid and not repaired. It has no surface if the grid is too
        coarse.
    parts : tuple of PartSketch
        The coarse levels of every part; empty for an unblended input.
    """

    frame: MorphFrame
    parts: tuple[PartSketch, ...] = ()


def sketch_blends(problem: MorphProblem, blends: Sequence[Blend], control: Control = UNINTERRUPTED) -> Iterator[Sketch]:
    """Solve the coarse levels of a run of blends lazily, each started from the previous one.

    Parameters
    ----------
    problem, blends, control
        As for :func:`solve_blends`, which takes the sketches of the same run; the problem must have a `sketch_depth`.
    """
    solver = BlendSolver(problem.transport, control)
    return (_sketch(problem, solver, blend) for blend in blends)


def _sketch(problem: MorphProblem, solver: BlendSolver, blend: Blend) -> Sketch:
    if blend.source is not None:
        return Sketch(_input_itself(problem, blend))
    parts = solver.sketch(blend, problem.transport.blend_volumes(blend))
    return Sketch(_sketched_frame(problem, blend, parts), parts)


def solve_blends(
    problem: MorphProblem,
    blends: Sequence[Blend],
    control: Control = UNINTERRUPTED,
    sketches: Sequence[Sketch] | None = None,
    hand_over: HandOver = at_once,
    kept: KeptBlends | None = None,
) -> list[MorphFrame]:
    """Solve a run of blends, each started from the previous one.

    Parameters
    ----------
    problem : MorphProblem
        The shapes and the settings.
    blends : sequence of Blend
        Neighbors, in order.
    control : Control
        Ends the run when cancelled.
    sketches : sequence of Sketch, optional
        Sketches of these blends, which are continued. The frames are the same without them.
    hand_over : callable, optional
        Extracts a surface, here or in another thread while the next blend is solved, and returns a function that waits
        for the frame; see :class:`.spare_threads.SpareThreads`.
    kept : KeptBlends, optional
        Gets all solved blends.

    Returns
    -------
    list of MorphFrame
        In the order of the blends.
    """
    solver = BlendSolver(problem.transport, control)
    known = [()] * len(blends) if sketches is None else [sketch.parts for sketch in sketches]
    frames = [hand_over(_solved(problem, solver, *own, kept, control)) for own in zip(blends, known, strict=True)]
    return [frame() for frame in frames]


def solve_some_blends(
    transport: TransportProblem,
    blends: Sequence[Blend],
    problems: Sequence[MorphProblem | None],
    control: Control,
    kept: KeptBlends | None,
) -> list[MorphFrame]:
    """Compute the frames of some blends of a run, in which each blend is solved from the previous one.

    Parameters
    ----------
    transport : TransportProblem
        The distributions whose barycenters are solved.
    blends : sequence of Blend
        Neighbors, in order.
    problems : sequence of MorphProblem or None
        For each of the first blends, the problem that gives its frame, or None if the frame is not needed. Blends
        beyond the end of this sequence are not solved.
    control : Control
        Ends the work when cancelled.
    kept : KeptBlends, optional
        Blends that have been solved before; nothing is solved if all needed ones are among them. Gets the others.
    """
    pairs = list(zip(blends, problems, strict=False))
    if kept is not None and all(blend in kept for blend, problem in pairs if problem is not None):
        known = [(problem, kept.solved(blend)) for blend, problem in pairs if problem is not None]
        return [surfaced_frame(problem, solved, control=control) for problem, solved in known]
    solver = BlendSolver(transport, control)
    frames = []
    for blend, problem in pairs:
        if blend.source is None:
            solved = solver.solve(blend, transport.blend_volumes(blend))
            if kept is not None:
                kept.keep(solved)
            frames += [] if problem is None else [surfaced_frame(problem, solved, control=control)]
    return frames


def _solved(
    problem: MorphProblem,
    solver: BlendSolver,
    blend: Blend,
    sketch: Sequence[PartSketch],
    kept: KeptBlends | None,
    control: Control,
) -> Callable[[], MorphFrame]:
    """Solve a blend, and return a function that computes its frame without the solver."""
    if blend.source is not None:
        return partial(_input_measured, problem, blend)
    solved = solver.solve(blend, problem.transport.blend_volumes(blend), sketch)
    if kept is not None:
        kept.keep(solved)
    return partial(surfaced_frame, problem, solved, control=control)


def _input_itself(problem: MorphProblem, blend: Blend) -> MorphFrame:
    volume = problem.transport.input_volume(blend.source)
    return MorphFrame(
        blend,
        None,
        {"weights": blend.weights, "input": blend.source, "volume": volume, **motion_figures(problem.motion)},
    )


def _input_measured(problem: MorphProblem, blend: Blend) -> MorphFrame:
    frame = _input_itself(problem, blend)
    measured = {"thin": thin_parts(problem.transport.occupancy(blend.source))}
    if problem.connectivity:
        measured["found"] = asdict(problem.connectivity[blend.source])
    return replace(frame, record={**frame.record, **measured})


def _sketched_frame(problem: MorphProblem, blend: Blend, parts: Sequence[PartSketch]) -> MorphFrame:
    """Extract the surface of a blend from the coarse levels of its parts, in the same way as the surface of a shape."""
    factor = 2**problem.transport.sketch_depth
    volumes = problem.transport.blend_volumes(blend) / factor**3
    merged = merged_parts([part.solved.density for part in parts], volumes)
    try:
        surface = own_surface(merged.density * (merged.volume / merged.density.sum()), problem.settings)
    except InputError:
        # The coarse grid has too few cells for a surface; the finished blend will have one.
        return MorphFrame(blend, None, {"weights": blend.weights})
    lattice = replace(problem.lattice, shape=merged.density.shape, spacing=problem.lattice.spacing * factor)
    mesh = lattice.to_scene(surface.mesh, np.array(blend.weights))
    return MorphFrame(blend, mesh, {"weights": blend.weights, "volume": mesh.volume})


def surfaced_frame(
    problem: MorphProblem,
    solved: SolvedBlend,
    solids: CoincidingSolids | None = None,
    control: Control = UNINTERRUPTED,
) -> MorphFrame:
    """Extract the surface of a blend from the barycenters of its parts.

    Parameters
    ----------
    problem : MorphProblem
        The shapes and the settings.
    solved : SolvedBlend
        The blend.
    solids : CoincidingSolids, optional
        As for :func:`.extraction.extract_surface`.
    control : Control
        Stops the work when cancelled.
    """
    blend, sigma = solved.blend, max(solved.sigmas)
    merged = solved.merged()
    shapes = [problem.connectivity[i] for i in np.flatnonzero(blend.weights)]
    constraint = problem.constraint(blend.weights)
    extracted = extract_surface(
        merged.density, merged.volume, sigma, shapes, problem.settings, solids, constraint, control
    )
    mesh = problem.lattice.to_scene(extracted.surface.mesh, np.array(blend.weights))
    record = {
        "weights": blend.weights,
        **motion_figures(problem.motion),
        **solved.figures(),
        "sigma": sigma,
        "sigma_wanted": problem.settings.sigma,
        "wall": wall_share(merged.density),
        "cells": problem.lattice.shape,
        "level": extracted.surface.level,
        "volume": mesh.volume,
        "volume_wanted": merged.volume * problem.lattice.spacing**3,
        **extracted.record,
        **solved.part_figures(problem.transport, merged),
    }
    kept = zip(solved.parts, solved.sigmas, strict=True) if problem.keeps_potentials else ()
    potentials = tuple(PartPotentials.of(part, sigma) for part, sigma in kept)
    origins = None
    if problem.settings.carry or problem.settings.carried_detail > 0:
        origins = _origins(problem, solved, extracted.surface.mesh.vertices)
    frame = MorphFrame(blend, mesh, record, potentials, origins)
    return _with_detail_of_inputs(problem, frame, control) if problem.shapes else frame


def _with_detail_of_inputs(problem: MorphProblem, frame: MorphFrame, control: Control) -> MorphFrame:
    """Add the detail of the inputs to a blend of inputs that do not move."""
    occupancies = [problem.transport.occupancy(i) for i in range(len(problem.shapes))]
    surface = detailed_blend(problem, frame, problem.shapes, occupancies, starts_of_transport(frame), control)
    detailed = replace(frame, mesh=surface.mesh, record={**frame.record, "volume": surface.mesh.volume})
    if not problem.settings.carry:
        return replace(detailed, origins=None)
    weights, centers = np.array(frame.blend.weights), problem.lattice.centers
    active = np.flatnonzero(weights)
    origins = surface.mesh.vertices + (centers - weights @ centers)[:, None]
    origins[active] = surface.origins
    triangles = np.full((len(weights), len(surface.mesh.faces)), -1, np.int32)
    triangles[active] = surface.triangles
    return replace(detailed, origins=origins.astype(np.float32), triangles=triangles)


def _origins(problem: MorphProblem, solved: SolvedBlend, surface: NDArray[np.float64]) -> NDArray[np.float32]:
    """Map the vertices of a surface, (n, 3) in cells, back to the inputs."""
    transports = part_transports(solved, problem.transport)
    return blend_origins(surface, transports, problem.lattice, solved.blend.weights)
