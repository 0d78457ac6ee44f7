# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""People of any build in any pose, seen from the front (-Y), with the joints of their limbs.

Limb directions are angles in radians: `out` is the angle away from the body's middle plane, 0 for a limb that hangs
down, and `forward` turns the hanging limb to the front.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from assets.sculpting import ellipsoid, ribbon, tube

from .limb_paths import turned
from .sculptures import Sculpture

Point = NDArray[np.float64]


@dataclass(frozen=True)
class Build:
    """Measures of a body.

    Attributes
    ----------
    thigh, shin, spine, upper_arm, forearm, hand, foot, neck : float
        Lengths.
    head : (float, float, float)
        Radii in width, depth and height.
    shoulders, hips : float
        Distance of the joints from the middle plane.
    arm, leg : (float, float, float)
        Radii at the root, in the middle and at the end.
    widths, depths : tuple of float
        Half-widths and half-depths of the trunk from the pelvis to the root of the neck.
    """

    thigh: float = 0.46
    shin: float = 0.42
    spine: float = 0.58
    upper_arm: float = 0.34
    forearm: float = 0.30
    hand: float = 0.20
    foot: float = 0.24
    neck: float = 0.10
    head: tuple[float, float, float] = (0.15, 0.165, 0.19)
    shoulders: float = 0.215
    hips: float = 0.105
    arm: tuple[float, float, float] = (0.082, 0.066, 0.05)
    leg: tuple[float, float, float] = (0.118, 0.082, 0.06)
    widths: tuple[float, ...] = (0.19, 0.178, 0.168, 0.19, 0.20, 0.12)
    depths: tuple[float, ...] = (0.135, 0.115, 0.11, 0.135, 0.12, 0.08)


@dataclass(frozen=True)
class Direction:
    """Direction of a limb segment."""

    out: float = 0.0
    forward: float = 0.0

    def vector(self, side: float) -> Point:
        """Return the unit vector for the side x > 0 (1) or x < 0 (-1)."""
        down = np.cos(self.out)
        return np.array([side * np.sin(self.out), -down * np.sin(self.forward), -down * np.cos(self.forward)])

    def toward(self, other: Direction, t: float) -> Direction:
        """Return the direction that is rotated evenly towards another, at t from 0 to 1."""
        across, ahead, up = turned(self.vector(1.0), other.vector(1.0), t)
        return Direction(float(np.arcsin(across)), float(np.arctan2(-ahead, -up)))


def degrees(out: float = 0.0, forward: float = 0.0) -> Direction:
    """Return a direction from angles in degrees."""
    return Direction(np.radians(out), np.radians(forward))


@dataclass(frozen=True)
class Limb:
    """Directions of the upper and the lower segment."""

    upper: Direction
    lower: Direction

    def toward(self, other: Limb, t: float) -> Limb:
        """Return the limb whose segments are rotated evenly towards those of another, at t from 0 to 1."""
        return Limb(self.upper.toward(other.upper, t), self.lower.toward(other.lower, t))


def straight(direction: Direction) -> Limb:
    """Return a limb whose two segments have the same direction."""
    return Limb(direction, direction)


_HANGING = straight(degrees(out=20))
_STANDING = straight(degrees(out=3))


@dataclass(frozen=True)
class Posture:
    """Directions of the limbs, right (x > 0) before left; `toes` turns the feet up."""

    arms: tuple[Limb, Limb] = (_HANGING, _HANGING)
    legs: tuple[Limb, Limb] = (_STANDING, _STANDING)
    toes: tuple[float, float] = (0.0, 0.0)

    def toward(self, other: Posture, t: float) -> Posture:
        """Return the posture at t from 0 to 1 on the way to another, in which limbs rotate evenly."""
        limbs = (
            tuple(one.toward(two, t) for one, two in zip(mine, theirs, strict=True))
            for mine, theirs in ((self.arms, other.arms), (self.legs, other.legs))
        )
        toes = tuple((1.0 - t) * one + t * two for one, two in zip(self.toes, other.toes, strict=True))
        return Posture(*limbs, toes)


