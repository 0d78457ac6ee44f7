# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What all blends of a morph have in common, and what a finished one is."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ...geometry.connectivity import Connectivity
from ...geometry.mesh import TriangleMesh
from ...transport import Inputs
from .layouts import Blend
from .morph_settings import MorphSettings
from .parts import PartNotice, SplitShapes
from .potentials import PartPotentials
from .reading import connectivity_of
from .volumes import Lattice

# Sketches are solved on the finest of the coarser levels that has so few cells.
_SKETCH_CELLS = 300_000
# Most bytes per cell of the level it is solved on, measured, that a sketch keeps until its blend is finished: for all
# cells, for those that the largest shape fills, and for every further part.
_SKETCH_BYTES, _SKETCH_BYTES_FILLED, _SKETCH_BYTES_PART = 52, 85, 45


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
    potentials : tuple of PartPotentials
        One per part, where they are kept: what blends next to it can be had from.
    origins : (k, n, 3) float32 or None
        Where in the scene the matter at every vertex of `mesh` comes from, on every input; None where that was not
        asked for. See :func:`.origins.blend_origins`.
    tangents : (k, n, 3) float32 or None
        What velocities are read from in place of the origins, where the inputs move; see
        :func:`.moved_origins.moved_tangents`.
    """

    blend: Blend
    mesh: TriangleMesh | None
    record: dict[str, object]
    potentials: tuple[PartPotentials, ...] = ()
    origins: NDArray[np.float32] | None = None
    tangents: NDArray[np.float32] | None = None


@dataclass(frozen=True)
class MorphPart:
    """What is transported by itself: a part of all shapes, or the whole shapes.

    Attributes
    ----------
    name : str
        What the record calls it.
    inputs : Inputs
        The part of every shape as a distribution.
    volumes : (k,) float64
        Its volume in every shape, in cells.
    """

    name: str
    inputs: Inputs
    volumes: NDArray[np.float64]


@dataclass(frozen=True)
class MorphProblem:
    """What all blends of a morph have in common; can be sent to another process.

    Attributes
    ----------
    parts : tuple of MorphPart
        One, unless parts travel together.
    lattice : Lattice
        Where the cells of the shapes are.
    settings : MorphSettings
        How to blend them.
    connectivity : tuple of Connectivity
        How every shape hangs together at this resolution; empty where there are to be sketches only.
    notices : tuple of PartNotice
        What the user should know about the parts.
    keeps_potentials : bool
        Whether frames bring what blends next to them can be had from.
    reader, input_reader : callable or None
        What makes a frame of solved parts, and of an input as it is, in the place of :mod:`.blending`; functions of a
        module, so that they can be sent along.
    """

    parts: tuple[MorphPart, ...]
    lattice: Lattice
    settings: MorphSettings
    connectivity: tuple[Connectivity, ...]
    notices: tuple[PartNotice, ...] = ()
    keeps_potentials: bool = False
    reader: Callable[..., object] | None = None
    input_reader: Callable[..., object] | None = None

    @classmethod
    def of(cls, shapes: SplitShapes, lattice: Lattice, settings: MorphSettings) -> MorphProblem:
        """Prepare voxelized shapes for many blends of them."""
        return cls.for_sketches(shapes, lattice, settings).with_connectivity()

    @classmethod
    def for_sketches(cls, shapes: SplitShapes, lattice: Lattice, settings: MorphSettings) -> MorphProblem:
        """Prepare voxelized shapes for sketches of their blends, which are not mended."""
        grid = lattice.grid(settings.sigma)
        parts = tuple(
            MorphPart(name, Inputs.of(densities, grid), volumes)
            for name, densities, volumes in zip(shapes.names, shapes.densities, shapes.volumes, strict=True)
        )
        return cls(parts, lattice, settings, (), shapes.notices)

    def with_connectivity(self, executor: Executor | None = None) -> MorphProblem:
        """Return what finished blends need; an executor's threads, if there is one, read the shapes side by side."""
        each = map if executor is None else executor.map
        return replace(self, connectivity=tuple(each(self.shape_connectivity, range(len(self.volumes)))))

    def shape_connectivity(self, index: int) -> Connectivity:
        """Read how shape `index` hangs together, from all of its parts."""
        return connectivity_of(self.occupancy(index), self.settings)

    def occupancy(self, index: int) -> NDArray[np.float64]:
        """Share of every cell that shape `index` fills, all of its parts together."""
        occupancy = np.zeros(self.lattice.shape)
        for part in self.parts:
            level = part.inputs.levels[-1]
            filled = np.exp(level.log_mus[index])
            occupancy.reshape(-1)[level.regions[index].index] += filled * (part.volumes[index] / filled.sum())
        return occupancy

    @property
    def sketch_depth(self) -> int:
        """How many levels finer than a sketch the blends are; 0 where the grid has no coarser one to sketch on."""
        *coarser, _ = (level.domain.cells for level in self.parts[0].inputs.levels)
        if not coarser:
            return 0
        return len(coarser) + 1 - max(sum(cells <= _SKETCH_CELLS for cells in coarser), 1)

    @property
    def sketch_bytes(self) -> int:
        """What one sketch keeps at the most until its blend is finished."""
        cells = float(np.prod(self.lattice.shape))
        filled = float(self.volumes.max()) / cells
        of_cell = _SKETCH_BYTES + _SKETCH_BYTES_FILLED * filled + _SKETCH_BYTES_PART * (len(self.parts) - 1)
        return int(cells / 8**self.sketch_depth * of_cell)

    @property
    def volumes(self) -> NDArray[np.float64]:
        """Volumes of the shapes in cells, (k,)."""
        return np.sum([part.volumes for part in self.parts], axis=0)

    def effort(self, blend: Blend) -> float:
        """Estimate how long a blend takes beside others: the kernel works on boxes as large as those of its shapes."""
        if blend.source is not None:
            return 0.0
        boxes = np.zeros(len(self.volumes))
        for part in self.parts:
            boxes += [region.box_cells for region in part.inputs.levels[-1].regions]
        return float(boxes @ blend.weights)

    def blend_volumes(self, blend: Blend) -> NDArray[np.float64]:
        """Volumes of the parts of a blend in cells, (p,)."""
        return np.array([float(np.dot(blend.weights, part.volumes)) for part in self.parts])

    def entropy_limits(self, blend: Blend) -> list[Literal["max"] | float | None]:
        """Entropy bounds of the parts: densities of mass m in places of their own add up to m (H - ln m)."""
        limit = self.settings.entropy_limit
        if limit is None or limit == "max":
            return [limit] * len(self.parts)
        volumes = self.blend_volumes(blend)
        return [limit + float(np.log(share)) for share in volumes / volumes.sum()]
