# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Blends of voxelized shapes: barycenters and their surfaces, a run of neighbors at a time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from ..geometry.isosurface import LevelSurface, surface_at_level, surface_enclosing
from ..geometry.mesh import TriangleMesh
from ..transport import Barycenter, Inputs, KernelTooNarrowError, barycenter
from .layouts import Blend
from .morph_settings import MorphSettings
from .volumes import Lattice

# By how much the automatic blur grows where it does not reach.
_WIDEN = 1.25
# Cells over which a density is averaged before its surface is read: less than the grid can show of a shape, and enough
# for crumbs and false handles of a cell's size to vanish. The enclosed volume is chosen afterwards.
_READING_BLUR = 0.7


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
    inputs : Inputs
        The shapes as distributions.
    volumes : (k,) float64
        Volumes of the shapes in cells.
    lattice : Lattice
        Where their cells are.
    settings : MorphSettings
        How to blend them.
    """

    inputs: Inputs
    volumes: NDArray[np.float64]
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
        self._inputs = problem.inputs
        self._volumes = problem.volumes
        self._lattice = problem.lattice
        self._settings = problem.settings
        self._check = check
        self._last: Barycenter | None = None
        self._last_sigma = problem.settings.sigma

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
            return self._solve_on(self._inputs, blend, "automatic")
        inputs, sigma = self._inputs, self._settings.sigma
        while True:
            try:
                return self._solve_on(inputs, blend, "scaling")
            except KernelTooNarrowError:
                # A frame close to one shape reaches farther to the other, and may need a wider kernel than the rest.
                self._last = None
                sigma *= _WIDEN
                inputs = self._inputs.on(self._lattice.grid(sigma))

    def _solve_on(self, inputs: Inputs, blend: Blend, numerics: Literal["automatic", "scaling"]) -> Barycenter:
        sigma = inputs.domain.sigma
        solved = barycenter(
            inputs,
            blend.weights,
            inputs.domain,
            sharpness=self._settings.sharpness_at(blend.weights),
            entropy_limit=self._settings.entropy_limit,
            initial=self._last if sigma == self._last_sigma else None,
            tolerance=self._settings.tolerance,
            max_iterations=self._settings.max_iterations,
            numerics=numerics,
            monitor=None if self._check is None else lambda *_: self._check(),
        )
        self._last, self._last_sigma = solved, sigma
        return solved

    def _surface(self, solved: Barycenter, cells: float) -> LevelSurface:
        if self._settings.level == "half-max":
            return surface_at_level(solved.density, float(solved.density.max()) / 2)
        return surface_enclosing(gaussian_filter(solved.density, _READING_BLUR), cells)
