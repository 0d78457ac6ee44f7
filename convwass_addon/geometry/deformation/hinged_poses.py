# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Interpolate poses of a shape whose parts rotate relative to each other, about the joints between them.

Two rigid parts with rotations R_i and R_j share a point c, the joint, that both move to the same place; it is computed
from the final positions of the parts. In between, points x_i and x_j of the parts differ by
R_i (x_i - c) + R_j (c - x_j). Where parts are not rigid, the rest of that vector is interpolated linearly in the frame
that rotates with both. Surface-based interpolation does not do this: the skin of an armpit that is tight in one pose
would pull the arm into the shoulder.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve
from scipy.sparse import coo_array

from ..arrays.label_sums import label_sums
from ..meshes.surface_samples import SurfaceSamples
from .swing_twist import mean_turns, turn_matrices

# Rigidity is estimated from lines up to this fraction of the longest; a line with this strain has half the weight.
# Parts whose relative rotation is below the damping, in radians, do not determine a joint. The strain was measured
# (docs/performance, "Maps and registrations").
_NEAR, _STRAIN, _DAMPING = 0.3, 0.1, 0.1
# Lower limit of a sample's weight, so that every sample is constrained.
_LEAST_WEIGHT = 1e-3
# Weight of the straight line between a sample's ends, relative to that of the other constraints: it fixes samples that
# no line connects.
_HOLD = 1e-9
# Iterations of the geometric median, and its smoothing width relative to the size of the shape.
_MEDIAN_ROUNDS, _MEDIAN_WIDTH = 30, 2e-3


@dataclass(frozen=True)
class HingedPose:
    """A pose of a shape, described by the lines between its samples.

    Attributes
    ----------
    points : (s, 3) float64
        Positions of the samples.
    turns : (s, 3, 3) float64
        Rotations of their neighborhoods; see :mod:`.swing_twist`.
    joints : (p, 3) float64
        Joint of every pair at rest, relative to the midpoint of the pair.
    stretches : (p, 3) float64
        Non-rigid remainder of the line of every pair, in the rotating frame.
    weights : (p,) float64
        Weight of every pair.
    pairs : (p, 2) int64
        The samples of every pair.
    """

    points: NDArray[np.float64]
    turns: NDArray[np.float64]
    joints: NDArray[np.float64]
    stretches: NDArray[np.float64]
    weights: NDArray[np.float64]
    pairs: NDArray[np.int64]

    def __getstate__(self) -> dict[str, object]:
        # The system is not pickled, because it is quick to rebuild.
        return {name: value for name, value in vars(self).items() if name != "system"}

    @cached_property
    def system(self) -> _LineSystem:
        """The system for points between the shape at rest and this pose alone, whatever its share."""
        return _LineSystem.of(self.pairs, self.weights, len(self.points))

    @classmethod
    def of(
        cls,
        samples: SurfaceSamples,
        rest: NDArray[np.float64],
        moved: NDArray[np.float64],
        turns: NDArray[np.float64],
    ) -> HingedPose:
        """Find the joints between the parts of a shape.

        Parameters
        ----------
        samples : SurfaceSamples
            Samples of the shape at rest.
        rest, moved : (n, 3)
            Its vertices at rest and in the pose.
        turns : (n, 3, 3)
            Rotations of the vertices.
        """
        start, end, own = rest[samples.seeds], moved[samples.seeds], turns[samples.seeds]
        one, other = samples.pairs.T
        first, second = turn_matrices(own[one]), turn_matrices(own[other])
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
        between = turn_matrices(mean_turns(own, samples.pairs))
        stretches = np.einsum("pji,pj->pi", between, unexplained - np.einsum("pij,pj->pi", against, offsets))
        strain = np.square(stretches).sum(axis=1) / lengths**2
        reach = lengths.max(initial=0.0)
        falloff = np.square(1.0 - lengths / reach) * reach / lengths
        weights = both * falloff / np.square(1.0 + strain / _STRAIN**2)
        return cls(end, own, offsets, stretches, weights, samples.pairs)


