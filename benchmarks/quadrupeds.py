# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Four-legged animals of any build in any pose, facing +X, with the joints of their legs and necks.

Angles are in degrees in the plane of symmetry: 0 points forward (+X), 90 up.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from assets.sculpting import both_sides, ellipsoid, ribbon, tube

from .sculptures import Sculpture

Point = NDArray[np.float64]
Angles = float | tuple["Angles", ...]
_ACROSS = (0, 1, 0)


@dataclass(frozen=True)
class Build:
    """Measures of an animal.

    Attributes
    ----------
    trunk, neck, head, tail, ear, horn : float
        Lengths; a horn of 0 means no horns.
    girth : tuple of float
        Radii of the trunk from hips to chest.
    neck_radii : (float, float)
        At the root and behind the head.
    muzzle : (float, float)
        Radii of the skull and of the muzzle.
    fore, hind : (float, float, float)
        Lengths of the upper segment, the lower one, and the foot.
    leg : (float, float, float)
        Radii at the root, in the middle and above the foot.
    stance : float
        Distance of the legs from the plane of symmetry.
    """

    trunk: float = 0.80
    neck: float = 0.34
    head: float = 0.36
    tail: float = 0.50
    ear: float = 0.19
    horn: float = 0.0
    girth: tuple[float, ...] = (0.15, 0.155, 0.16, 0.20, 0.19)
    neck_radii: tuple[float, float] = (0.14, 0.10)
    muzzle: tuple[float, float] = (0.125, 0.068)
    fore: tuple[float, float, float] = (0.36, 0.32, 0.10)
    hind: tuple[float, float, float] = (0.36, 0.38, 0.10)
    leg: tuple[float, float, float] = (0.12, 0.068, 0.05)
    stance: float = 0.115


@dataclass(frozen=True)
class Pose:
    """Angles in degrees; for legs, of the upper and the lower segment, left (y > 0) before right."""

    trunk: float = 0.0
    neck: float = 42.0
    head: float = -22.0
    fore: tuple[tuple[float, float], tuple[float, float]] = ((-95.0, -88.0), (-95.0, -88.0))
    hind: tuple[tuple[float, float], tuple[float, float]] = ((-72.0, -108.0), (-72.0, -108.0))
    tail: tuple[float, float] = (150.0, 110.0)

    def toward(self, other: Pose, t: float) -> Pose:
        """Return the pose at t from 0 to 1 on the way to another, in which all angles change evenly."""
        return Pose(*(_mean(getattr(self, own.name), getattr(other, own.name), t) for own in fields(self)))


def _mean(one: Angles, other: Angles, t: float) -> Angles:
    if isinstance(one, tuple):
        return tuple(_mean(own, its, t) for own, its in zip(one, other, strict=True))
    return (1.0 - t) * one + t * other


@dataclass(frozen=True)
class Quadruped:
    """An animal in a pose.

    Attributes
    ----------
    sculpture : Sculpture
        The solids of the body.
    hips : (3,) float64
        Center about which the trunk rotates.
    fore, hind : tuple of (3, 3) float64
        Root, knee and foot of each leg, left before right.
    neck : (3, 3) float64
        Root of the neck, nape and muzzle.
    """

    sculpture: Sculpture
    hips: Point
    fore: tuple[NDArray[np.float64], NDArray[np.float64]]
    hind: tuple[NDArray[np.float64], NDArray[np.float64]]
    neck: NDArray[np.float64]


def quadruped(build: Build, pose: Pose, seed: int) -> Quadruped:
    """Sculpt an animal whose lowest foot stands on z = 0."""
    clay = Sculpture(seed)
    body = headless(clay, build, pose)
    root = body.shoulders + 0.35 * build.girth[-1] * toward(pose.trunk + 90.0)
    return Quadruped(clay, body.hips, body.fore, body.hind, _add_neck(clay, build, root, pose))


@dataclass(frozen=True)
class Headless:
    """Joints of an animal without neck and head.

    Attributes
    ----------
    hips, shoulders : (3,) float64
        Ends of the spine.
    fore, hind : tuple of (3, 3) float64
        Root, knee and foot of each leg, left before right.
    """

    hips: Point
    shoulders: Point
    fore: tuple[NDArray[np.float64], NDArray[np.float64]]
    hind: tuple[NDArray[np.float64], NDArray[np.float64]]


