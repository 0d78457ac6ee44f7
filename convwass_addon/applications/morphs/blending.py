# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Blends of voxelized shapes: barycenters and their surfaces, a run of neighbors at a time."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...transport import Barycenter, Inputs, KernelTooNarrowError, barycenter
from .health import thin_parts, wall_share
from .layouts import Blend
from .merging import MergedParts, merged_parts
from .morph_problem import MorphFrame, MorphPart, MorphProblem
from .origins import PartTransport, blend_origins
from .potentials import PartPotentials
from .reading import own_surface, read_surface
from .spare_threads import at_once

HandOver = Callable[[Callable[[], "MorphFrame"]], Callable[[], "MorphFrame"]]
"""Takes what makes a frame, and returns what waits for it."""

# By how much the automatic blur grows where it does not reach.
_WIDEN = 1.25


@dataclass(frozen=True)
class PartSketch:
    """The coarse levels of one part of a blend.

    Attributes
    ----------
    solved : Barycenter
        On a coarser grid.
    sigma : float
        Its blur in cells of any level.
    initial : Barycenter or None
        The sketch that it was started from.
    """

    solved: Barycenter
    sigma: float
    initial: Barycenter | None


@dataclass(frozen=True)
class Sketch:
    """What comes before a finished blend, and what that goes on from.

    Attributes
    ----------
    frame : MorphFrame
        To look at: the surface at a coarser resolution, not mended; without a surface where it is too coarse for one.
    parts : tuple of PartSketch
        None for an input as it is.
    """

    frame: MorphFrame
    parts: tuple[PartSketch, ...] = ()


def sketch_blends(
    problem: MorphProblem, blends: Sequence[Blend], check: Callable[[], None] | None = None
) -> Iterator[Sketch]:
    """Solve the coarse levels of a run of blends, each when it is asked for and started from the one before.

    Parameters
    ----------
    problem, blends, check
        As for :func:`solve_blends`, which takes the sketches of the same run; a problem with a `sketch_depth`.
    """
    solver = _Solver(problem, check)
    return (solver.sketch(blend) for blend in blends)


def solve_blends(
    problem: MorphProblem,
    blends: Sequence[Blend],
    check: Callable[[], None] | None = None,
    sketches: Sequence[Sketch] | None = None,
    hand_over: HandOver = at_once,
) -> list[MorphFrame]:
    """Solve a run of blends, each started from the one before.

    Parameters
    ----------
    problem : MorphProblem
        The shapes and the settings.
    blends : sequence of Blend
        Neighbors, in order.
    check : callable, optional
        Called between iterations; what it raises ends the run.
    sketches : sequence of Sketch, optional
        Of these blends: what was solved for them is not solved again. The frames are the same without.
    hand_over : callable, optional
        Sees to it that a surface is read, here or by another thread while the next blend is solved, and returns what
        gives the frame; see :class:`.spare_threads.SpareThreads`.

    Returns
    -------
    list of MorphFrame
        In the order of the blends.
    """
    solver = _Solver(problem, check)
    known = [()] * len(blends) if sketches is None else [sketch.parts for sketch in sketches]
    frames = [hand_over(solver.solved(blend, parts)) for blend, parts in zip(blends, known, strict=True)]
    return [frame() for frame in frames]


class _Solver:
    """Solves blend after blend: the barycenters of all parts, and the surface of their sum.

    A transport that sends every part to itself is block-diagonal, so the barycenter under it is the sum of the
    barycenters of the parts.
    """

    def __init__(
        self,
        problem: MorphProblem,
        check: Callable[[], None] | None,
    ) -> None:
        self._problem = problem
        self._parts = [_PartSolver(part, problem, check) for part in problem.parts]

    def solved(self, blend: Blend, sketches: Sequence[PartSketch] = ()) -> Callable[[], MorphFrame]:
        """Solve a blend, and return what makes its frame: that no longer needs the solver."""
        problem = self._problem
        if blend.source is not None:
            return partial(problem.input_reader or _input_measured, problem, self._input_itself(blend))
        limits = problem.entropy_limits(blend)
        known = sketches or [None] * len(self._parts)
        solved = [part.solve(blend, *own) for part, *own in zip(self._parts, limits, known, strict=True)]
        read = problem.reader or surfaced_frame
        return partial(read, problem, blend, solved, [part.sigma for part in self._parts])

    def sketch(self, blend: Blend) -> Sketch:
        if blend.source is not None:
            return Sketch(self._input_itself(blend))
        limits = self._problem.entropy_limits(blend)
        parts = tuple(part.sketch(blend, limit) for part, limit in zip(self._parts, limits, strict=True))
        return Sketch(_sketched_frame(self._problem, blend, [part.solved for part in parts]), parts)

    def _input_itself(self, blend: Blend) -> MorphFrame:
        lattice = self._problem.lattice
        volume = self._problem.volumes[blend.source] * lattice.spacing ** len(lattice.shape)
        return MorphFrame(blend, None, {"weights": blend.weights, "input": blend.source, "volume": volume})


