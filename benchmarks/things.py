# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Furniture, plants, machines, signs and ropes."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from assets.sculpting import both_sides, ellipsoid, extruded, frustum, ribbon, tube

from .sculptures import Sculpture

_ACROSS = (0, 1, 0)


def chair(seed: int) -> Sculpture:
    """Sculpt a chair, its front towards -Y: four legs, a seat, and a back between two posts."""
    clay = Sculpture(seed)
    half, seat = 0.40, 0.86
    clay.add(ribbon([(0, -half, seat), (0, 0, seat), (0, half, seat)], [half] * 3, [0.075] * 3, (1, 0, 0)))
    for x in (-0.34, 0.34):
        clay.add(tube([(x, -0.34, seat), (1.12 * x, -0.40, 0.05)], [0.075, 0.058], 1), 0.05)
        clay.add(tube([(x, 0.36, seat), (1.12 * x, 0.46, 0.05)], [0.075, 0.058], 1), 0.05)
        clay.add(tube([(x, 0.38, seat), (x, 0.46, 1.45), (x, 0.54, 1.92)], [0.075, 0.07, 0.062], 4), 0.05)
    clay.add(
        ribbon([(-0.34, 0.53, 1.74), (0, 0.57, 1.78), (0.34, 0.53, 1.74)], [0.15] * 3, [0.055] * 3, (0, 0.15, 1)), 0.03
    )
    clay.add(
        ribbon([(-0.34, 0.46, 1.32), (0, 0.50, 1.34), (0.34, 0.46, 1.32)], [0.09] * 3, [0.05] * 3, (0, 0.15, 1)), 0.03
    )
    return clay


def table(seed: int) -> Sculpture:
    """Sculpt a long table on four legs, with a rail between the two legs at either end."""
    clay = Sculpture(seed)
    clay.add(ribbon([(-0.78, 0, 1.0), (0, 0, 1.0), (0.78, 0, 1.0)], [0.42] * 3, [0.075] * 3, _ACROSS))
    for x in (-0.68, 0.68):
        for y in (-0.28, 0.28):
            clay.add(tube([(x, y, 1.0), (x, y, 0.62), (1.06 * x, 1.1 * y, 0.06)], [0.085, 0.075, 0.062], 4), 0.06)
        clay.add(tube([(1.02 * x, -0.28, 0.36), (1.02 * x, 0.28, 0.36)], [0.052, 0.052], 1), 0.03)
    return clay


def cactus(seed: int) -> Sculpture:
    """Sculpt a cactus with two arms, seen from the front."""
    clay = Sculpture(seed)
    clay.add(tube([(0, 0, 0.30), (0, 0, 0.9), (0, 0, 1.5), (0, 0, 1.9)], [0.20, 0.225, 0.215, 0.19], 4))
    clay.add(
        tube([(0, 0, 0.95), (0.40, 0, 0.92), (0.52, 0, 1.15), (0.54, 0, 1.52)], [0.13, 0.13, 0.13, 0.115], 6), 0.05
    )
    clay.add(
        tube([(0, 0, 0.72), (-0.36, 0, 0.70), (-0.46, 0, 0.90), (-0.47, 0, 1.20)], [0.12, 0.12, 0.12, 0.105], 6), 0.05
    )
    clay.add(frustum((0, 0, 0.42), (0, 0, 0.0), (0.40, 0.30), 0.04), 0.02)
    return clay


def mug(seed: int) -> Sculpture:
    """Sculpt a mug with its handle towards +X."""
    clay = Sculpture(seed)
    clay.add(frustum((0, 0, 0), (0, 0, 1.0), (0.42, 0.42), 0.03))
    clay.carve(frustum((0, 0, 0.08), (0, 0, 1.2), (0.34, 0.34), 0.02))
    clay.add(tube([(0.4, 0, 0.8), (0.7, 0, 0.75), (0.75, 0, 0.45), (0.4, 0, 0.22)], [0.06] * 4, 8), 0.02)
    return clay


def trophy(seed: int) -> Sculpture:
    """Sculpt a cup on a stem, with two handles."""
    clay = Sculpture(seed)
    clay.add(frustum((0, 0, 0), (0, 0, 0.15), (0.35, 0.3), 0.03))
    clay.add(tube([(0, 0, 0.1), (0, 0, 0.6)], [0.08, 0.07], 1), 0.05)
    clay.add(frustum((0, 0, 0.55), (0, 0, 1.3), (0.15, 0.5), 0.05), 0.05)
    clay.carve(frustum((0, 0, 0.7), (0, 0, 1.4), (0.1, 0.47), 0.05))
    for x in (-1, 1):
        handle = [(0.42 * x, 0, 1.2), (0.75 * x, 0, 1.2), (0.7 * x, 0, 0.85), (0.28 * x, 0, 0.75)]
        clay.add(tube(handle, [0.05] * 4, 8), 0.02)
    return clay


