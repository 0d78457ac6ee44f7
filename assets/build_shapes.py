# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Sculpt the sample shapes and write them to assets/shapes as binary PLY, one also with a texture.

    PYTHONPATH=. python assets/build_shapes.py [name ...]

Needs bpy, numpy, scipy and scikit-image. Every shape is a closed surface that stands on z = 0 and is 2 units long at
its longest, except that two poses of one body have the same scale; animals face +X, people face -Y, from where
letters are readable. The shapes are dedicated to the public domain
(CC0 1.0), see README.md in this folder.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np

from assets.sculpting import Clay, Solid, both_sides, ellipsoid, extruded, frustum, ribbon, spline, tube
from assets.texturing import write_textured
from benchmarks.bipeds import MAN, Posture, biped, degrees, straight
from benchmarks.quadrupeds import DOG, REARING, STANDING, quadruped
from benchmarks.sculptures import Sculpture

FOLDER = Path(__file__).parent / "shapes"
LONGEST_SIDE = 2.0

Y_AXIS = (0, 1, 0)


def horse() -> Clay:
    """Sculpt a prancing horse: one foreleg raised, neck arched, mane and tail flowing."""
    clay = Clay((-1.4, -0.45, -0.05), (1.25, 0.45, 2.25), 0.014)
    trunk = [(-0.52, 0, 1.2), (-0.3, 0, 1.19), (0.0, 0, 1.13), (0.3, 0, 1.13), (0.48, 0, 1.19)]
    clay.add(ribbon(trunk, [0.2, 0.235, 0.235, 0.225, 0.18], [0.23, 0.245, 0.235, 0.28, 0.24], Y_AXIS))
    clay.add(both_sides(ellipsoid((-0.48, 0.1, 1.17), (0.2, 0.14, 0.27), (1, 0, 0.5))), 0.12)
    clay.add(both_sides(ellipsoid((0.41, 0.1, 1.13), (0.16, 0.13, 0.27), (1, 0, -0.35))), 0.12)
    neck = [(0.38, 0, 1.25), (0.56, 0, 1.46), (0.65, 0, 1.68), (0.76, 0, 1.85)]
    clay.add(ribbon(neck, [0.17, 0.13, 0.1, 0.09], [0.27, 0.21, 0.15, 0.11], Y_AXIS), 0.14)
    add_horse_head(clay)

    standing_fore = [
        (0.42, 0.13, 1.02),
        (0.42, 0.14, 0.76),
        (0.45, 0.14, 0.49),
        (0.445, 0.14, 0.31),
        (0.45, 0.14, 0.16),
    ]
    raised_fore = [
        (0.44, -0.13, 1.02),
        (0.56, -0.14, 0.8),
        (0.81, -0.14, 0.73),
        (0.77, -0.14, 0.56),
        (0.69, -0.14, 0.44),
    ]
    left_hind = [(-0.45, 0.13, 1.08), (-0.36, 0.15, 0.8), (-0.56, 0.15, 0.53), (-0.52, 0.15, 0.33), (-0.49, 0.15, 0.16)]
    right_hind = [
        (-0.47, -0.13, 1.08),
        (-0.46, -0.15, 0.8),
        (-0.72, -0.15, 0.56),
        (-0.73, -0.15, 0.35),
        (-0.73, -0.15, 0.16),
    ]
    fore_radii, hind_radii = [0.14, 0.102, 0.08, 0.06, 0.07], [0.2, 0.137, 0.083, 0.061, 0.071]
    forward, tucked = np.array([0.38, 0, -0.92]), np.array([-0.85, 0, -0.53])
    for path, radii, pastern in (
        (standing_fore, fore_radii, forward),
        (raised_fore, fore_radii, tucked),
        (left_hind, hind_radii, forward),
        (right_hind, hind_radii, forward),
    ):
        clay.add(tube(path, radii), 0.1)
        fetlock = np.array(path[-1])
        sole = fetlock + 0.16 / 0.92 * pastern
        down = (0, 0, -1) if pastern is forward else pastern
        clay.add(tube([fetlock, sole - np.multiply(0.1, down)], [0.066, 0.066], 1), 0.03)
        clay.add(frustum(sole - np.multiply(0.115, down), sole, (0.07, 0.1), 0.022), 0.02)

    tail_root = (-0.64, 0, 1.3)
    for path, radii in (
        (
            [tail_root, (-0.8, 0, 1.4), (-0.94, 0, 1.32), (-1.01, 0, 1.12), (-1.05, 0, 0.9), (-1.16, 0, 0.77)],
            [0.09, 0.09, 0.1, 0.1, 0.09, 0.05],
        ),
        (
            [tail_root, (-0.78, 0, 1.36), (-0.89, 0, 1.24), (-0.94, 0, 1.02), (-0.97, 0, 0.79), (-1.08, 0, 0.63)],
            [0.09, 0.1, 0.1, 0.105, 0.095, 0.05],
        ),
        (
            [tail_root, (-0.76, 0, 1.32), (-0.84, 0, 1.18), (-0.87, 0, 0.96), (-0.89, 0, 0.74), (-0.99, 0, 0.54)],
            [0.09, 0.09, 0.08, 0.085, 0.08, 0.05],
        ),
    ):
        clay.add(ribbon(path, radii, np.multiply(radii, 0.95), (1, 0, 0.4)), 0.025)
    return clay