@dataclass(frozen=True)
class Biped:
    """A body in a posture.

    Attributes
    ----------
    sculpture : Sculpture
        The solids of the body.
    arms, legs : tuple of (4, 3) float64
        Shoulder, elbow, wrist and finger tip of each arm, right before left; hip, knee, ankle and sole of each leg.
    """

    sculpture: Sculpture
    arms: tuple[NDArray[np.float64], NDArray[np.float64]] = field(default=())
    legs: tuple[NDArray[np.float64], NDArray[np.float64]] = field(default=())


def biped(build: Build, posture: Posture, seed: int) -> Biped:
    """Sculpt a body whose lower foot stands on z = 0."""
    clay = Sculpture(seed)
    pelvis = np.array([0.0, 0.0, _pelvis_height(build, posture)])
    chest = pelvis + np.array((0.0, 0.0, build.spine))
    _add_trunk(clay, build, pelvis)
    _add_head(clay, build, chest)
    arms = tuple(_add_arm(clay, build, chest, posture.arms[i], side) for i, side in enumerate((1.0, -1.0)))
    legs = tuple(
        _add_leg(clay, build, pelvis, posture.legs[i], posture.toes[i], side) for i, side in enumerate((1.0, -1.0))
    )
    return Biped(clay, arms, legs)


def _pelvis_height(build: Build, posture: Posture) -> float:
    """Height of the hip joints above the sole of the lower foot."""
    drops = [-build.thigh * leg.upper.vector(1.0)[2] - build.shin * leg.lower.vector(1.0)[2] for leg in posture.legs]
    return max(drops) + _sole(build)


def _sole(build: Build) -> float:
    """Distance from the ankle to the sole."""
    return 1.25 * build.leg[2]


def _add_trunk(clay: Sculpture, build: Build, pelvis: Point) -> None:
    heights = np.linspace(-0.06, 1.0, len(build.widths)) * build.spine
    spine = pelvis + np.stack([0 * heights, 0 * heights, heights], axis=1)
    clay.add(ribbon(spine, build.widths, build.depths, (1, 0, 0)))
    ends = [
        pelvis + np.array([side * build.shoulders, 0.0, (0.93 - 0.03 * abs(side)) * build.spine])
        for side in (-1.0, 0.0, 1.0)
    ]
    clay.add(tube(ends, [0.85 * build.arm[0], build.arm[0], 0.85 * build.arm[0]]), 0.08)


def _add_head(clay: Sculpture, build: Build, chest: Point) -> None:
    across, deep, tall = build.head
    center = chest + np.array((0.0, -0.02, build.neck + 0.85 * tall))
    clay.add(tube([chest - (0, 0, 0.05), center], [0.55 * across] * 2, 1), 0.06)
    clay.add(ellipsoid(center, (deep, across, tall), (0, -1, 0)), 0.03)
    front = -0.88 * deep
    clay.add(
        ellipsoid(
            center + np.array((0, -0.5 * deep, -0.62 * tall)), (0.42 * deep, 0.52 * across, 0.3 * tall), (0, -1, 0)
        ),
        0.05,
    )
    nose = center + np.array((0, -1.05 * deep, -0.16 * tall))
    clay.add(ellipsoid(nose, (0.24 * deep, 0.16 * across, 0.16 * tall), (0, -1, 0)), 0.03)
    clay.carve(
        ellipsoid(
            center + np.array((0, -0.95 * deep, -0.58 * tall)), (0.08 * deep, 0.3 * across, 0.045 * tall), (0, -1, 0)
        ),
        0.02,
    )
    for side in (-1.0, 1.0):
        eye = center + np.array((side * 0.4 * across, front, 0.12 * tall))
        clay.add(ellipsoid(eye, (0.14 * deep, 0.22 * across, 0.17 * tall), (0, -1, 0)), 0.012)
        ear = center + np.array((side * 1.02 * across, 0.05 * deep, -0.02 * tall))
        clay.add(ellipsoid(ear, (0.22 * deep, 0.14 * across, 0.26 * tall), (0, -1, 0)), 0.02)


