# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Blends of voxelized shapes: barycenters and their surfaces, a run of neighbors at a time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ..geometry.isosurface import LevelSurface, surface_at_level, surface_enclosing
from ..geometry.mesh import TriangleMesh
from ..transport import Barycenter, Grid, KernelTooNarrowError, barycenter
from .layouts import Blend
from .morph_settings import MorphSettings
from .volumes import Lattice

# By how much the automatic blur grows where it does not reach.
_WIDEN = 1.25


@dataclass(frozen=True)
class MorphFrame:
    """A finished blend.

    Attributes
    ----------
    blend : Blend
        Which one.
    mesh : TriangleMesh or None
        Its surface in the scene, closed and outward; None where an input is shown as it is.
    record : dict
        The solver's figures, the level, volume wanted and reached; ready for JSON.
    """

    blend: Blend
    mesh: TriangleMesh | None
    record: dict[str, object]


@dataclass(frozen=True)
class MorphProblem:
    """What all blends of a morph have in common; can be sent to another process.

    Attributes
    ----------
    densities : tuple of (nx, ny, nz) float32
        Occupancies of the shapes.
    lattice : Lattice
        Where their cells are.
    settings : MorphSettings
        How to blend them.
    """

    densities: tuple[NDArray[np.float32], ...]
    lattice: Lattice
    settings: MorphSettings


def solve_blends(
    problem: MorphProblem, blends: Sequence[Blend], check: Callable[[], None] | None = None
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

    Returns
    -------
    list of MorphFrame
        In the order of the blends.
    """
    solver = _Solver(problem, check)
    return [solver.frame(blend) for blend in blends]


class _Solver:
    """Solves blend after blend on one grid, each started from what the ones before teach."""

    def __init__(
        self,
        problem: MorphProblem,
        check: Callable[[], None] | None,
    ) -> None:
        self._densities = problem.densities
        self._volumes = np.array([float(d.sum(dtype=np.float64)) for d in problem.densities])
        self._lattice = problem.lattice
        self._settings = problem.settings
        self._grid: Grid = problem.lattice.grid(problem.settings.sigma)
        self._check = check
        self._last: Barycenter | None = None
        self._last_sigma = self._grid.sigma

    def frame(self, blend: Blend) -> MorphFrame:
        if blend.source is not None:
            volume = self._volumes[blend.source] * self._lattice.spacing**3
            return MorphFrame(blend, None, {"weights": blend.weights, "input": blend.source, "volume": volume})
        solved = self._solve(blend)
        surface = self._surface(solved, float(np.dot(blend.weights, self._volumes)))
        mesh = self._lattice.to_scene(surface.mesh, np.array(blend.weights))
        wanted = float(np.dot(blend.weights, self._volumes)) * self._lattice.spacing**3
        record = {
            "weights": blend.weights,
            **solved.record(),
            "sigma": self._last_sigma,
            "cells": self._lattice.shape,
            "level": surface.level,
            "volume": mesh.volume,
            "volume_wanted": wanted,
        }
        return MorphFrame(blend, mesh, record)

    def _solve(self, blend: Blend) -> Barycenter:
        """Solve with the blur of the settings; where that was left open, with the least that is needed above it."""
        if self._settings.blur is not None:
            return self._solve_on(self._grid, blend, "automatic")
        sigma = self._grid.sigma
        while True:
            # A frame close to one shape reaches farther to the other, and may need a wider kernel than the rest.
            grid = self._grid if sigma == self._grid.sigma else self._lattice.grid(sigma)
            try:
                return self._solve_on(grid, blend, "scaling")
            except KernelTooNarrowError:
                self._last = None
                sigma *= _WIDEN

    def _solve_on(self, grid: Grid, blend: Blend, numerics: Literal["automatic", "scaling"]) -> Barycenter:
        solved = barycenter(
            self._densities,
            blend.weights,
            grid,
            sharpness=self._settings.sharpness_at(blend.weights),
            entropy_limit=self._settings.entropy_limit,
            initial=self._last if grid.sigma == self._last_sigma else None,
            tolerance=self._settings.tolerance,
            max_iterations=self._settings.max_iterations,
            numerics=numerics,
            monitor=None if self._check is None else lambda *_: self._check(),
        )
        self._last, self._last_sigma = solved, grid.sigma
        return solved

    def _surface(self, solved: Barycenter, cells: float) -> LevelSurface:
        if self._settings.level == "half-max":
            return surface_at_level(solved.density, float(solved.density.max()) / 2)
        return surface_enclosing(solved.density, cells)