def add_horse_head(clay: Clay) -> None:
    """Add head, ears, forelock and mane of the horse."""
    head = [(0.77, 0, 1.84), (0.87, 0, 1.74), (0.98, 0, 1.59), (1.06, 0, 1.49)]
    clay.add(ribbon(head, [0.095, 0.098, 0.07, 0.076], [0.11, 0.125, 0.085, 0.08], Y_AXIS), 0.06)
    clay.add(both_sides(ellipsoid((0.82, 0.055, 1.71), (0.11, 0.055, 0.09), (1, 0, -1.2))), 0.03)
    clay.add(both_sides(ellipsoid((0.905, 0.088, 1.762), (0.034, 0.022, 0.026), (1, 0, -1.2))), 0.008)
    clay.carve(both_sides(ellipsoid((1.1, 0.06, 1.5), (0.026, 0.022, 0.018), (1, 0, -1.2))), 0.015)
    ear = ribbon(
        [(0.75, 0.055, 1.92), (0.76, 0.075, 2.01), (0.79, 0.085, 2.11)],
        [0.06, 0.066, 0.035],
        [0.055, 0.058, 0.035],
        (1, 0.6, 0),
    )
    clay.add(both_sides(ear), 0.03)
    locks = [
        ([(0.75, 0, 1.95), (0.84, 0, 1.95), (0.92, 0, 1.86), (0.99, 0, 1.83)], [0.07, 0.065, 0.06, 0.035]),
        ([(0.72, 0, 1.94), (0.62, 0, 1.98), (0.5, 0, 1.89), (0.36, 0, 1.93)], [0.075, 0.085, 0.08, 0.035]),
        ([(0.67, 0, 1.84), (0.56, 0, 1.87), (0.43, 0, 1.74), (0.27, 0, 1.77)], [0.08, 0.1, 0.085, 0.035]),
        ([(0.6, 0, 1.7), (0.49, 0, 1.73), (0.35, 0, 1.58), (0.17, 0, 1.6)], [0.085, 0.105, 0.09, 0.035]),
        ([(0.52, 0, 1.55), (0.41, 0, 1.58), (0.26, 0, 1.43), (0.07, 0, 1.45)], [0.085, 0.105, 0.09, 0.035]),
    ]
    for path, widths in locks:
        clay.add(ribbon(path, [0.09, 0.1, 0.085, 0.05], widths, Y_AXIS), 0.02)