def headless(clay: Sculpture, build: Build, pose: Pose) -> Headless:
    """Add the trunk, legs and tail of an animal whose lowest foot stands on z = 0."""
    hips = np.array([0.0, 0.0, _hip_height(build, pose)])
    along, over = toward(pose.trunk), toward(pose.trunk + 90.0)
    shares = np.linspace(0.0, 1.0, len(build.girth))
    spine = hips + np.outer(shares * build.trunk, along) + np.outer(0.03 * np.sin(np.pi * shares), over)
    clay.add(ribbon(spine, 0.92 * np.array(build.girth), build.girth, _ACROSS))
    shoulders = spine[-1]
    fore = tuple(
        _add_leg(clay, build, shoulders - 0.3 * build.girth[-1] * over, pose.fore[i], build.fore, side, 0.85)
        for i, side in enumerate((1.0, -1.0))
    )
    hind = tuple(
        _add_leg(clay, build, hips - 0.2 * build.girth[0] * over, pose.hind[i], build.hind, side, 1.0)
        for i, side in enumerate((1.0, -1.0))
    )
    _add_tail(clay, build, hips - 0.75 * build.girth[0] * along + 0.45 * build.girth[0] * over, pose)
    return Headless(hips, shoulders, fore, hind)


def toward(angle: float) -> Point:
    """Return the unit vector at an angle in degrees in the plane of symmetry."""
    return np.array([np.cos(np.radians(angle)), 0.0, np.sin(np.radians(angle))])


def _hip_height(build: Build, pose: Pose) -> float:
    """Return the height of the hips that puts the lowest foot on the floor."""
    over, along = toward(pose.trunk + 90.0), toward(pose.trunk)
    reaches = [_reach(build.hind, angles) - 0.2 * build.girth[0] * over[2] for angles in pose.hind]
    chest = build.trunk * along[2] - 0.3 * build.girth[-1] * over[2]
    reaches += [chest + _reach(build.fore, angles) for angles in pose.fore]
    return 0.6 * build.fore[2] - min(reaches)


def _reach(lengths: tuple[float, float, float], angles: tuple[float, float]) -> float:
    """Return the height of the foot relative to the root of the leg."""
    return sum(length * toward(angle)[2] for length, angle in zip(lengths, angles, strict=False))


def _add_leg(
    clay: Sculpture,
    build: Build,
    root: Point,
    angles: tuple[float, float],
    lengths: tuple[float, float, float],
    side: float,
    strength: float,
) -> NDArray[np.float64]:
    root = root + np.array((0.0, side * build.stance, 0.0))
    knee = root + lengths[0] * toward(angles[0])
    foot = knee + lengths[1] * toward(angles[1])
    wide, middle, thin = build.leg
    clay.add(tube([root, (root + knee) / 2, knee], [strength * wide, 0.8 * strength * wide, middle], 3), 0.07)
    clay.add(tube([knee, foot], [middle, thin], 1), 0.04)
    ahead = toward(angles[1] + 78.0)
    heel, toe = foot - 0.1 * lengths[2] * ahead, foot + 0.75 * lengths[2] * ahead
    below = 0.35 * lengths[2] * toward(angles[1])
    clay.add(ribbon([heel + below, toe + below], [1.25 * thin, 1.3 * thin], [0.85 * thin, 0.7 * thin], _ACROSS), 0.03)
    return np.stack([root, knee, foot + below])


