# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The volume of a closed mesh whose vertices move straight from one position to another.

The volume is a cubic form of the positions, V(x) = g(x) . x / 3 with the gradient g, a quadratic form. On the way from
x to y it is (1 - s)^3 V(x) + (1 - s)^2 s g(x) . y + (1 - s) s^2 g(y) . x + s^3 V(y).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ...geometry.normals import area_normals
from ...geometry.products import product

# Where along a piece the volume is measured.
_SHARES = np.array([0.25, 0.5, 0.75, 1.0])


@dataclass(frozen=True)
class KeepVolume:
    """The volume stays close to that of the samples of a path; a :class:`.straight_pieces.Criterion`.

    Attributes
    ----------
    faces : (m, 3) int64
        Triangles of a closed mesh.
    products : (f, f) float64
        g(x_i) . x_j of the samples i and j.
    most : float
        Largest relative error.
    """

    faces: NDArray[np.int64]
    products: NDArray[np.float64]
    most: float

    @classmethod
    def of(cls, path: NDArray[np.float64], faces: NDArray[np.int64], most: float) -> KeepVolume:
        """Compute the products of all samples of a path, (f, n, 3)."""
        return cls(faces, volume_products(path, faces), most)

    def between(self, begin: int, end: int) -> float:
        """Measure the volume between two samples."""
        chosen = np.ix_([begin, end], [begin, end])
        return self._error((begin, end), self.products[chosen])

    def along(self, knots: Sequence[int], positions: NDArray[np.float64]) -> float:
        """Measure the volume along all pieces."""
        products = volume_products(positions, self.faces)
        pieces = enumerate(pairwise(knots))
        return max(self._error(piece, products[place : place + 2, place : place + 2]) for place, piece in pieces)

    def _error(self, piece: tuple[int, int], products: NDArray[np.float64]) -> float:
        times = piece[0] + _SHARES * (piece[1] - piece[0])
        wanted = np.interp(times, np.arange(len(self.products)), np.diag(self.products)) / 3.0
        return float(np.abs(volumes_between(products) / wanted - 1.0).max()) / self.most


def volume_products(positions: NDArray[np.float64], faces: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return g(x_i) . x_j for positions x, (k, n, 3), of the vertices of a closed mesh, (k, k)."""
    # Volumes do not depend on the origin; near to it, sums are exact.
    centered = positions - positions.mean(axis=(0, 1))
    gradients = np.stack([area_normals(points, faces) for points in centered])
    return product(gradients.reshape(len(positions), -1), centered.reshape(len(positions), -1).T)


def volumes_between(products: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return volumes on the way between two positions, with their products, (2, 2), at a quarter, half, ... of it."""
    (own, there), (back, other) = products
    s, r = _SHARES, 1.0 - _SHARES
    return r**3 * own / 3.0 + r**2 * s * there + r * s**2 * back + s**3 * other / 3.0