def cow() -> Clay:
    """Sculpt a standing cow: barrel of a trunk, short neck, horns, udder, tasseled tail."""
    clay = Clay((-1.25, -0.5, -0.05), (1.45, 0.5, 1.95), 0.014)
    trunk = [(-0.66, 0, 1.17), (-0.35, 0, 1.12), (0.05, 0, 1.06), (0.36, 0, 1.1), (0.58, 0, 1.19)]
    clay.add(ribbon(trunk, [0.2, 0.28, 0.31, 0.27, 0.19], [0.22, 0.29, 0.32, 0.31, 0.25], Y_AXIS))
    clay.add(both_sides(ellipsoid((-0.6, 0.12, 1.2), (0.2, 0.13, 0.25), (1, 0, 0.4))), 0.12)
    clay.add(both_sides(ellipsoid((0.48, 0.13, 1.08), (0.17, 0.12, 0.3), (1, 0, -0.3))), 0.12)
    neck = [(0.5, 0, 1.22), (0.7, 0, 1.34), (0.9, 0, 1.46)]
    clay.add(ribbon(neck, [0.18, 0.135, 0.115], [0.27, 0.22, 0.16], Y_AXIS), 0.14)
    clay.add(
        ribbon([(0.62, 0, 1.08), (0.74, 0, 1.14), (0.86, 0, 1.26)], [0.05, 0.045, 0.04], [0.13, 0.12, 0.1], Y_AXIS), 0.1
    )
    add_cow_head(clay)
    clay.add(ellipsoid((-0.4, 0, 0.8), (0.19, 0.14, 0.12)), 0.1)
    for x in (-0.47, -0.33):
        clay.add(both_sides(tube([(x, 0.06, 0.75), (x, 0.065, 0.64)], [0.04, 0.03], 1)), 0.03)

    foreleg = [(0.5, 0.16, 1.0), (0.5, 0.17, 0.72), (0.52, 0.17, 0.46), (0.51, 0.17, 0.27), (0.52, 0.17, 0.13)]
    hind_leg = [(-0.58, 0.15, 1.08), (-0.5, 0.17, 0.76), (-0.66, 0.17, 0.52), (-0.63, 0.17, 0.3), (-0.61, 0.17, 0.13)]
    for path, radii in (
        (foreleg, [0.15, 0.115, 0.085, 0.066, 0.075]),
        (hind_leg, [0.2, 0.14, 0.088, 0.067, 0.075]),
    ):
        clay.add(both_sides(tube(path, radii)), 0.1)
        x, y, _ = path[-1]
        clay.add(both_sides(frustum((x + 0.015, y, 0.14), (x + 0.04, y, 0.0), (0.078, 0.1), 0.022)), 0.03)

    clay.add(
        tube([(-0.82, 0, 1.33), (-0.93, 0, 1.24), (-0.97, 0, 1.0), (-0.97, 0, 0.7)], [0.05, 0.042, 0.036, 0.034]), 0.06
    )
    clay.add(ellipsoid((-0.985, 0, 0.6), (0.14, 0.06, 0.062), (0.1, 0, -1)), 0.04)
    return clay


def add_cow_head(clay: Clay) -> None:
    """Add head, muzzle, ears and horns of the cow."""
    head = [(0.88, 0, 1.53), (1.0, 0, 1.45), (1.13, 0, 1.3), (1.22, 0, 1.18)]
    clay.add(ribbon(head, [0.125, 0.135, 0.095, 0.095], [0.125, 0.135, 0.1, 0.085], Y_AXIS), 0.08)
    clay.add(ellipsoid((1.235, 0, 1.165), (0.095, 0.112, 0.09), (1, 0, -1.2)), 0.05)
    clay.carve(both_sides(ellipsoid((1.31, 0.055, 1.185), (0.028, 0.024, 0.018), (1, 0, -1.2))), 0.015)
    clay.add(both_sides(ellipsoid((1.05, 0.118, 1.45), (0.036, 0.024, 0.028), (1, 0, -1.2))), 0.01)
    horn = tube(
        [(0.86, 0.08, 1.6), (0.86, 0.19, 1.65), (0.89, 0.25, 1.75), (0.93, 0.24, 1.84)], [0.05, 0.046, 0.038, 0.022]
    )
    clay.add(both_sides(horn), 0.03)
    ear = ribbon(
        [(0.87, 0.11, 1.53), (0.84, 0.22, 1.52), (0.83, 0.32, 1.46)], [0.045, 0.06, 0.035], [0.032] * 3, (0.3, 0, 1)
    )
    clay.add(both_sides(ear), 0.03)