def airplane(seed: int) -> Sculpture:
    """Sculpt an airplane flying along +X."""
    clay = Sculpture(seed)
    clay.add(
        tube(
            [(-0.92, 0, 0.68), (-0.5, 0, 0.60), (0.1, 0, 0.56), (0.6, 0, 0.56), (0.93, 0, 0.55)],
            [0.06, 0.13, 0.175, 0.17, 0.09],
        )
    )
    clay.add(
        both_sides(
            ribbon(
                [(0.22, 0.05, 0.48), (0.05, 0.55, 0.52), (-0.14, 1.0, 0.57)],
                [0.25, 0.16, 0.09],
                [0.062, 0.05, 0.04],
                (1, 0, 0),
            )
        ),
        0.05,
    )
    clay.add(
        both_sides(ribbon([(-0.82, 0.02, 0.68), (-0.93, 0.36, 0.71)], [0.13, 0.08], [0.045, 0.038], (1, 0, 0))), 0.03
    )
    clay.add(
        ribbon(
            [(-0.76, 0, 0.72), (-0.88, 0, 0.92), (-0.98, 0, 1.08)], [0.04, 0.038, 0.034], [0.15, 0.11, 0.075], _ACROSS
        ),
        0.03,
    )
    for y in (-0.42, 0.42):
        clay.add(tube([(0.30, y, 0.39), (0.02, y, 0.39)], [0.075, 0.062], 1), 0.03)
    clay.add(ellipsoid((0.62, 0, 0.69), (0.16, 0.10, 0.09)), 0.02)
    return clay


def star(seed: int) -> Sculpture:
    """Sculpt a thick five-pointed star, seen from the front."""
    clay = Sculpture(seed)
    angles = np.pi / 2 + 2 * np.pi * np.arange(5) / 5
    strokes = [tube([(0, 0, 1), (0.86 * np.cos(a), 0, 1 + 0.86 * np.sin(a))], [0.36, 0.05], 1) for a in angles]
    clay.add(extruded(strokes, 0.22, 0.06, 0.03))
    return clay


def cross(seed: int) -> Sculpture:
    """Sculpt a thick plus sign, seen from the front."""
    clay = Sculpture(seed)
    strokes = [tube([(-0.7, 0, 1), (0.7, 0, 1)], [0.24] * 2, 1), tube([(0, 0, 0.3), (0, 0, 1.7)], [0.24] * 2, 1)]
    clay.add(extruded(strokes, 0.22, 0.06, 0.03))
    return clay


def ball(seed: int) -> Sculpture:
    """Sculpt a ball."""
    clay = Sculpture(seed)
    clay.add(ellipsoid((0, 0, 0.8), (0.8, 0.8, 0.8)))
    return clay


def two_balls(seed: int) -> Sculpture:
    """Sculpt two separate balls that have the volume of `ball` together."""
    clay = Sculpture(seed)
    for x in (-1.0, 1.0):
        clay.add(ellipsoid((x, 0, 0.635), (0.635, 0.635, 0.635)))
    return clay


def ring(seed: int) -> Sculpture:
    """Sculpt a lying ring with the volume of `ball`."""
    clay = Sculpture(seed)
    turns = np.linspace(0.0, 2.0 * np.pi, 48, endpoint=False)
    middle = np.stack([1.1 * np.cos(turns), 1.1 * np.sin(turns), np.full(len(turns), 0.31)], axis=1)
    clay.add(tube(middle, [0.31] * len(turns), 1, closed=True))
    return clay


def coil(seed: int) -> Sculpture:
    """Sculpt a rope that is coiled up flat, seen from the front."""
    turns = np.linspace(1.2, 1.2 + 5.0 * np.pi, 90)
    radii = np.linspace(0.22, 0.95, len(turns))
    return _rope(seed, [radii * np.cos(turns), np.zeros(len(turns)), 1.05 + radii * np.sin(turns)], 0.1)


def spring(seed: int) -> Sculpture:
    """Sculpt an upright spring of four turns."""
    turns = np.linspace(0.0, 8.0 * np.pi, 120)
    return _rope(seed, [0.45 * np.cos(turns), 0.45 * np.sin(turns), np.linspace(0.1, 1.9, len(turns))], 0.1)


def rod(seed: int) -> Sculpture:
    """Sculpt an upright rod."""
    heights = np.linspace(0.13, 3.4, 12)
    return _rope(seed, [0.0 * heights, 0.0 * heights, heights], 0.13)


def snake(seed: int) -> Sculpture:
    """Sculpt a snake that lies on the floor and winds along X, its head at the left."""
    along = np.linspace(0.0, 1.0, 60)
    return _rope(seed, [3.2 * along - 1.6, 0.4 * np.sin(4.0 * np.pi * along), 0.0 * along + 0.14], 0.14 - 0.1 * along)


def _rope(seed: int, line: ArrayLike, radius: ArrayLike) -> Sculpture:
    clay, points = Sculpture(seed), np.transpose(line)
    clay.add(tube(points, np.broadcast_to(radius, len(points)), 1))
    return clay