def _input_measured(problem: MorphProblem, frame: MorphFrame) -> MorphFrame:
    return replace(frame, record={**frame.record, "thin": thin_parts(problem.occupancy(frame.blend.source))})


def _sketched_frame(problem: MorphProblem, blend: Blend, solved: Sequence[Barycenter]) -> MorphFrame:
    """Read the surface of a blend from the coarse levels of its parts, as the surface of a shape itself is read."""
    factor = 2**problem.sketch_depth
    merged = merged_parts([part.density for part in solved], problem.blend_volumes(blend) / factor**3)
    try:
        surface = own_surface(merged.density * (merged.volume / merged.density.sum()), problem.settings)
    except InputError:
        # Too few of the coarse cells for a surface: the finished blend will have one.
        return MorphFrame(blend, None, {"weights": blend.weights})
    lattice = replace(problem.lattice, shape=merged.density.shape, spacing=problem.lattice.spacing * factor)
    mesh = lattice.to_scene(surface.mesh, np.array(blend.weights))
    return MorphFrame(blend, mesh, {"weights": blend.weights, "volume": mesh.volume})


def surfaced_frame(
    problem: MorphProblem, blend: Blend, solved: Sequence[Barycenter], sigmas: Sequence[float]
) -> MorphFrame:
    """Read the surface of a blend from the barycenters of its parts.

    Parameters
    ----------
    problem : MorphProblem
        The shapes and the settings.
    blend : Blend
        Which one; no input as it is.
    solved : sequence of Barycenter
        One per part.
    sigmas : sequence of float
        The blur of each in cells.
    """
    cell = problem.lattice.spacing**3
    shares = problem.blend_volumes(blend)
    merged = merged_parts([part.density for part in solved], shares)
    shapes = [problem.connectivity[i] for i in np.flatnonzero(blend.weights)]
    reading = read_surface(merged.density, merged.volume, max(sigmas), shapes, problem.settings)
    mesh = problem.lattice.to_scene(reading.surface.mesh, np.array(blend.weights))
    record = {
        "weights": blend.weights,
        **solved_figures(solved),
        "sigma": max(sigmas),
        "wall": wall_share(merged.density),
        "cells": problem.lattice.shape,
        "level": reading.surface.level,
        "volume": mesh.volume,
        "volume_wanted": merged.volume * cell,
        **reading.record,
        **part_figures(problem, shares, merged),
    }
    kept = zip(solved, sigmas, strict=True) if problem.keeps_potentials else ()
    potentials = tuple(PartPotentials.of(part, sigma) for part, sigma in kept)
    origins = None
    if problem.settings.carry:
        origins = _origins(problem, blend, reading.surface.mesh.vertices, solved, sigmas, shares)
    return MorphFrame(blend, mesh, record, potentials, origins)


def _origins(
    problem: MorphProblem,
    blend: Blend,
    surface: NDArray[np.float64],
    solved: Sequence[Barycenter],
    sigmas: Sequence[float],
    volumes: NDArray[np.float64],
) -> NDArray[np.float32]:
    """Follow the vertices of a surface, (n, 3) in cells, back to the inputs."""
    transports = [
        PartTransport(part, problem.lattice.grid(sigma), float(volume), problem.settings.reach)
        for part, sigma, volume in zip(solved, sigmas, volumes, strict=True)
    ]
    return blend_origins(surface, transports, problem.lattice, blend.weights)