def bird() -> Clay:
    """Sculpt a dove in flight, wings raised."""
    clay = Clay((-1.35, -1.3, -0.1), (1.1, 1.3, 2.3), 0.0165)
    body = [(-0.52, 0, 0.36), (-0.22, 0, 0.35), (0.12, 0, 0.42), (0.38, 0, 0.62), (0.53, 0, 0.84)]
    clay.add(ribbon(body, [0.12, 0.22, 0.265, 0.2, 0.14], [0.09, 0.2, 0.265, 0.205, 0.145], Y_AXIS))
    clay.add(ellipsoid((0.57, 0, 0.93), (0.2, 0.19, 0.19), (1, 0, 0.1)), 0.06)
    clay.add(tube([(0.7, 0, 0.93), (0.81, 0, 0.915), (0.91, 0, 0.87)], [0.082, 0.064, 0.042]), 0.025)
    clay.add(both_sides(ellipsoid((0.66, 0.16, 0.985), (0.036, 0.03, 0.036))), 0.008)
    for spread, lift in ((-0.46, 0), (-0.24, 0.035), (0, 0.06), (0.24, 0.035), (0.46, 0)):
        feather = [
            (-0.42, 0.15 * spread, 0.35),
            (-0.71, 0.55 * spread, 0.29 + lift),
            (-1.03 + 0.4 * spread**2, spread, 0.3 + lift),
        ]
        clay.add(ribbon(feather, [0.09, 0.13, 0.09], [0.08, 0.062, 0.056], Y_AXIS), 0.015)

    arm = spline(np.array([(0.18, 0.1, 0.5), (0.31, 0.36, 0.92), (0.21, 0.57, 1.31), (-0.05, 0.7, 1.63)]), 8)
    upward = np.array([0, 0.48, 0.88])
    for count, reach, start_angle, layer, half in ((9, 1.0, 2, 0.0, 0.056), (6, 0.52, 0, 0.035, 0.065)):
        for share in np.linspace(0, 1, count):
            angle = np.radians(start_angle + 58 * share**1.5)
            direction = -np.cos(angle) * np.array([1, 0, 0]) + np.sin(angle) * upward
            root = arm[round(share * (len(arm) - 1))] + layer * np.array([0, -0.88, 0.48]) + 0.07 * direction
            tip = root + reach * (0.62 + 0.1 * np.sin(3 * share)) * direction
            sideways = np.cross(direction, np.cross([1, 0, 0], upward))
            blade = ribbon(
                [root, (root + tip) / 2, tip], [0.09 - 0.03 * share, 0.12, 0.065], [0.065, half + 0.01, half], sideways
            )
            clay.add(both_sides(blade), 0.015)
    clay.add(both_sides(tube(arm[::4], np.linspace(0.14, 0.08, len(arm[::4])), 3)), 0.06)
    return clay


def knot() -> Clay:
    """Sculpt a trefoil knot, two lobes down."""
    angle = np.linspace(0, 2 * np.pi, 48, endpoint=False)
    x = np.sin(angle) + 2 * np.sin(2 * angle)
    z = -np.cos(angle) + 2 * np.cos(2 * angle)
    path = np.column_stack([x, 1.3 * np.sin(3 * angle), z]) * 0.3
    clay = Clay((-1.15, -0.7, -1.15), (1.15, 0.7, 1.15), 0.018)
    return clay.add(tube(path, [0.165] * len(path), 2, closed=True))


def double_torus() -> Clay:
    """Sculpt two joined rings, each rotated slightly out of their common plane."""
    clay = Clay((-1.3, -0.8, -0.95), (1.3, 0.8, 0.95), 0.018)
    angle = np.linspace(0, 2 * np.pi, 32, endpoint=False)
    for side in (-1, 1):
        x, z = 0.47 * np.cos(angle), 0.52 * np.sin(angle)
        turn = side * 0.45
        path = np.column_stack([side * 0.56 + x, -np.sin(turn) * z, np.cos(turn) * z])
        clay.add(tube(path, 0.205 + 0.025 * side * np.cos(angle), 2, closed=True), 0.3)
    return clay


