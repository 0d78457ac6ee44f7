# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Animals with the upper body of a man in place of neck and head."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from assets.sculpting import both_sides, ellipsoid, ribbon, tube

from .quadrupeds import Build, Headless, Pose, headless, toward
from .sculptures import Sculpture

_ACROSS = (0, 1, 0)


@dataclass(frozen=True)
class Centaur:
    """A centaur in a pose.

    Attributes
    ----------
    sculpture : Sculpture
        The solids of the body.
    body : Headless
        Joints of the animal.
    """

    sculpture: Sculpture
    body: Headless


def centaur(build: Build, pose: Pose, seed: int) -> Centaur:
    """Sculpt a centaur whose lowest foot stands on z = 0."""
    clay = Sculpture(seed)
    body = headless(clay, build, pose)
    _add_upper_body(clay, body.shoulders + 0.1 * build.girth[-1] * toward(pose.trunk))
    return Centaur(clay, body)


def _add_upper_body(clay: Sculpture, root: NDArray[np.float64]) -> None:
    """Add a trunk that stands upright on the shoulders of the animal, two hanging arms and a head."""
    heights = np.array([-0.05, 0.14, 0.30, 0.46, 0.54])
    spine = root + np.outer(heights, (0.0, 0.0, 1.0))
    clay.add(ribbon(spine, [0.16, 0.145, 0.17, 0.18, 0.11], [0.15, 0.11, 0.12, 0.11, 0.08], _ACROSS), 0.08)
    head = root + np.array([0.02, 0.0, 0.78])
    clay.add(tube([spine[-1] - (0.0, 0.0, 0.05), head], [0.075, 0.075], 1), 0.06)
    clay.add(ellipsoid(head, (0.14, 0.125, 0.16), (1, 0, 0)), 0.03)
    clay.add(ellipsoid(head + np.array([0.15, 0.0, -0.02]), (0.035, 0.025, 0.03), (1, 0, 0)), 0.03)
    shoulder = root + np.array([0.0, 0.19, 0.44])
    elbow = shoulder + np.array([0.02, 0.12, -0.26])
    hand = elbow + np.array([0.13, 0.08, -0.22])
    clay.add(both_sides(tube([shoulder, elbow, hand], [0.075, 0.06, 0.05], 1)), 0.06)
    clay.add(both_sides(ellipsoid(hand, (0.09, 0.05, 0.05), (0.5, 0.3, -0.8))), 0.03)