def _add_arm(clay: Sculpture, build: Build, chest: Point, limb: Limb, side: float) -> NDArray[np.float64]:
    shoulder = chest + np.array((side * build.shoulders, 0.0, -0.1 * build.spine))
    upper, lower = limb.upper.vector(side), limb.lower.vector(side)
    elbow = shoulder + build.upper_arm * upper
    wrist = elbow + build.forearm * lower
    clay.add(tube([shoulder, elbow], [build.arm[0], build.arm[1]], 1), 0.07)
    clay.add(tube([elbow, (2 * elbow + wrist) / 3, wrist], [build.arm[1], 1.05 * build.arm[1], build.arm[2]], 3), 0.03)
    tip = wrist + build.hand * lower
    _add_hand(clay, build, wrist, lower, side)
    return np.stack([shoulder, elbow, wrist, tip])


def _add_hand(clay: Sculpture, build: Build, wrist: Point, along: Point, side: float) -> None:
    """Add a mitten whose palm faces the body's middle plane, with the thumb in front."""
    front = np.array([0.0, -1.0, 0.0]) + along * along[1]
    front = front / np.linalg.norm(front) if np.linalg.norm(front) > 0.3 else np.array([0.0, 0.0, 1.0])
    size, thick = build.hand, build.arm[2]
    path = [wrist - 0.1 * size * along, wrist + 0.45 * size * along, wrist + 0.86 * size * along]
    clay.add(
        ribbon(path, [0.9 * thick, 0.42 * size, 0.22 * size], [0.8 * thick, 0.7 * thick, 0.5 * thick], front), 0.03
    )
    root = wrist + 0.25 * size * along + 0.25 * size * front
    thumb = root + 0.5 * size * (0.75 * front + 0.6 * along)
    clay.add(tube([root, thumb], [0.7 * thick, 0.5 * thick], 1), 0.03)


def _add_leg(clay: Sculpture, build: Build, pelvis: Point, limb: Limb, toes: float, side: float) -> NDArray[np.float64]:
    hip = pelvis + np.array((side * build.hips, 0.0, 0.0))
    knee = hip + build.thigh * limb.upper.vector(side)
    ankle = knee + build.shin * limb.lower.vector(side)
    clay.add(tube([hip, knee], [build.leg[0], build.leg[1]], 1), 0.05)
    clay.add(tube([knee, (2 * knee + ankle) / 3, ankle], [build.leg[1], 1.04 * build.leg[1], build.leg[2]], 3), 0.03)
    ahead = np.array([0.12 * side, -np.cos(toes), np.sin(toes)])
    down = np.array([0.0, -np.sin(toes), -np.cos(toes)])
    heel = ankle + 0.45 * _sole(build) * down - 0.15 * build.foot * ahead
    toe = heel + 0.82 * build.foot * ahead + 0.1 * _sole(build) * down
    clay.add(
        ribbon(
            [heel, (heel + toe) / 2, toe],
            [1.05 * build.leg[2], 1.2 * build.leg[2], 1.15 * build.leg[2]],
            [0.75 * build.leg[2], 0.7 * build.leg[2], 0.55 * build.leg[2]],
            (1, 0, 0),
        ),
        0.04,
    )
    return np.stack([hip, knee, ankle, ankle + _sole(build) * down])


MAN = Build()
OGRE = Build(
    thigh=0.30,
    shin=0.28,
    spine=0.80,
    upper_arm=0.40,
    forearm=0.42,
    hand=0.24,
    foot=0.27,
    neck=0.02,
    head=(0.16, 0.17, 0.17),
    shoulders=0.33,
    hips=0.17,
    arm=(0.118, 0.105, 0.085),
    leg=(0.16, 0.125, 0.10),
    widths=(0.29, 0.34, 0.36, 0.35, 0.32, 0.17),
    depths=(0.21, 0.28, 0.29, 0.23, 0.19, 0.11),
)
"""Short legs, long arms, a belly."""
CHILD = Build(
    thigh=0.30,
    shin=0.28,
    spine=0.50,
    upper_arm=0.24,
    forearm=0.22,
    hand=0.15,
    foot=0.22,
    neck=0.05,
    head=(0.24, 0.25, 0.27),
    shoulders=0.17,
    hips=0.10,
    arm=(0.075, 0.066, 0.056),
    leg=(0.105, 0.085, 0.068),
    widths=(0.17, 0.175, 0.17, 0.165, 0.16, 0.10),
    depths=(0.14, 0.15, 0.14, 0.13, 0.115, 0.08),
)
"""A large head on a small body."""
