# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames that move with the sun, and sampling of sky pictures in any direction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates

from .sky_images import great_circle, padded

# If the paths' frames differ by a larger twist, they are not rotated upright, because the path passes the zenith.
_MOST_TWIST = np.pi / 2


@dataclass(frozen=True)
class SunWay:
    """The path of a sun with a moving frame, whose X axis points to the sun and whose Z axis is upright at both ends.

    Attributes
    ----------
    first, second : (3,) float64
        Unit vectors to the sun at the two ends.
    twist : float
        Angle in radians between the parallel-transported frame and the upright one at the second end.
    """

    first: NDArray[np.float64]
    second: NDArray[np.float64]
    twist: float

    @classmethod
    def between(cls, first: NDArray[np.float64], second: NDArray[np.float64]) -> SunWay:
        """Create the path along the great circle; without twist where that would turn the frame over."""
        carried = cls(first, second, 0.0).frame(1.0)
        y, z = carried[:, 1:].T
        up = _upright(second)[:, 2]
        twist = float(np.arctan2(-(up @ y), up @ z))
        return cls(first, second, twist if abs(twist) <= _MOST_TWIST else 0.0)

    def frame(self, time: float) -> NDArray[np.float64]:
        """Return the axes at a time in [0, 1] as the columns of a matrix, (3, 3)."""
        # Split in two halves, because transport to the opposite direction is undefined.
        middle, place = (great_circle(self.first, self.second, part) for part in (0.5 * time, time))
        x, y, z = (_rotated(_rotated(axis, self.first, middle), middle, place) for axis in _upright(self.first).T)
        cosine, sine = np.cos(time * self.twist), np.sin(time * self.twist)
        return np.stack([x, cosine * y + sine * z, cosine * z - sine * y], axis=1)


def _upright(direction: NDArray[np.float64]) -> NDArray[np.float64]:
    """Axes, as columns, with X in the given direction and Z as close to upright as possible."""
    up = np.array([0.0, 0.0, 1.0]) if abs(direction[2]) < 1.0 - 1e-9 else np.array([1.0, 0.0, 0.0])
    z = up - (up @ direction) * direction
    z /= np.linalg.norm(z)
    return np.stack([direction, np.cross(z, direction), z], axis=1)


def _rotated(axis: NDArray[np.float64], first: NDArray[np.float64], place: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rotate an axis by the shortest rotation from one unit vector to another.

    That rotation consists of two reflections, in the planes normal to `first` and to the bisector of both.
    """
    middle = first + place
    mirrored = axis - 2.0 * (axis @ first) * first
    return mirrored - 2.0 * (mirrored @ middle) / (middle @ middle) * middle


def seen_in(image: NDArray[np.float64], vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Sample a picture, (rows, 2 rows, channels), in any directions, (..., 3), with linear interpolation."""
    rows, columns = image.shape[:2]
    theta = np.arctan2(np.hypot(vectors[..., 0], vectors[..., 1]), vectors[..., 2])
    phi = np.arctan2(vectors[..., 1], vectors[..., 0]) % (2.0 * np.pi)
    places = np.stack([theta * (rows / np.pi) + 1.5, phi * (columns / (2.0 * np.pi)) + 1.5])
    channels = np.moveaxis(image, -1, 0)
    return np.stack([map_coordinates(padded(channel, 2), places, order=1) for channel in channels], axis=-1)
