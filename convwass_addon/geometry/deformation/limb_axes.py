# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Directions of limbs: around a limb, the normals of the surface are perpendicular to one direction, its axis."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..arrays.steps import linear_step
from ..meshes.normals import vertex_normals
from .unit_shape import UnitShape

# Normals are averaged over neighborhoods of this size, on the surface of unit area, and this number of times; together,
# that reaches around arms and legs. Rotations of shapes need sums of the same size, so both share a factorization.
_WIDTH, _ROUNDS = 0.03, 4
# Up to the first roundness, a surface belongs to no limb, and from the second one, it certainly does.
_FLAT, _ROUND = 0.3, 0.6
# Size of the neighborhoods in which axes extend to the ends of limbs, and the share of round surface in one from which
# its axis has its full weight.
_FAR, _COVERED = 0.06, 0.2


@dataclass(frozen=True)
class LimbAxes:
    """The axes of the limbs that points of a surface belong to.

    Attributes
    ----------
    directions : (n, 3) float64
        Unit vectors of arbitrary sign.
    weights : (n,) float64
        How certainly the point belongs to a limb in this direction, 0 to 1.
    """

    directions: NDArray[np.float64]
    weights: NDArray[np.float64]

    @classmethod
    def of(cls, shape: UnitShape) -> LimbAxes:
        """Find the axes from the second moments of the normals around every vertex.

        Their eigenvalues are 1/2, 1/2 and 0 on a cylinder, 1, 0 and 0 on a plane, and 1/3 each on a ball. The roundness
        is twice the difference of the two smaller ones. Axes of round parts extend to what is close to them: the hand
        goes with the arm.
        """
        normals = vertex_normals(shape.vertices, shape.mesh.faces)
        values, vectors = np.linalg.eigh(_averaged(shape, _squares(normals), _WIDTH, _ROUNDS))
        roundness = 2.0 * (values[:, 1] - values[:, 0])
        certain = linear_step(roundness, _FLAT, _ROUND)
        around = _averaged(shape, certain[:, None, None] * _squares(vectors[:, :, 0]), _FAR, 1)
        values, vectors = np.linalg.eigh(around)
        covered = np.maximum(values.sum(axis=1), np.finfo(float).tiny)
        agreement = (values[:, 2] - values[:, 1]) / covered
        return cls(vectors[:, :, 2], np.clip(agreement, 0.0, 1.0) * np.minimum(covered / _COVERED, 1.0))


def _squares(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the outer products of vectors, (n, 3), with themselves, (n, 3, 3)."""
    return vectors[:, :, None] * vectors[:, None]


def _averaged(shape: UnitShape, values: NDArray[np.float64], width: float, rounds: int) -> NDArray[np.float64]:
    """Return the means of values at the vertices, (n, 3, 3), over the neighborhood of every vertex, repeatedly."""
    columns = values.reshape(-1, 9).T
    for _ in range(rounds):
        # Of the areas themselves, the sum is one, so that these are means.
        columns = shape.elastic.blurred(shape.areas * columns, width)
    return columns.T.reshape(-1, 3, 3)