def dolphins() -> Clay:
    """Sculpt two dolphins chasing each other around a ring, without touching."""
    clay = Clay((-1.3, -0.6, -1.3), (1.3, 0.6, 1.3), 0.0175)
    for start in (0, np.pi):

        def at(degrees: float, radius: float, y: float = 0, start: float = start) -> tuple[float, float, float]:
            angle = start + np.radians(degrees)
            return (radius * np.cos(angle), y, radius * np.sin(angle))

        one = Clay((-1.3, -0.6, -1.3), (1.3, 0.6, 1.3), 0.0175)
        body = [at(152, 0.78), at(128, 0.77), at(98, 0.74), at(64, 0.73), at(38, 0.73), at(22, 0.73)]
        one.add(tube(body, [0.07, 0.13, 0.235, 0.255, 0.2, 0.13]))
        one.add(tube([at(26, 0.73), at(10, 0.7), at(3, 0.69)], [0.1, 0.07, 0.062]), 0.04)
        one.add(
            ribbon([at(84, 0.9), at(96, 1.08), at(109, 1.17)], [0.14, 0.1, 0.055], [0.07, 0.062, 0.055], at(0, 1)), 0.05
        )
        for side in (-1, 1):
            flipper = [at(52, 0.62, side * 0.17), at(64, 0.55, side * 0.32), at(78, 0.5, side * 0.44)]
            one.add(ribbon(flipper, [0.1, 0.09, 0.055], [0.07, 0.062, 0.055], at(142, 1)), 0.04)
            fluke = [at(149, 0.78), at(157, 0.79, side * 0.15), at(166, 0.81, side * 0.33)]
            one.add(ribbon(fluke, [0.08, 0.1, 0.055], [0.066, 0.062, 0.055], at(245, 1)), 0.03)
            eye = ellipsoid(at(33, 0.75, side * 0.165), (0.03, 0.022, 0.03))
            one.add(eye, 0.008)
        clay.merge(one)
    return clay


def octopus() -> Clay:
    """Sculpt an octopus on curled arms, two of them raised."""
    clay = Clay((-1.3, -1.3, -0.1), (1.3, 1.3, 1.8), 0.018)
    clay.add(ellipsoid((-0.12, 0, 1.12), (0.47, 0.41, 0.39), (-0.5, 0, 1)))
    clay.add(ellipsoid((0.06, 0, 0.56), (0.33, 0.33, 0.28)), 0.25)
    clay.add(both_sides(ellipsoid((0.26, 0.2, 0.8), (0.13, 0.13, 0.13))), 0.03)
    clay.carve(both_sides(ellipsoid((0.38, 0.26, 0.82), (0.05, 0.05, 0.06))), 0.02)
    walking = [
        (0.1, 0, 0.46, 0.18),
        (0.42, 0, 0.28, 0.155),
        (0.68, 0.04, 0.13, 0.125),
        (0.92, 0.17, 0.12, 0.1),
        (1.01, 0.33, 0.26, 0.085),
        (0.9, 0.42, 0.4, 0.075),
        (0.76, 0.38, 0.38, 0.063),
    ]
    raised = [
        (0.1, 0, 0.46, 0.18),
        (0.45, 0, 0.38, 0.155),
        (0.72, 0.04, 0.5, 0.125),
        (0.85, 0.1, 0.76, 0.1),
        (0.78, 0.16, 1.0, 0.085),
        (0.92, 0.2, 1.15, 0.075),
        (1.05, 0.22, 1.04, 0.063),
    ]
    for index in range(8):
        angle = np.radians(22.5 + 45 * index)
        outward, aside = np.array([np.cos(angle), np.sin(angle), 0]), np.array([-np.sin(angle), np.cos(angle), 0])
        rows = raised if index in (0, 4) else walking
        path = [r * outward + s * aside + (0, 0, z) for r, s, z, _ in rows]
        clay.add(tube(path, [row[3] for row in rows]), 0.07)
    return clay