def _rigidity(
    samples: SurfaceSamples, lengths: NDArray[np.float64], errors: Sequence[NDArray[np.float64]]
) -> NDArray[np.float64]:
    """Return how rigidly the neighborhood of every sample moves, 0 to 1, (s,), from line errors at both ends."""
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
    """Return the vertices between poses, (n, 3), as moved by locally rigid regions around the samples.

    The whole shape is translated to minimize the sum of distances of the samples from the straight lines between their
    ends, so that what is at rest in all poses stays at rest in between.

    Parameters
    ----------
    samples : SurfaceSamples
        Samples of the shape at rest.
    rest : (n, 3)
        Its vertices.
    poses : sequence of HingedPose
        One or more.
    shares : sequence of float
        Weight of each pose, nonnegative, with a sum of at most 1; the rest shape has the remaining weight.
    scale : float
        Scaling of rigid parts.
    stretch : float
        Fraction of the non-rigid remainder to keep. Offsets of joints are multiplied by it as well, because a distant
        joint indicates that the part between two samples is stretched.
    """
    start = rest[samples.seeds]
    total = sum(shares)
    parts = [share / total if total > 0 else 1.0 / len(shares) for share in shares]
    joints = stretch * sum(part * pose.joints for part, pose in zip(parts, poses, strict=True))
    turns = sum(share * pose.turns for share, pose in zip(shares, poses, strict=True))
    stretches = stretch * sum(share * pose.stretches for share, pose in zip(shares, poses, strict=True))
    straight = (1.0 - total) * start + sum(share * pose.points for share, pose in zip(shares, poses, strict=True))
    one, other = np.ascontiguousarray(samples.pairs.T)
    half = 0.5 * (start.take(one, axis=0) - start.take(other, axis=0))
    rotations = turn_matrices(turns)
    lines = scale * np.einsum("pij,pj->pi", rotations.take(one, axis=0), half - joints)
    lines += scale * np.einsum("pij,pj->pi", rotations.take(other, axis=0), half + joints)
    lines += np.einsum("pij,pj->pi", turn_matrices(mean_turns(turns, samples.pairs)), stretches)
    # Without lines, samples are only held where they are.
    points = _system(poses, parts).solved(lines, straight) if len(lines) else straight
    size = float(np.sqrt(samples.areas.sum()))
    points = points + _median(straight - points, samples.areas, _MEDIAN_WIDTH * size)
    shifts = points - scale * np.einsum("sij,sj->si", rotations, start)
    blended = samples.blend @ np.concatenate([scale * rotations.reshape(-1, 9), shifts], axis=1)
    return np.einsum("nij,nj->ni", blended[:, :9].reshape(-1, 3, 3), rest) + blended[:, 9:]


def _system(poses: Sequence[HingedPose], parts: Sequence[float]) -> _LineSystem:
    """Return the system for points between poses with these weights, of sum 1."""
    if len(poses) == 1:
        return poses[0].system
    weights = sum(part * pose.weights for part, pose in zip(parts, poses, strict=True))
    return _LineSystem.of(poses[0].pairs, weights, len(poses[0].points))


@dataclass(frozen=True)
class _LineSystem:
    """A linear system for points whose differences match lines, by weighted least squares.

    Attributes
    ----------
    pairs : (p, 2) int64
        The points that each line connects.
    weights : (p,) float64
        Weight of every line.
    hold : float
        Weight of the positions where points are held.
    factor : (s, s) float64
        The Cholesky factor of the matrix, in its lower half.
    """

    pairs: NDArray[np.int64]
    weights: NDArray[np.float64]
    hold: float
    factor: NDArray[np.float64]

    @classmethod
    def of(cls, pairs: NDArray[np.int64], weights: NDArray[np.float64], count: int) -> _LineSystem:
        """Factorize the system for `count` points."""
        one, other = pairs.T
        links = coo_array((weights, (one, other)), shape=(count, count)).toarray()
        links = links + links.T
        sums = links.sum(axis=1)
        hold = _HOLD * max(float(sums.mean()), np.finfo(float).tiny)
        return cls(pairs, weights, hold, cho_factor(np.diag(sums + hold) - links, lower=True)[0])

    def solved(self, lines: NDArray[np.float64], straight: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the points, (s, 3), with given lines, (p, 3), held at given positions, (s, 3)."""
        count, pulls = len(straight), self.weights[:, None] * lines
        one, other = self.pairs.T
        right = self.hold * straight
        right += label_sums(one, pulls, count) - label_sums(other, pulls, count)
        return cho_solve((self.factor, True), right)


def _median(offsets: NDArray[np.float64], areas: NDArray[np.float64], width: float) -> NDArray[np.float64]:
    """Return the geometric median of offsets, (3,), smoothed over a width (Weiszfeld's algorithm, 1937)."""
    middle = areas @ offsets / areas.sum()
    for _ in range(_MEDIAN_ROUNDS):
        pulls = areas / np.sqrt(np.square(offsets - middle).sum(axis=1) + width**2)
        middle = pulls @ offsets / pulls.sum()
    return middle
