# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a camera stands and what it frames."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

TURN = math.radians(28.0)
"""How far the camera stands beside the axis that it looks along: a three-quarter view shows depth."""


@dataclass(frozen=True)
class View:
    """Direction from which a camera looks, Z up.

    Attributes
    ----------
    azimuth : float
        Radians about Z from +X to where the camera stands.
    elevation : float
        Radians above the floor.
    """

    azimuth: float
    elevation: float

    @property
    def forward(self) -> np.ndarray:
        """Horizontal unit vector away from the camera, (3,)."""
        return np.array([-math.cos(self.azimuth), -math.sin(self.azimuth), 0.0])

    @property
    def axes(self) -> np.ndarray:
        """Right, up and backward of the camera as rows, world space, (3, 3)."""
        sine, cosine = math.sin(self.elevation), math.cos(self.elevation)
        right = np.array([-math.sin(self.azimuth), math.cos(self.azimuth), 0.0])
        backward = -cosine * self.forward + np.array([0.0, 0.0, sine])
        return np.array([right, np.cross(backward, right), backward])


@dataclass(frozen=True)
class Pose:
    """Place and direction of a camera, world space; `position` is (3,)."""

    position: np.ndarray
    view: View


def broad_view(points: Sequence[np.ndarray], elevation: float) -> View:
    """Return a three-quarter view onto the side where shapes are broad: the front (-Y) or the right (+X).

    Parameters
    ----------
    points : sequence of (n, 3) arrays
        Points of each shape, world space.
    elevation : float
        Radians above the floor.
    """
    extents = sum(np.ptp(shape[:, :2], axis=0) for shape in points)
    return View(-math.pi / 2 + TURN if extents[0] >= extents[1] else -TURN, elevation)


def orbit(points: np.ndarray, views: Sequence[View], tangents: tuple[float, float]) -> list[Pose]:
    """Walk a perspective camera around shapes, as close as it can with all points in each picture.

    Parameters
    ----------
    points : (n, 3) array
        World space.
    views : sequence of View
        Where the camera looks from, all from the same elevation.
    tangents : (float, float)
        Of half the opening angle that may be filled, across and upright.

    Returns
    -------
    list of Pose
        One per view; all look at the same point from the same distance.
    """
    aim = (points.min(axis=0) + points.max(axis=0)) / 2.0
    aim[2] += np.mean([_lift((points - aim) @ view.axes.T, tangents[1]) / view.axes[1, 2] for view in views])
    distance = max(_distance((points - aim) @ view.axes.T, tangents) for view in views)
    return [Pose(aim + distance * view.axes[2], view) for view in views]


def _lift(local: np.ndarray, tangent: float) -> float:
    """Return how far upwards a camera sees as much room above as below, if it stands as close as it can.

    The rays that bound the picture on both sides are each pushed outwards until they touch the points; they meet there.
    """
    up, backward = local[:, 1], local[:, 2]
    return float(np.max(up + tangent * backward) + np.min(up - tangent * backward)) / 2.0


def _distance(local: np.ndarray, tangents: tuple[float, float]) -> float:
    """Return how far from the origin a camera must stand to have all points, in its axes, in the picture."""
    return float(max(np.max(np.abs(local[:, axis]) / tangents[axis] + local[:, 2]) for axis in range(2)))
