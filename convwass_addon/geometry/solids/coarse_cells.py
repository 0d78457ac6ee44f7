# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A coarse grid around one mesh, to measure its solid."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..meshes.mesh import TriangleMesh

# Cells along the longest side, and empty cells around the mesh, which `occupancy` requires.
_RESOLUTION, _MARGIN = 64, 2


@dataclass(frozen=True)
class CoarseCells:
    """A mesh in a grid of 64 cells along its longest side.

    Attributes
    ----------
    corners : (m, 3, 3) float64
        Corners of the triangles, in cells.
    shape : (int, int, int)
        Cells per axis.
    spacing : float
        Size of a cell, in units of the mesh.
    """

    corners: NDArray[np.float64]
    shape: tuple[int, int, int]
    spacing: float

    @classmethod
    def around(cls, mesh: TriangleMesh) -> CoarseCells:
        """Center the grid around a mesh of positive size."""
        extent = np.ptp(mesh.bounds, axis=0)
        spacing = float(extent.max()) / _RESOLUTION
        cells = np.ceil(extent / spacing).astype(int) + 2 * _MARGIN
        origin = mesh.bounds.mean(axis=0) - cells * spacing / 2
        return cls((mesh.corners - origin) / spacing, tuple(int(count) for count in cells), spacing)
