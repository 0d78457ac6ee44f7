# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Hands of any build with fingers spread, bent or together, seen from the palm (-Y), fingers up."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from assets.sculpting import ellipsoid, ribbon, tube

from .sculptures import Sculpture


@dataclass(frozen=True)
class Build:
    """Measures of a hand.

    Attributes
    ----------
    width, height, depth : float
        Half-width, height and half-depth of the palm.
    lengths, radii : tuple of float
        For each finger, starting next to the thumb.
    thumb : (float, float)
        Length and radius.
    """

    width: float = 0.36
    height: float = 0.80
    depth: float = 0.13
    lengths: tuple[float, ...] = (0.74, 0.84, 0.77, 0.60)
    radii: tuple[float, ...] = (0.095, 0.10, 0.095, 0.085)
    thumb: tuple[float, float] = (0.66, 0.11)


@dataclass(frozen=True)
class Gesture:
    """Angles in degrees, for each finger and finally the thumb.

    Attributes
    ----------
    spread : tuple of float
        Rotation of the finger in the plane of the palm, towards the thumb.
    bend : tuple of float
        Bend of every joint of the finger towards the front of the palm.
    """

    spread: tuple[float, ...]
    bend: tuple[float, ...]


@dataclass(frozen=True)
class Hand:
    """A hand with the joints of its fingers, (4, 3) each, the thumb last."""

    sculpture: Sculpture
    fingers: tuple[NDArray[np.float64], ...]


def hand(build: Build, gesture: Gesture, seed: int) -> Hand:
    """Sculpt a hand with its wrist at z = 0 and its thumb at x < 0."""
    clay = Sculpture(seed)
    wrist, top = 0.28, 0.28 + build.height
    palm = [(0, 0, 0.05), (0, 0, wrist), (0, 0, wrist + 0.4 * build.height), (0, 0, top - 0.08)]
    wide = [0.62 * build.width, 0.66 * build.width, 0.95 * build.width, build.width]
    clay.add(
        ribbon(palm, wide, [1.1 * build.depth, 1.05 * build.depth, 1.1 * build.depth, 0.9 * build.depth], (1, 0, 0))
    )
    clay.add(
        ellipsoid((-0.45 * build.width, -0.5 * build.depth, wrist + 0.35 * build.height), (0.2, 0.2, 0.28), (0, -1, 0)),
        0.12,
    )
    count = len(build.lengths)
    places = np.linspace(-1.0, 1.0, count) * (build.width - 0.8 * build.radii[0])
    fingers = []
    for i, (place, length, radius) in enumerate(zip(places, build.lengths, build.radii, strict=True)):
        arch = 0.10 * (1.0 - (place / build.width) ** 2)
        root = np.array([place, 0.0, top - 0.16 + arch])
        chain = _chain(root, length + 0.10, (0.46, 0.30, 0.24), gesture.spread[i], gesture.bend[i])
        clay.add(tube(chain, radius * np.array([1.05, 1.0, 0.94, 0.82]), 4), 0.045)
        fingers.append(chain)
    root = np.array([-0.62 * build.width, -0.3 * build.depth, wrist + 0.30 * build.height])
    chain = _chain(root, build.thumb[0], (0.42, 0.32, 0.26), gesture.spread[count], gesture.bend[count])
    clay.add(tube(chain, build.thumb[1] * np.array([1.25, 1.05, 1.0, 0.85]), 4), 0.07)
    fingers.append(chain)
    return Hand(clay, tuple(fingers))


def _chain(
    root: NDArray[np.float64], length: float, shares: tuple[float, ...], spread: float, bend: float
) -> NDArray[np.float64]:
    """Return the joints of a finger from root to tip: in the plane rotated by `spread`, bending towards -Y."""
    outward = np.array([-np.sin(np.radians(spread)), 0.0, np.cos(np.radians(spread))])
    points = [root]
    for number, share in enumerate(shares):
        turn = np.radians(bend * (number + (0.6 if number == 0 else 0.75)))
        direction = np.cos(turn) * outward + np.sin(turn) * np.array([0.0, -1.0, 0.0])
        points.append(points[-1] + share * length * direction)
    return np.stack(points)


HAND = Build()
GLOVE = Build(
    width=0.40, height=0.66, depth=0.19, lengths=(0.56, 0.62, 0.54), radii=(0.145, 0.15, 0.14), thumb=(0.58, 0.15)
)
"""Three thick fingers and a thumb."""

SPREAD = Gesture((20.0, 5.0, -9.0, -24.0, 52.0), (4.0,) * 5)
FIST = Gesture((3.0, 1.0, -1.0, -4.0, 30.0), (76.0, 78.0, 78.0, 76.0, 30.0))
BENT = Gesture((7.0, 2.0, -3.0, -8.0, 46.0), (2.0, 56.0, 58.0, 60.0, 12.0))
"""The forefinger points; the others are bent."""
GLOVE_OPEN = Gesture((16.0, 0.0, -17.0, 52.0), (4.0,) * 4)
GLOVE_BENT = Gesture((13.0, -6.0, -14.0, 48.0), (3.0, 3.0, 62.0, 8.0))
