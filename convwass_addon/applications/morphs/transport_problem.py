# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The distributions that a morph transports, in space or in a plane: the parts of all shapes on one grid."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...transport import Barycenter, Grid, Inputs
from .interpolated_volumes import interpolated_volumes
from .layouts import Blend
from .morph_settings import MorphSettings
from .part_labels import PartNotice
from .parts import SplitShapes

# A limit is met if the entropy exceeds it by less than this.
_MET = 0.05
# Sketches are solved on the finest of the coarser levels with at most this many cells.
_SKETCH_CELLS = 300_000
# Maximum bytes that a sketch keeps until its blend is finished, per cell of the level that it is solved on: for all
# cells, for those that the largest shape fills, and for every further part (tests/applications/test_previews.py,
# test_the_memory_of_sketches_is_estimated).
_SKETCH_BYTES, _SKETCH_BYTES_FILLED, _SKETCH_BYTES_PART = 52, 85, 45


class GridLattice(Protocol):
    """The grid shared by the shapes, in space or in a plane: :class:`.Lattice` or :class:`.FlatLattice`.

    Attributes
    ----------
    shape : tuple of int
        Cells per axis.
    spacing : float
        Size of a cell in scene units.
    """

    shape: tuple[int, ...]
    spacing: float

    def grid(self, sigma: float) -> Grid:
        """Return the transport domain with a kernel of `sigma` cells."""


@dataclass(frozen=True)
class MorphPart:
    """Something transported independently: a part of all shapes, or the whole shapes.

    Attributes
    ----------
    name : str
        Name in the record.
    inputs : Inputs
        The part of every shape as a distribution.
    volumes : (k,) float64
        Its volume in every shape, in cells.
    """

    name: str
    inputs: Inputs
    volumes: NDArray[np.float64]


@dataclass(frozen=True)
class TransportProblem:
    """The distributions whose barycenters are the blends; can be sent to another process.

    Attributes
    ----------
    parts : tuple of MorphPart
        One, unless shapes have parts.
    lattice : GridLattice
        The grid of the shapes.
    settings : MorphSettings
        Settings of the morph.
    notices : tuple of PartNotice
        Messages to the user about the parts.
    """

    parts: tuple[MorphPart, ...]
    lattice: GridLattice
    settings: MorphSettings
    notices: tuple[PartNotice, ...] = ()

    @classmethod
    def of(cls, shapes: SplitShapes, lattice: GridLattice, settings: MorphSettings) -> TransportProblem:
        """Convert the occupancies of shapes to distributions."""
        grid = lattice.grid(settings.sigma)
        parts = tuple(
            MorphPart(name, Inputs.of(densities, grid), volumes)
            for name, densities, volumes in zip(shapes.names, shapes.densities, shapes.volumes, strict=True)
        )
        return cls(parts, lattice, settings, shapes.notices)

    @property
    def volumes(self) -> NDArray[np.float64]:
        """Volumes of the shapes in cells, (k,)."""
        return np.sum([part.volumes for part in self.parts], axis=0)

    def input_volume(self, index: int) -> float:
        """Volume of shape `index`, or its area in a plane, in scene units."""
        return self.volumes[index] * self.lattice.spacing ** len(self.lattice.shape)

    def occupancy(self, index: int) -> NDArray[np.float64]:
        """Fraction of every cell that shape `index` fills, including all of its parts."""
        occupancy = np.zeros(self.lattice.shape)
        for part in self.parts:
            level = part.inputs.levels[-1]
            filled = np.exp(level.log_mus[index])
            occupancy.reshape(-1)[level.regions[index].index] += filled * (part.volumes[index] / filled.sum())
        return occupancy

    @property
    def sketch_depth(self) -> int:
        """Number of levels by which a sketch is coarser than its blend; 0 if the grid has no coarser level."""
        *coarser, _ = (level.domain.cells for level in self.parts[0].inputs.levels)
        if not coarser:
            return 0
        return len(coarser) + 1 - max(sum(cells <= _SKETCH_CELLS for cells in coarser), 1)

    @property
    def sketch_bytes(self) -> int:
        """Maximum number of bytes that a sketch keeps until its blend is finished."""
        cells = float(np.prod(self.lattice.shape))
        filled = float(self.volumes.max()) / cells
        of_cell = _SKETCH_BYTES + _SKETCH_BYTES_FILLED * filled + _SKETCH_BYTES_PART * (len(self.parts) - 1)
        return int(cells / 8**self.sketch_depth * of_cell)

    def effort(self, blend: Blend) -> float:
        """Estimate the relative time that a blend takes, from the boxes of its shapes, on which the kernel works."""
        if blend.source is not None:
            return 0.0
        boxes = np.zeros(len(self.volumes))
        for part in self.parts:
            boxes += [region.box_cells for region in part.inputs.levels[-1].regions]
        return float(boxes @ blend.weights)

    def blend_volumes(self, blend: Blend) -> NDArray[np.float64]:
        """Volumes of the parts of a blend in cells, (p,)."""
        return interpolated_volumes(blend.weights, [part.volumes for part in self.parts], self.settings.growth)

    def require_reachable_limit(self) -> None:
        """Refuse an entropy limit that no density on the grid meets: less than that of one full cell.

        Raises
        ------
        InputError
            The message names the least limit that is possible.
        """
        limit = self.settings.entropy_limit
        if limit is None or isinstance(limit, str):
            return
        least = -float(np.log(self.lattice.shape).sum())
        if limit < least:
            raise InputError(
                "No blend on this grid has an entropy as low as {limit:g}: a single cell has {least:.2f}. Raise the "
                "entropy limit, or set it to As the Inputs.",
                limit=limit,
                least=least,
            )

    def require_met_limits(
        self,
        parts: Sequence[Barycenter],
        limits: Sequence[Literal["max"] | float | None],
        volumes: NDArray[np.float64],
    ) -> None:
        """Refuse an entropy limit at which the parts of a blend fill fewer cells than their volumes, (p,), need.

        Raises
        ------
        InputError
            The message names the entropy of a solid of the blend's volume.
        """
        for part, limit, volume in zip(parts, limits, volumes, strict=True):
            if limit is None or isinstance(limit, str):
                continue
            if part.entropy > limit + _MET or np.count_nonzero(part.density) < volume:
                raise InputError(
                    "The entropy limit {limit:g} is too low for these shapes: a solid of their volume has "
                    "{usual:.2f}. Raise the entropy limit, or set it to As the Inputs.",
                    limit=self.settings.entropy_limit,
                    usual=float(np.log(volumes.sum() / np.prod(self.lattice.shape))),
                )

    def entropy_limits(self, volumes: NDArray[np.float64]) -> list[Literal["max"] | float | None]:
        """Return entropy bounds for the parts of a blend with these volumes, (p,).

        The entropy of disjoint parts with masses m and entropies H is sum m (H - ln m), so the bound of a part is the
        given one plus ln m.
        """
        limit = self.settings.entropy_limit
        if limit is None or limit == "max":
            return [limit] * len(self.parts)
        return [limit + float(np.log(share)) for share in volumes / volumes.sum()]
