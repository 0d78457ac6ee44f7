# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A surface that resists being bent and sheared: edges keep to what smooth fields of rotations and scales make of them.

The rotations and scales are fitted to neighborhoods around every vertex (Z. Levi and C. Gotsman, "Smooth Rotation
Enhanced As-Rigid-As-Possible Mesh Animation", TVCG 21, 2015).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array, csr_array, diags_array

from .factorization import Factorization, factorize
from .rotations import nearest_rotations
from .unit_shape import UnitShape


class ElasticSurface:
    """The edges of a surface and what they resist.

    Parameters
    ----------
    shape : UnitShape
        At rest.
    """

    def __init__(self, shape: UnitShape) -> None:
        matrix = shape.laplacian.matrix
        entries = matrix.tocoo()
        rows, columns = entries.coords
        apart = rows != columns
        self._rows, self._columns, self._weights = rows[apart], columns[apart], -entries.data[apart]
        count = len(shape.vertices)
        self._areas = shape.areas
        # With an entry on every place of the diagonal, to which what pulls is added.
        self._matrix = (matrix + diags_array(np.ones(count))).tocsc()
        self._matrix.sort_indices()
        ends = np.repeat(np.arange(count), np.diff(self._matrix.indptr))
        self._diagonal = np.flatnonzero(self._matrix.indices == ends)
        self._matrix.data[self._diagonal] -= 1.0
        self._edges = shape.vertices[self._rows] - shape.vertices[self._columns]
        self._sums = csr_array(
            (np.ones(len(self._rows)), (self._rows, np.arange(len(self._rows)))), shape=(count, len(self._rows))
        )
        self._squares = self._sums @ (self._weights * np.square(self._edges).sum(axis=1))
        self._blurs: dict[float, Factorization] = {}

    def relaxed(
        self, points: NDArray[np.float64], weights: NDArray[np.float64], pulls: NDArray[np.float64], width: float
    ) -> NDArray[np.float64]:
        """Fit rotations to points, and solve for points that agree with them and with what pulls."""
        right = self._sums @ (self._weights[:, None] * self._turned(points, width)) + pulls
        # Vertices without edges stay where they are.
        loose = self._areas <= 0
        held = np.where(loose, 1.0, weights)
        right[loose] = points[loose]
        factor = factorize(self._with_diagonal(1.0, held))
        return np.ascontiguousarray(factor.solve(np.ascontiguousarray(right.T)).T)

    def strain(self, points: NDArray[np.float64], width: float) -> float:
        """Return how much edges differ from what their neighborhoods make of them."""
        moved = points[self._rows] - points[self._columns]
        rest = np.square(moved - self._turned(points, width)).sum(axis=1)
        return float(0.5 * (self._weights * rest).sum())

    def _turned(self, points: NDArray[np.float64], width: float) -> NDArray[np.float64]:
        """Edges turned and scaled as the neighborhoods of their ends are, (e, 3)."""
        fits = self.fits(points, width)
        return 0.5 * np.einsum("eij,ej->ei", fits[self._rows] + fits[self._columns], self._edges)

    def fits(self, points: NDArray[np.float64], width: float) -> NDArray[np.float64]:
        """Return the rotation times scale that takes each neighborhood best from rest to its place, (n, 3, 3).

        Parameters
        ----------
        points : (n, 3)
            Where the vertices are.
        width : float
            Size of the neighborhoods, on the surface of unit area.
        """
        moved = points[self._rows] - points[self._columns]
        products = self._weights[:, None, None] * moved[:, :, None] * self._edges[:, None, :]
        sums = self._sums @ products.reshape(len(moved), 9)
        smooth = self._blurred(np.concatenate([sums.T, self._squares[None]]), width)
        fitted = nearest_rotations(smooth[:9].reshape(3, 3, -1))
        scales = np.maximum(fitted.traces, 0.0) / np.maximum(smooth[9], np.finfo(float).tiny)
        return np.ascontiguousarray(np.moveaxis(scales * fitted.rotations, 2, 0))

    def _blurred(self, columns: NDArray[np.float64], width: float) -> NDArray[np.float64]:
        """Return sums over neighborhoods, (k, n): one implicit step of heat."""
        if width not in self._blurs:
            held = np.where(self._areas > 0, self._areas, 1.0)
            self._blurs[width] = factorize(self._with_diagonal(width**2, held))
        return self._blurs[width].solve(np.ascontiguousarray(columns))

    def _with_diagonal(self, scale: float, values: NDArray[np.float64]) -> csc_array:
        """Return a multiple of the stiffness with values added to its diagonal."""
        system = scale * self._matrix
        system.data[self._diagonal] += values
        return system
