# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Morph meshes of any topology: solids as distributions, Wasserstein barycenters, surfaces.

Section 7 of Solomon et al. 2015, "Shape interpolation": every shape is the normalized indicator of its interior, blends
are barycenters, and a level set of each barycenter is the blended shape.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..geometry.isosurface import LevelSurface, surface_at_level, surface_enclosing
from ..geometry.mesh import TriangleMesh
from ..transport import Barycenter, Grid, KernelTooNarrowError, barycenter
from .layouts import Blend
from .volumes import Lattice, voxelize

# Automatic sharpness: whole in the middle, exact towards the ends (where the weight of one shape exceeds the second).
_SHARPNESS = 0.75
_CRISP_FROM = 0.85
# Automatic blur: one cell, and no narrower than float64 carries across a grid.
_CELLS_PER_BLUR = 80.0
# By how much the automatic blur grows where it does not reach.
_WIDEN = 1.25
# Share of the progress that voxelizing takes.
_VOXEL_SHARE = 0.08


@dataclass(frozen=True)
class MorphSettings:
    """How a morph is made.

    Attributes
    ----------
    resolution : int
        Cells along the longest side of the grid.
    blur : float or None
        Standard deviation of the kernel in cells; None is one cell, or an eightieth of the resolution if that is more.
    sharpness : float or None
        0 is the paper's barycenter, 1 the debiased one; None is 0.75, rising to 1 towards the ends.
    entropy_limit : None, "max" or float
        Bound for the entropy of every blend in nats; "max" is the largest entropy of the inputs.
    level : "volume" or "half-max"
        Surface at the level that encloses the interpolated volume, or at half of the largest density.
    thickness : float
        Thickness in scene units given to shapes that enclose no volume; 0 refuses them.
    tolerance : float
        Marginal error at which a blend is done.
    max_iterations : int
        Most iterations per level of the solver.
    """

    resolution: int = 100
    blur: float | None = None
    sharpness: float | None = None
    entropy_limit: Literal["max"] | float | None = None
    level: Literal["volume", "half-max"] = "volume"
    thickness: float = 0.0
    tolerance: float = 1e-2
    max_iterations: int = 200

    def __post_init__(self) -> None:
        """Refuse settings that make no sense.

        Raises
        ------
        InputError
            With the name of the setting and what it must be.
        """
        _require(8 <= self.resolution <= 1024, "Resolution must lie between 8 and 1024 cells")
        _require(self.blur is None or 0.5 <= self.blur <= 20, "Blur must lie between 0.5 and 20 cells")
        _require(self.sharpness is None or 0 <= self.sharpness <= 1, "Sharpness must lie between 0 and 1")
        limit = self.entropy_limit
        is_number = isinstance(limit, (int, float)) and bool(np.isfinite(limit))
        _require(limit is None or limit == "max" or is_number, "The entropy limit must be 'max', a number, or off")
        _require(self.level in ("volume", "half-max"), "The level must be 'volume' or 'half-max'")
        _require(0 <= self.thickness < np.inf, "Thickness must be zero or positive")
        _require(0 < self.tolerance < 1, "The tolerance must lie between 0 and 1")
        _require(self.max_iterations >= 1, "There must be at least one iteration")

    @property
    def sigma(self) -> float:
        """Blur in cells, with the automatic choice made."""
        return max(1.0, self.resolution / _CELLS_PER_BLUR) if self.blur is None else self.blur

    def sharpness_at(self, weights: Sequence[float]) -> float:
        """Sharpness of the blend with these weights, with the automatic choice made."""
        if self.sharpness is not None:
            return self.sharpness
        near = np.clip((max(weights) - _CRISP_FROM) / (1.0 - _CRISP_FROM), 0.0, 1.0)
        return float(_SHARPNESS + (1.0 - _SHARPNESS) * near**2 * (3.0 - 2.0 * near))

    def as_dict(self) -> dict[str, object]:
        """Return the settings ready for JSON."""
        return asdict(self)


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
class MorphStep:
    """One step of the job.

    Attributes
    ----------
    fraction : float
        Done share of the whole job.
    message : str
        What is being done.
    frame : MorphFrame or None
        A frame that has just been finished.
    """

    fraction: float
    message: str
    frame: MorphFrame | None = None


def morph(
    shapes: Sequence[TriangleMesh],
    names: Sequence[str],
    blends: Sequence[Blend],
    settings: MorphSettings,
    check: Callable[[], None] | None = None,
) -> Iterator[MorphStep]:
    """Make the blends of the shapes, one after the other.

    Parameters
    ----------
    shapes : sequence of TriangleMesh
        The inputs in one space; open, self-intersecting, disconnected and inside-out ones are welcome.
    names : sequence of str
        What messages call them.
    blends : sequence of Blend
        In an order in which neighbors are similar: each solve starts from the one before.
    settings : MorphSettings
        How.
    check : callable, optional
        Called between iterations; what it raises (:class:`.errors.Cancelled`) ends the job at once.

    Yields
    ------
    MorphStep
        Progress, and every finished frame once.

    Raises
    ------
    InputError, ResourceError
        Before the first frame, where the inputs or the settings cannot work.
    """
    yield MorphStep(0.0, "Laying out the grid")
    lattice = Lattice.around(shapes, settings.resolution, settings.sigma)
    densities = []
    for index, filled in enumerate(voxelize(shapes, names, lattice, settings.thickness)):
        densities.append(filled)
        yield MorphStep(_VOXEL_SHARE * (index + 1) / len(shapes), f"Voxelized {names[index]}")
    solver = _Solver(densities, lattice, settings, check)
    for done, blend in enumerate(blends, start=1):
        fraction = _VOXEL_SHARE + (1.0 - _VOXEL_SHARE) * done / len(blends)
        yield MorphStep(fraction, f"Blend {done} of {len(blends)}", solver.frame(blend))


class _Solver:
    """Solves blend after blend on one grid, each started from what the ones before teach."""

    def __init__(
        self,
        densities: Sequence[NDArray[np.float32]],
        lattice: Lattice,
        settings: MorphSettings,
        check: Callable[[], None] | None,
    ) -> None:
        self._densities = densities
        self._volumes = np.array([float(d.sum(dtype=np.float64)) for d in densities])
        self._lattice = lattice
        self._settings = settings
        self._grid: Grid = lattice.grid(settings.sigma)
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


def _require(holds: bool, message: str) -> None:
    if not holds:
        raise InputError(f"{message}.")
