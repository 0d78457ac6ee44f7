# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Limbs that swing about their joints."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from convwass_addon.geometry.meshes.mesh import TriangleMesh


@dataclass(frozen=True)
class PosedLimb:
    """A limb of a body that was sculpted in some pose.

    Attributes
    ----------
    mesh : TriangleMesh
        The body.
    joints : (n, 3) float64
        The joints of the limb, as for :class:`LimbPath`.
    """

    mesh: TriangleMesh
    joints: NDArray[np.float64]


@dataclass(frozen=True)
class LimbPath:
    """Joints of a limb at both ends of a morph, in scene units.

    Attributes
    ----------
    first, second : (n, 3) float64
        From a joint that only translates to the limb's tip.
    root : int
        Index of the joint that the limb's length is measured from.
    posed : callable or None
        Sculpts the body in the pose at t, whose limb has its full length; None if there is no such body.
    """

    first: NDArray[np.float64]
    second: NDArray[np.float64]
    root: int = 0
    posed: Callable[[float], PosedLimb] | None = None

    def at(self, t: float) -> NDArray[np.float64]:
        """Return the joints at t, (n, 3): segments rotate evenly about their joints, and lengths are interpolated."""
        points = [(1.0 - t) * self.first[0] + t * self.second[0]]
        for one, other in zip(np.diff(self.first, axis=0), np.diff(self.second, axis=0), strict=True):
            points.append(points[-1] + turned(one, other, t))
        return np.stack(points)


def turned(first: ArrayLike, second: ArrayLike, t: float) -> NDArray[np.float64]:
    """Rotate one vector evenly into another with interpolated length (spherical linear interpolation)."""
    lengths = np.array([np.linalg.norm(first), np.linalg.norm(second)])
    one, other = np.asarray(first) / lengths[0], np.asarray(second) / lengths[1]
    angle = np.arctan2(np.linalg.norm(np.cross(one, other)), one @ other)
    length = (1.0 - t) * lengths[0] + t * lengths[1]
    if angle < 1e-9:
        return length * one
    return length / np.sin(angle) * (np.sin((1.0 - t) * angle) * one + np.sin(t * angle) * other)
