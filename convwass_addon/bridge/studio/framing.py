# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Position and framing of cameras."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

TURN = math.radians(28.0)
"""Angle between the view direction and the nearest axis: a three-quarter view shows depth."""


@dataclass(frozen=True)
class View:
    """View direction of a camera, Z up.

    Attributes
    ----------
    azimuth : float
        Angle of the camera position around Z, from +X, in radians.
    elevation : float
        Angle above the floor in radians.
    """

    azimuth: float
    elevation: float

    @property
    def forward(self) -> np.ndarray:
        """Horizontal unit vector pointing away from the camera, (3,)."""
        return np.array([-math.cos(self.azimuth), -math.sin(self.azimuth), 0.0])

    @property
    def axes(self) -> np.ndarray:
        """Right, up and backward axes of the camera as rows, world space, (3, 3)."""
        sine, cosine = math.sin(self.elevation), math.cos(self.elevation)
        right = np.array([-math.sin(self.azimuth), math.cos(self.azimuth), 0.0])
        backward = -cosine * self.forward + np.array([0.0, 0.0, sine])
        return np.array([right, np.cross(backward, right), backward])


@dataclass(frozen=True)
class Pose:
    """Position and direction of a camera, world space; `position` is (3,)."""

    position: np.ndarray
    view: View


def broad_view(points: Sequence[np.ndarray], elevation: float) -> View:
    """Return a three-quarter view of the broader side of shapes: the front (-Y) or the right (+X).

    Parameters
    ----------
    points : sequence of (n, 3) arrays
        Points of each shape, world space.
    elevation : float
        Angle above the floor in radians.
    """
    extents = sum(np.ptp(shape[:, :2], axis=0) for shape in points)
    return View(-math.pi / 2 + TURN if extents[0] >= extents[1] else -TURN, elevation)


def orbit(points: np.ndarray, views: Sequence[View], tangents: tuple[float, float]) -> list[Pose]:
    """Place a perspective camera around shapes, as close as possible with all points in every picture.

    Parameters
    ----------
    points : (n, 3) array
        World space.
    views : sequence of View
        View directions, all with the same elevation.
    tangents : (float, float)
        Tangents of half the usable opening angle, horizontal and vertical.

    Returns
    -------
    list of Pose
        One per view, with the same target and distance.
    """
    aim = (points.min(axis=0) + points.max(axis=0)) / 2.0
    aim[2] += np.mean([_lift((points - aim) @ view.axes.T, tangents[1]) / view.axes[1, 2] for view in views])
    distance = max(_distance((points - aim) @ view.axes.T, tangents) for view in views)
    return [Pose(aim + distance * view.axes[2], view) for view in views]


def _lift(local: np.ndarray, tangent: float) -> float:
    """Return how far the camera moves up to have equal margins above and below at the smallest distance.

    The bounding rays of the picture are moved outwards until they touch the points; they meet at the camera.
    """
    up, backward = local[:, 1], local[:, 2]
    return float(np.max(up + tangent * backward) + np.min(up - tangent * backward)) / 2.0


def _distance(local: np.ndarray, tangents: tuple[float, float]) -> float:
    """Return the smallest distance from the origin at which all points, in camera axes, are in the picture."""
    return float(max(np.max(np.abs(local[:, axis]) / tangents[axis] + local[:, 2]) for axis in range(2)))