def letter_a() -> Clay:
    """Draw a capital A with three round strokes."""
    strokes = [
        tube([(-0.66, 0, 0), (0, 0, 1.6)], [0.2, 0.2], 1),
        tube([(0.66, 0, 0), (0, 0, 1.6)], [0.2, 0.2], 1),
        tube([(-0.4, 0, 0.5), (0.4, 0, 0.5)], [0.18, 0.18], 1),
    ]
    return Clay((-1.2, -0.5, -0.5), (1.2, 0.5, 2.1), 0.02).add(extruded(strokes, 0.23, 0.11, 0.025))


def letter_b() -> Clay:
    """Draw a capital B with a stem and two bowls."""

    def bowl(low: float, high: float, width: float) -> Solid:
        radius = (high - low) / 2
        turn = np.linspace(-np.pi / 2, np.pi / 2, 13)
        arc = np.column_stack([width + radius * np.cos(turn), 0 * turn, low + radius + radius * np.sin(turn)])
        path = np.vstack([(-0.5, 0, low), arc, (-0.5, 0, high)])
        return tube(path, [0.2] * len(path), 1)

    strokes = [tube([(-0.5, 0, 0), (-0.5, 0, 1.6)], [0.2, 0.2], 1), bowl(0, 0.86, 0.15), bowl(0.86, 1.6, 0.1)]
    return Clay((-1.0, -0.5, -0.5), (1.0, 0.5, 2.1), 0.02).add(extruded(strokes, 0.23, 0.11, 0.025))


@dataclass(frozen=True)
class Recipe:
    """The function that sculpts a shape, its expected topology, its number of triangles, and rounds of smoothing.

    Smoothing removes dents from round bodies, but also wears off feathers and hooves.
    """

    sculpt: Callable[[], Clay]
    genus: int
    parts: int
    triangles: int
    evening_rounds: int = 0

    def built(self) -> tuple[np.ndarray, np.ndarray]:
        """Return vertices and triangles."""
        clay = self.sculpt()
        vertices, triangles = reduced(*clay.surface(), self.triangles)
        return placed(clay.relaxed(vertices, triangles, self.evening_rounds)), triangles


@dataclass(frozen=True)
class PoseRecipe:
    """A body of the benchmarks in one of its poses, with its own vertices."""

    sculpture: Sculpture
    triangles: int = 5400
    genus: int = 0
    parts: int = 1

    def built(self) -> tuple[np.ndarray, np.ndarray]:
        """Return vertices and triangles."""
        mesh = self.sculpture.mesh(self.triangles)
        return mesh.vertices, mesh.faces


_ARMS_RAISED_AND_HANGING = (straight(degrees(out=140)), straight(degrees(out=20)))

SHAPES = {
    "horse": Recipe(horse, genus=0, parts=1, triangles=5400),
    "cow": Recipe(cow, genus=0, parts=1, triangles=5400),
    "bird": Recipe(bird, genus=0, parts=1, triangles=4800),
    "knot": Recipe(knot, genus=1, parts=1, triangles=3800, evening_rounds=4),
    "double_torus": Recipe(double_torus, genus=2, parts=1, triangles=3400, evening_rounds=4),
    "dolphins": Recipe(dolphins, genus=0, parts=2, triangles=4400),
    "octopus": Recipe(octopus, genus=0, parts=1, triangles=5000),
    "letter_a": Recipe(letter_a, genus=1, parts=1, triangles=2000),
    "letter_b": Recipe(letter_b, genus=2, parts=1, triangles=2000),
    "man": PoseRecipe(biped(MAN, Posture(), 1).sculpture),
    "man_waving": PoseRecipe(biped(MAN, Posture(arms=_ARMS_RAISED_AND_HANGING), 2).sculpture),
    "dog": PoseRecipe(quadruped(DOG, STANDING, 11).sculpture),
    "dog_rearing": PoseRecipe(quadruped(DOG, REARING, 12).sculpture),
}

TEXTURED = {"cow": "cow_spotted"}
"""Shapes that are also written with a texture, and the names of these files."""