def _add_neck(clay: Sculpture, build: Build, root: Point, pose: Pose) -> NDArray[np.float64]:
    nape = root + build.neck * toward(pose.neck)
    first, last = build.neck_radii
    clay.add(tube([root, (root + nape) / 2, nape], [first, (first + last) / 2, last], 3), 0.10)
    ahead, over = toward(pose.head), toward(pose.head + 90.0)
    skull, snout = build.muzzle
    middle = nape + 0.4 * build.head * ahead
    clay.add(ellipsoid(nape + 0.22 * build.head * ahead, (1.25 * skull, 0.95 * skull, skull), tuple(ahead)), 0.05)
    end = nape + (build.head - snout) * ahead - 0.25 * skull * over
    clay.add(tube([middle - 0.15 * skull * over, end], [0.72 * skull, snout], 1), 0.05)
    nose = end + 0.75 * snout * ahead + 0.35 * snout * over
    clay.add(ellipsoid(nose, (0.38 * snout, 0.5 * snout, 0.36 * snout), tuple(ahead)), 0.015)
    eye = nape + 0.42 * build.head * ahead + 0.52 * skull * over + np.array([0.0, 0.55 * skull, 0.0])
    clay.add(both_sides(ellipsoid(eye, (0.24 * skull, 0.2 * skull, 0.24 * skull), tuple(ahead))), 0.012)
    _add_ears(clay, build, nape, ahead, over)
    return np.stack([root, nape, end + snout * ahead])


def _add_ears(clay: Sculpture, build: Build, nape: Point, ahead: Point, over: Point) -> None:
    skull, aside = build.muzzle[0], np.array([0.0, 1.0, 0.0])
    base = nape + 0.1 * build.head * ahead + 0.7 * skull * over + 0.5 * skull * aside
    tip = base + build.ear * (0.75 * over + 0.5 * aside - 0.25 * ahead)
    width = 0.3 * build.ear
    clay.add(
        both_sides(
            ribbon(
                [base, (base + tip) / 2, tip],
                [width, 1.1 * width, 0.4 * width],
                [0.032, 0.032, 0.022],
                tuple(ahead + 0.3 * aside),
            )
        ),
        0.03,
    )
    if build.horn:
        root = nape + 0.26 * build.head * ahead + 0.8 * skull * over + 0.28 * skull * aside
        path = [
            root,
            root + build.horn * (0.5 * over + 0.05 * aside),
            root + build.horn * (0.8 * over - 0.45 * ahead + 0.15 * aside),
        ]
        clay.add(both_sides(tube(path, [0.045, 0.04, 0.024], 4)), 0.02)


def _add_tail(clay: Sculpture, build: Build, root: Point, pose: Pose) -> None:
    middle = root + build.tail / 2 * toward(pose.tail[0])
    tip = middle + build.tail / 2 * toward(pose.tail[1])
    clay.add(tube([root, middle, tip], [0.06, 0.046, 0.036], 4), 0.05)


DOG = Build()
GIRAFFE = Build(
    trunk=0.62,
    neck=0.86,
    head=0.32,
    tail=0.42,
    ear=0.15,
    horn=0.11,
    girth=(0.16, 0.165, 0.17, 0.20, 0.185),
    neck_radii=(0.125, 0.075),
    muzzle=(0.10, 0.062),
    fore=(0.44, 0.42, 0.09),
    hind=(0.40, 0.42, 0.09),
    leg=(0.105, 0.06, 0.048),
    stance=0.11,
)
GOAT = Build(
    trunk=0.72,
    neck=0.36,
    head=0.34,
    tail=0.20,
    ear=0.17,
    horn=0.34,
    girth=(0.185, 0.205, 0.225, 0.215, 0.175),
    neck_radii=(0.135, 0.09),
    muzzle=(0.11, 0.07),
    fore=(0.30, 0.28, 0.10),
    hind=(0.31, 0.30, 0.10),
    leg=(0.105, 0.062, 0.05),
    stance=0.125,
)

STANDING = Pose()
TROTTING = Pose(fore=((-62.0, -112.0), (-112.0, -106.0)), hind=((-92.0, -126.0), (-50.0, -88.0)))
"""Diagonal legs ahead and behind."""
REARING = Pose(
    trunk=58.0,
    neck=88.0,
    head=2.0,
    fore=((-8.0, -82.0), (18.0, -60.0)),
    hind=((-42.0, -118.0), (-42.0, -118.0)),
    tail=(200.0, 160.0),
)
"""On the hind legs, with the forelegs lifted."""
GRAZING = Pose(trunk=-6.0, neck=-50.0, head=-70.0, fore=((-104.0, -80.0), (-80.0, -96.0)), tail=(235.0, 262.0))
"""Head down."""
