# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Cross products, angles and rotations in the plane."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def plane_cross(one: NDArray[np.number], other: NDArray[np.number]) -> NDArray[np.number]:
    """Return the cross products, (...,), of vectors in the plane, (..., 2): positive if the second is to the left."""
    return one[..., 0] * other[..., 1] - one[..., 1] * other[..., 0]


def signed_angles(before: NDArray[np.float64], after: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the angles in radians, (...,), from some vectors, (..., 2), to others, positive to the left."""
    return np.arctan2(plane_cross(before, after), (before * after).sum(axis=-1))


def best_turn(points: NDArray[np.float64], others: NDArray[np.float64]) -> float:
    """Return the angle in radians of the rotation about the origin that brings points, (k, 2), closest to others."""
    return float(np.arctan2(plane_cross(points, others).sum(), (points * others).sum()))


def rotated(points: NDArray[np.float64], angle: float) -> NDArray[np.float64]:
    """Return points, (k, 2), rotated about the origin by an angle in radians."""
    cosine, sine = np.cos(angle), np.sin(angle)
    return points @ np.array([[cosine, sine], [-sine, cosine]])
