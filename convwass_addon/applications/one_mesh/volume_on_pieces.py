# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The volume of a closed mesh whose vertices move straight from one position to another.

The volume is a cubic form of the positions, V(x) = g(x) . x / 3 with the gradient g, a quadratic form. On the way from
x to y it is (1 - s)^3 V(x) + (1 - s)^2 s g(x) . y + (1 - s) s^2 g(y) . x + s^3 V(y).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ...geometry.normals import cross_coordinates
from ...geometry.products import product
from ...progress import Control, Progress, Work
from ...sentence import Sentence

# Where along a piece the volume is measured.
_SHARES = np.array([0.25, 0.5, 0.75, 1.0])
# Triangles processed together; each needs a few hundred bytes per position, which should stay in the processor's cache.
_AT_ONCE = 1 << 11


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
    def of(
        cls, path: NDArray[np.float64], faces: NDArray[np.int64], most: float, message: Sentence, control: Control
    ) -> Work[KeepVolume]:
        """Compute the products of all samples of a path, (f, n, 3)."""
        products = np.zeros((len(path),) * 2)
        for share, added in _products_by_part(path, faces):
            control.check()
            yield Progress(share, message)
            products += added
        return cls(faces, products, most)

    def between(self, begin: int, end: int) -> float:
        """Measure the volume between two samples."""
        chosen = np.ix_([begin, end], [begin, end])
        return self._error((begin, end), self.products[chosen])

    def along(self, knots: Sequence[int], positions: NDArray[np.float64], control: Control) -> float:
        """Measure the volume along all pieces."""
        products = np.zeros((len(positions),) * 2)
        for _, added in _products_by_part(positions, self.faces):
            control.check()
            products += added
        pieces = enumerate(pairwise(knots))
        return max(self._error(piece, products[place : place + 2, place : place + 2]) for place, piece in pieces)

    def _error(self, piece: tuple[int, int], products: NDArray[np.float64]) -> float:
        times = piece[0] + _SHARES * (piece[1] - piece[0])
        wanted = np.interp(times, np.arange(len(self.products)), np.diag(self.products)) / 3.0
        return float(np.abs(volumes_between(products) / wanted - 1.0).max()) / self.most


def _products_by_part(
    positions: NDArray[np.float64], faces: NDArray[np.int64]
) -> Iterator[tuple[float, NDArray[np.float64]]]:
    """Yield how much is done, and what some triangles add to g(x_i) . x_j for positions x, (k, n, 3), as (k, k).

    It is a sixth of their doubled area vectors in one position times the sums of their corners in the other.
    """
    # Volumes do not depend on the origin; near to it, sums are exact.
    center = positions[0].mean(axis=0)
    for start in range(0, len(faces), _AT_ONCE):
        first, second, third = (
            np.ascontiguousarray(np.moveaxis(positions.take(corner, axis=1) - center, 2, 0))
            for corner in faces[start : start + _AT_ONCE].T
        )
        areas, sums = cross_coordinates(second - first, third - first), first + second + third
        added = sum(product(own, other.T) for own, other in zip(areas, sums, strict=True))
        yield start / len(faces), added / 6.0


def volumes_between(products: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return volumes on the way between two positions, with their products, (2, 2), at a quarter, half, ... of it."""
    (own, there), (back, other) = products
    s, r = _SHARES, 1.0 - _SHARES
    return r**3 * own / 3.0 + r**2 * s * there + r * s**2 * back + s**3 * other / 3.0
