# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Sea animals with many arms or with fins."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from assets.sculpting import both_sides, ellipsoid, ribbon, tube

from .sculptures import Sculpture

_ARM_RADII = (0.17, 0.145, 0.118, 0.098, 0.082, 0.068)
# Directions of the five segments of an octopus' arm in the arm's vertical plane, in degrees above the horizon.
CRAWLING = (-28.0, -28.0, 2.0, 24.0, 48.0)
RAISED = (8.0, 55.0, 82.0, 70.0, 20.0)
REACHING = (-10.0, 12.0, 22.0, 10.0, -8.0)


@dataclass(frozen=True)
class Creature:
    """A body and the tips of its arms, (k, 3)."""

    sculpture: Sculpture
    tips: NDArray[np.float64]


def octopus(arms: Sequence[tuple[float, ...]], turns: Sequence[float], seed: int) -> Creature:
    """Sculpt an octopus.

    Parameters
    ----------
    arms : sequence of 8 tuples
        Directions of the segments of every arm.
    turns : sequence of 8
        Sideways curl of every arm, in degrees.
    seed : int
        Seed of the mesh.
    """
    clay = Sculpture(seed)
    clay.add(ellipsoid((-0.10, 0, 1.02), (0.46, 0.38, 0.37), (-0.5, 0, 1)))
    clay.add(ellipsoid((0.06, 0, 0.54), (0.32, 0.32, 0.26)), 0.25)
    clay.add(both_sides(ellipsoid((0.25, 0.19, 0.76), (0.12, 0.12, 0.12))), 0.03)
    clay.carve(both_sides(ellipsoid((0.36, 0.25, 0.78), (0.05, 0.05, 0.06))), 0.02)
    tips = []
    for number, (angles, turn) in enumerate(zip(arms, turns, strict=True)):
        yaw = np.radians(22.5 + 45.0 * number)
        tips.append(octopus_arm(yaw, angles, turn)[-1])
        clay.add(tube(octopus_arm(yaw, angles, turn), _ARM_RADII, 4), 0.07)
    return Creature(clay, np.array(tips))


def octopus_arm(yaw: float, angles: Sequence[float], turn: float) -> NDArray[np.float64]:
    """Return the joints of an arm that starts in the direction `yaw` (radians), (6, 3); all arms have equal length."""
    point = np.array([0.12 * np.cos(yaw), 0.12 * np.sin(yaw), 0.44])
    points = [point]
    for number, angle in enumerate(np.radians(angles)):
        heading = yaw + np.radians(turn) * (number / 4.0) ** 2
        level = np.array([np.cos(heading), np.sin(heading), 0.0])
        length = (0.34, 0.27, 0.25, 0.22, 0.19)[number]
        points.append(points[-1] + length * (np.cos(angle) * level + np.array([0, 0, np.sin(angle)])))
    return np.stack(points)


def starfish(bends: Sequence[float], lifts: Sequence[float], seed: int) -> Creature:
    """Sculpt a starfish seen from the front (-Y), its five arms bent in and out of their plane, in degrees."""
    clay = Sculpture(seed)
    clay.add(ellipsoid((0, 0, 1.0), (0.20, 0.42, 0.42), (0, -1, 0)))
    tips = []
    for number, (bend, lift) in enumerate(zip(bends, lifts, strict=True)):
        angle = np.radians(90.0 + 72.0 * number)
        point = np.array([0.18 * np.cos(angle), 0.0, 1.0 + 0.18 * np.sin(angle)])
        points = [point]
        for step in range(4):
            heading, out = angle + np.radians(bend) * step / 3.0, np.radians(lift) * step / 3.0
            direction = [np.cos(heading) * np.cos(out), -np.sin(out), np.sin(heading) * np.cos(out)]
            points.append(points[-1] + 0.23 * np.array(direction))
        tips.append(points[-1])
        clay.add(tube(points, (0.21, 0.185, 0.15, 0.115, 0.075), 4), 0.12)
    for x in (-0.11, 0.11):
        clay.add(ellipsoid((x, -0.19, 1.12), (0.06, 0.06, 0.075), (0, -1, 0)), 0.012)
    return Creature(clay, np.array(tips))


def shark(seed: int) -> Sculpture:
    """Sculpt a shark swimming along +X."""
    clay = Sculpture(seed)
    body = [
        (-0.95, 0.06, 0.62),
        (-0.62, 0.02, 0.60),
        (-0.15, 0, 0.58),
        (0.35, 0, 0.58),
        (0.72, 0, 0.60),
        (1.0, 0, 0.63),
    ]
    clay.add(ribbon(body, [0.045, 0.10, 0.21, 0.24, 0.18, 0.07], [0.06, 0.12, 0.23, 0.25, 0.17, 0.06], (0, 1, 0)))
    for tip, lean in ((0.50, (-1.28, 0.08)), (-0.30, (-1.16, 0.08))):
        fin = [(-0.88, 0.05, 0.62), ((-0.93 + lean[0]) / 2, 0.07, 0.62 + 0.55 * tip), (lean[0], lean[1], 0.62 + tip)]
        clay.add(ribbon(fin, [0.045, 0.04, 0.03], [0.10, 0.085, 0.04], (0, 1, 0)), 0.03)
    dorsal = [(0.12, 0, 0.76), (0.02, 0, 0.96), (-0.12, 0, 1.12)]
    clay.add(ribbon(dorsal, [0.05, 0.042, 0.03], [0.19, 0.13, 0.05], (0, 1, 0)), 0.04)
    flipper = [(0.40, 0.14, 0.50), (0.26, 0.42, 0.38), (0.04, 0.66, 0.30)]
    clay.add(both_sides(ribbon(flipper, [0.15, 0.11, 0.05], [0.05, 0.042, 0.03], (1, -0.35, 0))), 0.04)
    rear = [(-0.36, 0.08, 0.50), (-0.46, 0.20, 0.42), (-0.56, 0.27, 0.37)]
    clay.add(both_sides(ribbon(rear, [0.08, 0.06, 0.035], [0.04, 0.035, 0.03], (1, -0.35, 0))), 0.03)
    clay.add(both_sides(ellipsoid((0.76, 0.15, 0.66), (0.035, 0.025, 0.035))), 0.01)
    mouth = [(0.86, 0, 0.50), (0.76, 0.10, 0.49), (0.64, 0.18, 0.52)]
    clay.carve(both_sides(tube(mouth, [0.02] * 3, 4)), 0.01)
    return clay
