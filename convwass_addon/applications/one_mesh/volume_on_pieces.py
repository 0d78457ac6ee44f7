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

from ...geometry.algebra.products import product
from ...geometry.arrays.chunks import chunks
from ...geometry.meshes.normals import cross_coordinates
from ...progress import Control, Progress, Work
from ...sentence import Sentence
from .refined_samples import RefinedPath

# Where along a piece the volume is measured.
_SHARES = np.array([0.25, 0.5, 0.75, 1.0])
# Triangles processed together; each needs a few hundred bytes per position, which should stay in the processor's cache.
_AT_ONCE = 1 << 11


@dataclass(frozen=True)
class KeepVolume:
    """The volume stays close to that of a path; a :class:`.straight_pieces.Criterion`.

    Attributes
    ----------
    path : RefinedPath
        The path.
    faces : (m, 3) int64
        Triangles of a closed mesh.
    products : (f, f) float64
        g(x_i) . x_j of the positions i and j.
    most : float
        Largest relative error.
    """

    path: RefinedPath
    faces: NDArray[np.int64]
    products: NDArray[np.float64]
    most: float

    @classmethod
    def of(
        cls, path: RefinedPath, faces: NDArray[np.int64], most: float, message: Sentence, control: Control
    ) -> Work[KeepVolume]:
        """Compute the products of all positions of a path."""
        products = np.zeros((len(path),) * 2)
        for share, added in _products_by_part(path.samples, path.weights, faces):
            control.check()
            yield Progress(share, message)
            products += added
        return cls(path, faces, products, most)

    def between(self, begin: int, end: int) -> float:
        """Measure the volume between two samples."""
        chosen = np.ix_([begin, end], [begin, end])
        return self._error((begin, end), self.products[chosen])

    def along(self, knots: Sequence[int], weights: NDArray[np.float64], control: Control) -> float:
        """Measure the volume along all pieces."""
        products = np.zeros((len(weights),) * 2)
        for _, added in _products_by_part(self.path.samples, weights, self.faces):
            control.check()
            products += added
        pieces = enumerate(pairwise(knots))
        return max(self._error(piece, products[place : place + 2, place : place + 2]) for place, piece in pieces)

    def _error(self, piece: tuple[int, int], products: NDArray[np.float64]) -> float:
        times = piece[0] + _SHARES * (piece[1] - piece[0])
        wanted = np.interp(times, np.arange(len(self.products)), np.diag(self.products)) / 3.0
        return float(np.abs(volumes_between(products) / wanted - 1.0).max()) / self.most


def _products_by_part(
    samples: NDArray[np.float64], weights: NDArray[np.float64], faces: NDArray[np.int64]
) -> Iterator[tuple[float, NDArray[np.float64]]]:
    """Yield how much is done, and what some triangles add to g(x_i) . x_j for means x of samples, as (k, k).

    It is a sixth of their doubled area vectors in one position times the sums of their corners in the other.

    Parameters
    ----------
    samples : (s, n, 3) float64
        Positions of the vertices.
    weights : (k, s) float64
        Weights of the samples in the means.
    faces : (m, 3) int64
        Triangles of a closed mesh.
    """
    # Volumes do not depend on the origin; near to it, sums are exact.
    center = 3.0 * samples[0].mean(axis=0)[:, None]
    for part in chunks(len(faces), _AT_ONCE):
        some = np.ascontiguousarray(faces[part].T)
        # One contiguous array per corner and coordinate, (s, 3, 3, c).
        corners = np.ascontiguousarray(np.moveaxis(samples.take(some, axis=1), 3, 2))
        sums = corners.sum(axis=1) - center
        edges = corners[:, 1:] - corners[:, :1]
        moved = product(weights, edges.reshape(len(samples), -1)).reshape(len(weights), 2, 3, -1)
        areas = np.stack(cross_coordinates(*np.moveaxis(moved, 0, 2)), axis=1)
        added = product(areas.reshape(len(weights), -1), sums.reshape(len(samples), -1).T)
        yield part.start / len(faces), product(added, weights.T) / 6.0


def volumes_between(products: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return volumes on the way between two positions, with their products, (2, 2), at a quarter, half, ... of it."""
    (own, there), (back, other) = products
    s, r = _SHARES, 1.0 - _SHARES
    return r**3 * own / 3.0 + r**2 * s * there + r * s**2 * back + s**3 * other / 3.0
