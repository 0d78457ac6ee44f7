# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the parts of a shape are between poses: parts that turn against each other turn about the joint between them.

Between two rigid parts that turn by rotations R_i and R_j there is a point c that both move alike, the joint; it
follows from where the parts end up. On the way, points x_i and x_j of the parts are R_i (x_i - c) + R_j (c - x_j)
apart. Where parts are not rigid, the rest of that vector is interpolated linearly in the frame that turns with both.
Surfaces alone do not know this: the skin of an armpit that is tight in one pose would draw the arm into the shoulder.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve
from scipy.sparse import coo_array

from .rotation_fields import rotation_matrices
from .surface_samples import SurfaceSamples

# Lines are compared over this part of the reach, and one that is strained by this much counts half. The rotations of
# parts that turn against each other by less than the damping, in radians, tell nothing about a joint. The strain was
# measured (docs/performance.md, Motions).
_NEAR, _STRAIN, _DAMPING = 0.3, 0.1, 0.1
# No sample counts less than this, so that all are held.
_LEAST_WEIGHT = 1e-3
# Weight with which samples keep to the straight line between their ends, beside that of the others: it holds what no
# line leads to.
_HOLD = 1e-9
# Rounds and smoothing, in sizes, of the geometric median.
_MEDIAN_ROUNDS, _MEDIAN_WIDTH = 30, 2e-3


@dataclass(frozen=True)
class HingedPose:
    """A pose that a shape is deformed to, as lines between its samples see it.

    Attributes
    ----------
    points : (s, 3) float64
        Where the samples are.
    vectors : (s, 3) float64
        How their surroundings turn, rotation vectors in radians.
    joints : (p, 3) float64
        The joint of every pair, at rest, from the middle of the two.
    stretches : (p, 3) float64
        What remains of the line of every pair, turned back.
    weights : (p,) float64
        How much every pair counts.
    """

    points: NDArray[np.float64]
    vectors: NDArray[np.float64]
    joints: NDArray[np.float64]
    stretches: NDArray[np.float64]
    weights: NDArray[np.float64]

    @classmethod
    def of(
        cls,
        samples: SurfaceSamples,
        rest: NDArray[np.float64],
        moved: NDArray[np.float64],
        vectors: NDArray[np.float64],
    ) -> HingedPose:
        """Find joints between the parts of a shape.

        Parameters
        ----------
        samples : SurfaceSamples
            Of the shape at rest.
        rest, moved : (n, 3)
            Its vertices at rest and in the pose.
        vectors : (n, 3)
            Their rotation vectors.
        """
        start, end, own = rest[samples.seeds], moved[samples.seeds], vectors[samples.seeds]
        one, other = samples.pairs.T
        first, second = rotation_matrices(own[one]), rotation_matrices(own[other])
        half = 0.5 * (start[one] - start[other])
        line = end[one] - end[other]
        unexplained = line - np.einsum("pij,pj->pi", first + second, half)
        lengths = 2.0 * np.linalg.norm(half, axis=1)
        errors = [
            np.square(line - 2.0 * np.einsum("pij,pj->pi", turn, half)).sum(axis=1) / lengths**2
            for turn in (first, second)
        ]
        rigid = _rigidity(samples, lengths, errors)
        both = rigid[one] * rigid[other]
        against = second - first
        back = np.swapaxes(against, 1, 2)
        normal = back @ against + _DAMPING**2 * np.eye(3)
        offsets = np.linalg.solve(normal, np.einsum("pij,pj->pi", back, unexplained)[:, :, None])[:, :, 0]
        between = rotation_matrices(0.5 * (own[one] + own[other]))
        stretches = np.einsum("pji,pj->pi", between, unexplained - np.einsum("pij,pj->pi", against, offsets))
        strain = np.square(stretches).sum(axis=1) / lengths**2
        reach = lengths.max(initial=0.0)
        falloff = np.square(1.0 - lengths / reach) * reach / lengths
        weights = both * falloff / np.square(1.0 + strain / _STRAIN**2)
        return cls(end, own, offsets, stretches, weights)


