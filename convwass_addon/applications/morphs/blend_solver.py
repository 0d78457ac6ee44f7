# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Barycenters of the parts of blends, for runs of neighboring blends."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ...progress import UNINTERRUPTED, Control
from ...transport import Barycenter, Inputs, KernelTooNarrowError, barycenter
from .layouts import Blend
from .merging import MergedParts, merged_parts
from .transport_problem import MorphPart, TransportProblem

# Factor by which the automatic blur grows if it is too narrow for float64.
_WIDEN = 1.25
# The errors of a distant start decay slowly, and have the opposite sign of those without a start. A blend further than
# this from the one it starts from, and one without a start, are solved to this fraction of the automatic tolerance
# (docs/performance, "Few frames").
_FAR, _FROM_AFAR, _FROM_NEAR, _FROM_NOTHING = 1.0 / 12.0, 0.35, 0.4, 0.3

ALONE = 0.7
"""Fraction of the automatic tolerance for blends that are all solved without a start, so that they do not differ."""


@dataclass(frozen=True)
class PartSketch:
    """The coarse levels of one part of a blend.

    Attributes
    ----------
    solved : Barycenter
        The barycenter on a coarser grid.
    sigma : float
        Its blur in cells, on every level.
    initial : Barycenter or None
        The sketch that it was started from, if any.
    """

    solved: Barycenter
    sigma: float
    initial: Barycenter | None


@dataclass(frozen=True)
class SolvedBlend:
    """A blend as the barycenters of its parts.

    A transport that maps every part to itself is block-diagonal, so the barycenter is the sum of the barycenters of the
    parts.

    Attributes
    ----------
    blend : Blend
        Its weights; not an unblended input.
    parts : tuple of Barycenter
        The barycenter of every part.
    sigmas : tuple of float
        The blur of every part in cells.
    volumes : (p,) float64
        The volume that every part should have, in cells.
    """

    blend: Blend
    parts: tuple[Barycenter, ...]
    sigmas: tuple[float, ...]
    volumes: NDArray[np.float64]

    def merged(self) -> MergedParts:
        """Return the sum of the parts."""
        return merged_parts([part.density for part in self.parts], self.volumes)

    def figures(self) -> dict[str, object]:
        """Return convergence figures for a record: those of the worst part, and the total of iterations."""
        records = [part.record() for part in self.parts]
        if len(records) == 1:
            return records[0]
        worst = max(records, key=lambda record: (not record["converged"], record["marginal_error"] or 0.0))
        return {**worst, "iterations": tuple(map(sum, zip(*(part.iterations for part in self.parts), strict=True)))}

    def part_figures(self, problem: TransportProblem, merged: MergedParts) -> dict[str, object]:
        """Return figures of every part for a record; empty if there is only one."""
        if len(self.parts) == 1 and not problem.notices:
            return {}
        names = (part.name for part in problem.parts)
        return {
            "parts": dict(zip(names, (self.volumes / self.volumes.sum()).tolist(), strict=True)),
            "overlap": merged.overlap,
            "notices": tuple((notice.kind, notice.name) for notice in problem.notices),
        }


class BlendSolver:
    """Solves blends one after the other; each starts from the previous one.

    Parameters
    ----------
    problem : TransportProblem
        The shapes and the settings.
    control : Control
        Ends the solve when cancelled.
    from_nothing : float
        Fraction of the automatic tolerance for a blend without a start.
    """

    def __init__(
        self, problem: TransportProblem, control: Control = UNINTERRUPTED, from_nothing: float = _FROM_NOTHING
    ) -> None:
        self._problem = problem
        self._parts = [_PartSolver(part, problem, control, from_nothing) for part in problem.parts]

    def start_from(self, solved: SolvedBlend) -> None:
        """Start the next blend from one of other poses of the same shapes, on a grid of the same size."""
        for part, own, sigma in zip(self._parts, solved.parts, solved.sigmas, strict=True):
            part.start_from(own, sigma)

    def branched(self) -> BlendSolver:
        """Return another solver whose next blend starts from the same blend."""
        other = copy(self)
        other._parts = [copy(part) for part in self._parts]
        return other

    def solve(self, blend: Blend, volumes: NDArray[np.float64], sketch: Sequence[PartSketch] = ()) -> SolvedBlend:
        """Solve a blend whose parts have `volumes`, (p,) cells, continuing from its sketch if there is one."""
        limits = self._problem.entropy_limits(volumes)
        known = sketch or [None] * len(self._parts)
        solved = tuple(part.solve(blend, *own) for part, *own in zip(self._parts, limits, known, strict=True))
        self._problem.require_met_limits(solved, limits, volumes)
        return SolvedBlend(blend, solved, tuple(part.sigma for part in self._parts), volumes)

    def sketch(self, blend: Blend, volumes: NDArray[np.float64]) -> tuple[PartSketch, ...]:
        """Solve the coarse levels of a blend; the problem must have a `sketch_depth`."""
        limits = self._problem.entropy_limits(volumes)
        return tuple(part.sketch(blend, limit) for part, limit in zip(self._parts, limits, strict=True))


