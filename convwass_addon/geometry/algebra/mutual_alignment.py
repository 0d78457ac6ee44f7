# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Mutual rigid alignment of several shapes, each moved according to its weight.

Rotations and translations minimize the weighted squared distances of corresponding points (generalized Procrustes
analysis; J. Gower, "Generalized Procrustes Analysis", Psychometrika 40, 1975). The common motion, which this leaves
undetermined, is chosen such that the weighted mean of the motions is zero.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .rotation_fields import rotation_matrices, rotation_vectors
from .rotations import nearest_rotation

# Rounds in which every shape is aligned to the others; two shapes need only one.
_ROUNDS = 30
# Iterations for the mean of rotations.
_MEAN_ROUNDS = 8


@dataclass(frozen=True)
class RigidPose:
    """A rotation about a center and a translation.

    Attributes
    ----------
    vector : (3,) float64
        Rotation vector, radians.
    center : (3,) float64
        Center of the rotation.
    offset : (3,) float64
        Translation of the center.
    """

    vector: NDArray[np.float64]
    center: NDArray[np.float64]
    offset: NDArray[np.float64]

    def applied(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return transformed points, (n, 3)."""
        return (points - self.center) @ rotation_matrices(self.vector[None])[0].T + self.center + self.offset

    def scaled(self, share: float) -> RigidPose:
        """Return a fraction of the motion."""
        return RigidPose(share * self.vector, self.center, share * self.offset)


@dataclass(frozen=True)
class Correspondence:
    """Corresponding points of two shapes, summarized by their moments.

    Attributes
    ----------
    shapes : (int, int)
        Indices of the shapes.
    means : (2, 3) float64
        Mean of each shape's points.
    covariance : (3, 3) float64
        Covariance of the points of the first shape with those of the second.
    """

    shapes: tuple[int, int]
    means: NDArray[np.float64]
    covariance: NDArray[np.float64]

    @classmethod
    def of(
        cls,
        shapes: tuple[int, int],
        first: NDArray[np.float64],
        second: NDArray[np.float64],
        weights: NDArray[np.float64],
    ) -> Correspondence:
        """Summarize points, (n, 3) each, with weights, (n,), of any sum."""
        shares = weights / weights.sum()
        means = np.stack([shares @ first, shares @ second])
        covariance = np.einsum("n,ni,nj->ij", shares, first - means[0], second - means[1])
        return cls(shapes, means, covariance)

    @property
    def swapped(self) -> Correspondence:
        """The same in the opposite direction."""
        return Correspondence(self.shapes[::-1], self.means[::-1], self.covariance.T)

    def about(self, first: NDArray[np.float64], second: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the cross moments about given points, (3, 3)."""
        return self.covariance + np.outer(self.means[0] - first, self.means[1] - second)


def mutual_poses(weights: Sequence[float], correspondences: Sequence[Correspondence]) -> list[RigidPose]:
    """Return for every shape the motion that aligns it with the others.

    Parameters
    ----------
    weights : sequence of float
        Weight of every shape in the common pose, of sum one: a shape with weight one does not move.
    correspondences : sequence of Correspondence
        Correspondences between these shapes. Each is weighted by the product of its shapes' weights.
    """
    count, shares = len(weights), np.asarray(weights, dtype=np.float64)
    both = [*correspondences, *(found.swapped for found in correspondences)]
    pulls = np.array([shares[found.shapes[0]] * shares[found.shapes[1]] for found in both])
    centers = _centers(both, pulls, count)
    turns = _turns(both, pulls, centers, count)
    mean = mean_rotation(turns, shares)
    # Remove the common rotation.
    turns = np.einsum("ji,njk->nik", mean, turns)
    offsets = _offsets(both, pulls, centers, turns, shares) + shares @ centers - centers
    vectors = rotation_vectors(turns)
    return [RigidPose(*parts) for parts in zip(vectors, centers, offsets, strict=True)]


def _centers(both: list[Correspondence], pulls: NDArray[np.float64], count: int) -> NDArray[np.float64]:
    """Return the mean of the corresponding points of every shape, (k, 3)."""
    sums, totals = np.zeros((count, 3)), np.zeros(count)
    for found, pull in zip(both, pulls, strict=True):
        sums[found.shapes[0]] += pull * found.means[0]
        totals[found.shapes[0]] += pull
    return sums / np.where(totals > 0, totals, 1.0)[:, None]


def _turns(
    both: list[Correspondence], pulls: NDArray[np.float64], centers: NDArray[np.float64], count: int
) -> NDArray[np.float64]:
    """Return rotations, (k, 3, 3), that align all shapes, with the first one fixed."""
    turns = np.tile(np.eye(3), (count, 1, 1))
    moments = [
        (found.shapes, pull * found.about(*centers[list(found.shapes)]))
        for found, pull in zip(both, pulls, strict=True)
    ]
    known = {0}
    # First align every shape to those already placed, then all shapes to all.
    for _ in range(count - 1):
        for shape in sorted({shapes[0] for shapes, _ in moments if shapes[1] in known} - known):
            turns[shape] = _realigned(shape, [part for part in moments if part[0][1] in known], turns)
            known.add(shape)
    for _ in range(_ROUNDS if count > 2 else 0):
        for shape in range(1, count):
            turns[shape] = _realigned(shape, moments, turns)
    return turns


def _realigned(
    shape: int, moments: list[tuple[tuple[int, int], NDArray[np.float64]]], turns: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the rotation that best aligns one shape to the others in their current poses."""
    parts = [turns[shapes[1]] @ moment.T for shapes, moment in moments if shapes[0] == shape]
    return nearest_rotation(sum(parts)) if parts else turns[shape]


def mean_rotation(turns: NDArray[np.float64], shares: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the rotation, (3, 3), relative to which the weighted mean of all rotation vectors is zero.

    Parameters
    ----------
    turns : (k, 3, 3)
        Rotations.
    shares : (k,)
        Their weights, of sum one.
    """
    mean = turns[0]
    for _ in range(_MEAN_ROUNDS):
        step = shares @ rotation_vectors(np.einsum("ji,njk->nik", mean, turns))
        mean = mean @ rotation_matrices(step[None])[0]
    return mean


def _offsets(
    both: list[Correspondence],
    pulls: NDArray[np.float64],
    centers: NDArray[np.float64],
    turns: NDArray[np.float64],
    shares: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return translations of the rotated shapes' centers from a common point, (k, 3), with weighted mean zero."""
    count = len(shares)
    # The last equation fixes the mean; it is scaled like the others.
    scale = max(float(pulls.sum()), np.finfo(float).tiny)
    matrix, right = np.outer(shares, shares) * scale, np.zeros((count, 3))
    for (one, other), found, pull in zip((found.shapes for found in both), both, pulls, strict=True):
        apart = turns[other] @ (found.means[1] - centers[other]) - turns[one] @ (found.means[0] - centers[one])
        matrix[one, one] += pull
        matrix[one, other] -= pull
        right[one] += pull * apart
    return np.linalg.lstsq(matrix, right, rcond=None)[0]