def reduced(vertices: np.ndarray, triangles: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Reduce a surface to about `count` triangles by Blender's edge collapse."""
    mesh = bpy.data.meshes.new("fine")
    mesh.from_pydata(vertices, [], triangles)
    fine = bpy.data.objects.new("fine", mesh)
    bpy.context.scene.collection.objects.link(fine)
    modifier = fine.modifiers.new("reduce", "DECIMATE")
    modifier.ratio = count / len(triangles)
    result = fine.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    corners = np.empty(3 * len(result.polygons), np.int32)
    result.polygons.foreach_get("vertices", corners)
    points = np.empty(3 * len(result.vertices), np.float32)
    result.vertices.foreach_get("co", points)
    bpy.data.objects.remove(fine)
    bpy.data.meshes.remove(mesh)
    return points.reshape(-1, 3).astype(float), corners.reshape(-1, 3)


def placed(vertices: np.ndarray) -> np.ndarray:
    """Scale to the longest side, center in x and y, and place on the ground."""
    low, high = vertices.min(0), vertices.max(0)
    origin = np.array([*(low + high)[:2] / 2, low[2]])
    return (vertices - origin) * (LONGEST_SIDE / (high - low).max())


def components(count: int, edges: np.ndarray) -> int:
    """Count the connected parts of the graph with `count` vertices."""
    label = np.arange(count)
    while True:
        lowest = label.copy()
        np.minimum.at(lowest, edges[:, 0], label[edges[:, 1]])
        lowest = lowest[lowest]
        if np.array_equal(lowest, label):
            return len(np.unique(label))
        label = lowest


def checked_genus(vertices: np.ndarray, triangles: np.ndarray) -> tuple[int, int]:
    """Return total genus and number of parts of a closed, outward surface.

    Raises
    ------
    ValueError
        The surface is open, not a manifold, or inside out.
    """
    halves = np.vstack([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]).astype(np.int64)
    key = halves[:, 0] * len(vertices) + halves[:, 1]
    opposite = halves[:, 1] * len(vertices) + halves[:, 0]
    if len(np.unique(key)) != len(key) or not np.array_equal(np.sort(key), np.sort(opposite)):
        raise ValueError("an edge is not shared by exactly two triangles that agree")
    if np.einsum("ij,ij->", vertices[triangles[:, 0]], np.cross(*vertices[triangles[:, 1:]].transpose(1, 0, 2))) <= 0:
        raise ValueError("the surface is inside out")
    parts = components(len(vertices), halves)
    euler = len(vertices) - len(halves) // 2 + len(triangles)
    return parts - euler // 2, parts


def write_ply(path: Path, vertices: np.ndarray, triangles: np.ndarray) -> None:
    """Write a binary PLY with float positions and int triangles."""
    header = (
        "ply\nformat binary_little_endian 1.0\ncomment CC0 1.0\n"
        f"element vertex {len(vertices)}\nproperty float x\nproperty float y\nproperty float z\n"
        f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    faces = np.empty(len(triangles), [("count", "u1"), ("corners", "<i4", 3)])
    faces["count"], faces["corners"] = 3, triangles
    path.write_bytes(header.encode() + vertices.astype("<f4").tobytes() + faces.tobytes())


def main(names: list[str]) -> None:
    """Build the named shapes, or all."""
    FOLDER.mkdir(exist_ok=True)
    for name in names or SHAPES:
        recipe = SHAPES[name]
        vertices, triangles = recipe.built()
        genus, parts = checked_genus(vertices, triangles)
        if (genus, parts) != (recipe.genus, recipe.parts):
            raise ValueError(f"{name} came out with genus {genus} in {parts} parts")
        path = FOLDER / f"{name}.ply"
        write_ply(path, vertices, triangles)
        if name in TEXTURED:
            write_textured(FOLDER / TEXTURED[name], vertices.astype(np.float32), triangles)
        print(
            f"{name:13} {len(vertices):5} vertices {len(triangles):5} triangles  genus {genus}  components {parts}"
            f"  {path.stat().st_size / 1000:5.1f} kB"
        )


if __name__ == "__main__":
    main(sys.argv[1:])