def _rigidity(
    samples: SurfaceSamples, lengths: NDArray[np.float64], errors: Sequence[NDArray[np.float64]]
) -> NDArray[np.float64]:
    """Return how rigidly the surroundings of every sample move, from 0 to 1, (s,), by errors of lines at both ends."""
    near = lengths < _NEAR * lengths.max(initial=0.0)
    count = len(samples.seeds)
    sums, totals = np.zeros(count), np.zeros(count)
    for ends, own in zip(samples.pairs[near].T, errors, strict=True):
        sums += np.bincount(ends, own[near], count)
        totals += np.bincount(ends, minlength=count)
    means = sums / np.maximum(totals, 1.0)
    return np.maximum(1.0 / np.square(1.0 + means / _STRAIN**2), _LEAST_WEIGHT)


def hinged_points(
    samples: SurfaceSamples,
    rest: NDArray[np.float64],
    poses: Sequence[HingedPose],
    shares: Sequence[float],
    scale: float = 1.0,
    stretch: float = 1.0,
) -> NDArray[np.float64]:
    """Return where rigid regions around the samples take the vertices of a shape between poses, (n, 3).

    What stands still in all poses stands still on the way: the whole is placed such that the sum of the distances of
    its samples from the straight lines between their ends is least.

    Parameters
    ----------
    samples : SurfaceSamples
        Of the shape at rest.
    rest : (n, 3)
        Its vertices.
    poses : sequence of HingedPose
        One or more.
    shares : sequence of float
        Share of each pose, at least 0, with a sum of at most 1; rest has what is missing to 1.
    scale : float
        How much longer rigid parts are.
    stretch : float
        Share of what is not rigid that is kept. Joints are taken to lie that share of the way from the middle of two
        samples: one far off says that what lies between them is stretched.
    """
    start = rest[samples.seeds]
    total = sum(shares)
    parts = [share / total if total > 0 else 1.0 / len(shares) for share in shares]
    weights = sum(part * pose.weights for part, pose in zip(parts, poses, strict=True))
    joints = stretch * sum(part * pose.joints for part, pose in zip(parts, poses, strict=True))
    vectors = sum(share * pose.vectors for share, pose in zip(shares, poses, strict=True))
    stretches = stretch * sum(share * pose.stretches for share, pose in zip(shares, poses, strict=True))
    straight = (1.0 - total) * start + sum(share * pose.points for share, pose in zip(shares, poses, strict=True))
    one, other = samples.pairs.T
    half = 0.5 * (start[one] - start[other])
    turns = rotation_matrices(vectors)
    lines = scale * np.einsum("pij,pj->pi", turns[one], half - joints)
    lines += scale * np.einsum("pij,pj->pi", turns[other], half + joints)
    lines += np.einsum("pij,pj->pi", rotation_matrices(0.5 * (vectors[one] + vectors[other])), stretches)
    points = _laid_out(samples, lines, weights, straight)
    size = float(np.sqrt(samples.areas.sum()))
    points = points + _median(straight - points, samples.areas, _MEDIAN_WIDTH * size)
    shifts = points - scale * np.einsum("sij,sj->si", turns, start)
    blended = samples.blend @ np.concatenate([scale * turns.reshape(-1, 9), shifts], axis=1)
    return np.einsum("nij,nj->ni", blended[:, :9].reshape(-1, 3, 3), rest) + blended[:, 9:]


def _laid_out(
    samples: SurfaceSamples, lines: NDArray[np.float64], weights: NDArray[np.float64], straight: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return points, (s, 3), that are as far apart as the lines say, by weighted least squares."""
    one, other = samples.pairs.T
    count = len(samples.seeds)
    links = coo_array((weights, (one, other)), shape=(count, count)).toarray()
    links = links + links.T
    sums = links.sum(axis=1)
    hold = _HOLD * max(float(sums.mean()), np.finfo(float).tiny)
    right = hold * straight
    pulls = weights[:, None] * lines
    for axis in range(3):
        right[:, axis] += np.bincount(one, pulls[:, axis], count) - np.bincount(other, pulls[:, axis], count)
    return solve(np.diag(sums + hold) - links, right, assume_a="pos")


def _median(offsets: NDArray[np.float64], areas: NDArray[np.float64], width: float) -> NDArray[np.float64]:
    """Return the geometric median of offsets, (3,), smoothed over a width (E. Weiszfeld, 1937)."""
    middle = areas @ offsets / areas.sum()
    for _ in range(_MEDIAN_ROUNDS):
        pulls = areas / np.sqrt(np.square(offsets - middle).sum(axis=1) + width**2)
        middle = pulls @ offsets / pulls.sum()
    return middle