def part_figures(problem: MorphProblem, shares: NDArray[np.float64], merged: MergedParts) -> dict[str, object]:
    """Say for a record what there is of the parts of a blend, whose volumes are (p,) cells; nothing of one alone."""
    if len(shares) == 1 and not problem.notices:
        return {}
    names = (part.name for part in problem.parts)
    return {
        "parts": dict(zip(names, (shares / shares.sum()).tolist(), strict=True)),
        "overlap": merged.overlap,
        "notices": tuple((notice.kind, notice.name) for notice in problem.notices),
    }


class _PartSolver:
    """Solves one part of blend after blend, each started from what the ones before teach."""

    def __init__(self, part: MorphPart, problem: MorphProblem, check: Callable[[], None] | None) -> None:
        self._inputs = part.inputs
        self._lattice = problem.lattice
        self._settings = problem.settings
        self._check = check
        self._depth = problem.sketch_depth
        self._last: Barycenter | None = None
        # The sketch that the last one went on from.
        self._begun: Barycenter | None = None
        self.sigma = problem.settings.sigma

    def solve(self, blend: Blend, limit: Literal["max"] | float | None, sketch: PartSketch | None = None) -> Barycenter:
        """Solve with the blur of the settings; where that was left open, with the least that is needed above it."""

        def finished(inputs: Inputs, options: dict[str, object]) -> Barycenter:
            begun = self._usable(sketch, inputs.domain.sigma, options["initial"])
            solved = barycenter(inputs, blend.weights, inputs.domain, begun=begun, **options)
            self._begun = begun
            return solved

        return self._widening(blend, limit, finished)

    def sketch(self, blend: Blend, limit: Literal["max"] | float | None) -> PartSketch:
        """Solve the coarse levels in the same way."""
        started_from: list[Barycenter | None] = []

        def sketched(inputs: Inputs, options: dict[str, object]) -> Barycenter:
            for _ in range(self._depth):
                inputs = inputs.coarser
            started_from[:] = [options["initial"]]
            return barycenter(inputs, blend.weights, inputs.domain, **options)

        solved = self._widening(blend, limit, sketched)
        return PartSketch(solved, self.sigma, *started_from)

    def _usable(self, sketch: PartSketch | None, sigma: float, initial: Barycenter | None) -> Barycenter | None:
        """Return the sketch if it is what would be solved here: of the same blur, and started in the same way."""
        if sketch is None or sketch.sigma != sigma:
            return None
        if initial is None:
            return sketch.solved if sketch.initial is None else None
        return sketch.solved if sketch.initial is not None and sketch.initial is self._begun else None

    def _widening(
        self,
        blend: Blend,
        limit: Literal["max"] | float | None,
        solve: Callable[[Inputs, dict[str, object]], Barycenter],
    ) -> Barycenter:
        if self._settings.blur is not None:
            return self._solve_on(self._inputs, blend, limit, "automatic", solve)
        inputs, sigma = self._inputs, self._settings.sigma
        while True:
            try:
                return self._solve_on(inputs, blend, limit, "scaling", solve)
            except KernelTooNarrowError:
                # A frame close to one shape reaches farther to the other, and may need a wider kernel than the rest.
                self._last = None
                sigma *= _WIDEN
                inputs = self._inputs.on(self._lattice.grid(sigma))

    def _solve_on(
        self,
        inputs: Inputs,
        blend: Blend,
        limit: Literal["max"] | float | None,
        numerics: Literal["automatic", "scaling"],
        solve: Callable[[Inputs, dict[str, object]], Barycenter],
    ) -> Barycenter:
        sigma = inputs.domain.sigma
        options = {
            "sharpness": self._settings.sharpness_at(blend.weights),
            "entropy_limit": limit,
            "reach": self._settings.reach,
            "initial": self._last if sigma == self.sigma else None,
            "tolerance": self._settings.stopping_error,
            "max_iterations": self._settings.max_iterations,
            "numerics": numerics,
            "monitor": None if self._check is None else lambda *_: self._check(),
        }
        solved = solve(inputs, options)
        self._last, self.sigma = solved, sigma
        return solved


def solved_figures(parts: Sequence[Barycenter]) -> dict[str, object]:
    """Say for a record how the parts were solved: figures of the worst of them, iterations of all."""
    records = [part.record() for part in parts]
    if len(records) == 1:
        return records[0]
    worst = max(records, key=lambda record: (not record["converged"], record["marginal_error"] or 0.0))
    return {**worst, "iterations": tuple(map(sum, zip(*(part.iterations for part in parts), strict=True)))}