class _PartSolver:
    """Solves one part of successive blends, starting from previous solutions."""

    def __init__(self, part: MorphPart, problem: TransportProblem, control: Control, from_nothing: float) -> None:
        self._inputs = part.inputs
        self._from_nothing = from_nothing
        self._lattice = problem.lattice
        self._settings = problem.settings
        self._control = control
        self._depth = problem.sketch_depth
        self._last: Barycenter | None = None
        # The sketch that the last solve continued from.
        self._begun: Barycenter | None = None
        self.sigma = problem.settings.sigma

    def start_from(self, solved: Barycenter, sigma: float) -> None:
        """Start the next solve from a barycenter with a blur of `sigma` cells."""
        self._last, self._begun, self.sigma = solved, None, sigma

    def solve(self, blend: Blend, limit: Literal["max"] | float | None, sketch: PartSketch | None = None) -> Barycenter:
        """Solve with the blur of the settings; an automatic blur is widened as far as needed."""

        def finished(inputs: Inputs, options: dict[str, object]) -> Barycenter:
            begun = self._usable(sketch, inputs.domain.sigma, options["initial"])
            solved = barycenter(inputs, blend.weights, inputs.domain, begun=begun, **options)
            self._begun = begun
            return solved

        return self._widening(blend, limit, finished)

    def sketch(self, blend: Blend, limit: Literal["max"] | float | None) -> PartSketch:
        """Solve the coarse levels with the same blur."""
        started_from: list[Barycenter | None] = []

        def sketched(inputs: Inputs, options: dict[str, object]) -> Barycenter:
            for _ in range(self._depth):
                inputs = inputs.coarser
            started_from[:] = [options["initial"]]
            return barycenter(inputs, blend.weights, inputs.domain, **options)

        solved = self._widening(blend, limit, sketched)
        return PartSketch(solved, self.sigma, *started_from)

    def _usable(self, sketch: PartSketch | None, sigma: float, initial: Barycenter | None) -> Barycenter | None:
        """Return the sketch if a solve would give the same coarse levels: same blur, and same start."""
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
        initial = self._last if sigma == self.sigma else None
        share = self._share(blend, initial)
        options = {
            "sharpness": self._settings.sharpness_at(blend.weights),
            "entropy_limit": limit,
            "reach": self._settings.reach,
            "initial": initial,
            "tolerance": share * self._settings.stopping_error,
            "debias_tolerance": share * self._settings.debias_stopping_error_at(blend.weights),
            "max_iterations": self._settings.max_iterations,
            "numerics": numerics,
            "control": self._control,
        }
        solved = solve(inputs, options)
        self._last, self.sigma = solved, sigma
        return solved

    def _share(self, blend: Blend, initial: Barycenter | None) -> float:
        """Return the fraction of the tolerances to solve to: less than 1 for automatic ones and a distant start."""
        if self._settings.tolerance is not None:
            return 1.0
        if initial is None:
            return self._from_nothing
        moved = float(np.abs(initial.weights - np.asarray(blend.weights)).sum()) / 2.0
        return _FROM_AFAR if moved > _FAR else _FROM_NEAR
