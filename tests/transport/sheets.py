# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Flat sheets as domains."""

from __future__ import annotations

import numpy as np

from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.transport import Surface


def sheet_mesh(columns: int, rows: int) -> TriangleMesh:
    """A rectangle of unit squares, each split along a diagonal that alternates like a chessboard."""
    x, y = np.meshgrid(np.arange(columns + 1), np.arange(rows + 1), indexing="ij")
    vertices = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=1)
    i, j = (axis.ravel() for axis in np.meshgrid(np.arange(columns), np.arange(rows), indexing="ij"))
    a = i * (rows + 1) + j
    b, c, d = a + rows + 1, a + rows + 2, a + 1
    even = ((i + j) % 2 == 0)[:, None]
    first = np.where(even, np.stack([a, b, c], 1), np.stack([a, b, d], 1))
    second = np.where(even, np.stack([a, c, d], 1), np.stack([b, c, d], 1))
    return TriangleMesh.from_arrays(vertices, np.concatenate([first, second]))


def sheet(cells: int, *, gamma: float | None = None, steps: int = 10) -> Surface:
    """The unit square."""
    mesh = sheet_mesh(cells, cells)
    return Surface(mesh.vertices / cells, mesh.faces, gamma, steps)


def strip(columns: int, gamma: float, steps: int = 10) -> Surface:
    """A long strip, one cell wide."""
    mesh = sheet_mesh(columns, 1)
    return Surface(mesh.vertices, mesh.faces, gamma, steps)
