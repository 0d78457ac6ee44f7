# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A body on thin legs and its images under linear maps, between which all blends are known exactly.

The optimal map between a solid and its image under a symmetric positive definite matrix plus a translation is that map
itself, because it is the gradient of a convex function (Brenier 1991). So the blend at t is the image under
(1 - t) I + t S.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

RADIUS = 1.5
"""Radius of the legs in cells."""

_BODY = np.array([0.0, 0.0, 8.0])
_BODY_RADIUS = 10.0
# Four legs from inside the body downward: start and end of each.
_LEGS = np.array(
    [
        [[5.0, 4.0, 6.0], [5.0, 4.0, -18.0]],
        [[5.0, -4.0, 6.0], [5.0, -4.0, -18.0]],
        [[-5.0, 4.0, 6.0], [-5.0, 4.0, -18.0]],
        [[-5.0, -4.0, 6.0], [-5.0, -4.0, -18.0]],
    ]
)
# Only parts of legs at least this far from the body, in cells, count as thin.
_CLEAR = 1.0


@dataclass(frozen=True)
class Legged:
    """The body on legs, scaled along the axes about `center`, in cells."""

    center: NDArray[np.float64]
    stretch: NDArray[np.float64]

    @classmethod
    def at(cls, center: ArrayLike, stretch: ArrayLike = (1.0, 1.0, 1.0)) -> Legged:
        """Make one from array-likes of three numbers."""
        return cls(np.asarray(center, np.float64), np.asarray(stretch, np.float64))

    def barycenter(self, other: Legged, t: float) -> Legged:
        """Return the exact blend."""
        return Legged(
            (1 - t) * self.center + t * other.center,
            (1 - t) * self.stretch + t * other.stretch,
        )

    def occupancy(self, cells: int, samples: int = 4) -> NDArray[np.float64]:
        """Return the filled fraction of every cell of a cubic grid, by subsampling."""
        inside = np.zeros((cells,) * 3)
        box = tuple(slice(int(low), int(high) + 1) for low, high in zip(*self.bounds, strict=True))
        axes = [
            (np.arange(span.start * samples, span.stop * samples, dtype=np.float32) + 0.5) / samples for span in box
        ]
        hit = self._holds(np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1))
        split = [size for span in box for size in (span.stop - span.start, samples)]
        inside[box] = hit.reshape(split).mean(axis=(1, 3, 5))
        return inside

    @property
    def bounds(self) -> NDArray[np.float64]:
        """Smallest and largest coordinates, (2, 3)."""
        low = np.minimum(_LEGS.min(axis=(0, 1)) - RADIUS, _BODY - _BODY_RADIUS)
        high = np.maximum(_LEGS.max(axis=(0, 1)) + RADIUS, _BODY + _BODY_RADIUS)
        return self.center + self.stretch * np.stack([low, high])

    def thin_points(self, count: int = 10000) -> NDArray[np.float64]:
        """Return uniformly distributed points in the thin parts, (n, 3), with a fixed random seed."""
        draw = np.random.default_rng(0)
        low, high = _LEGS.min(axis=(0, 1)) - RADIUS, _LEGS.max(axis=(0, 1)) + RADIUS
        # About one point in twenty of the bounding box lies in a leg.
        points = draw.uniform(low, high, (20 * count, 3))
        thin = _in_legs(points) & (np.linalg.norm(points - _BODY, axis=-1) > _BODY_RADIUS + _CLEAR)
        return self.center + self.stretch * points[thin][:count]

    def _holds(self, points: NDArray[np.floating]) -> NDArray[np.bool_]:
        own = (points - self.center.astype(points.dtype)) / self.stretch.astype(points.dtype)
        hit = ((own - _BODY.astype(points.dtype)) ** 2).sum(-1) <= _BODY_RADIUS**2
        near = (own[..., 2] <= _LEGS[..., 2].max() + RADIUS) & (own[..., 2] >= _LEGS[..., 2].min() - RADIUS)
        near &= ~hit
        hit[near] = _in_legs(own[near])
        return hit


def _in_legs(points: NDArray[np.floating]) -> NDArray[np.bool_]:
    """Tell which points are inside a leg, a rod with round ends."""
    hit = np.zeros(points.shape[:-1], bool)
    for start, end in _LEGS.astype(points.dtype):
        along = end - start
        share = np.clip((points - start) @ along / (along @ along), 0.0, 1.0)
        hit |= ((points - start - share[..., None] * along) ** 2).sum(-1) <= RADIUS**2
    return hit
