# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Axes of symmetry of closed curves whose axes are known."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.plane.closed_curves import ClosedCurve, boundary_of
from convwass_addon.geometry.plane.curve_symmetry import MirrorAxes
from tests.flat_shapes import ellipse, rectangle

KITE = np.array([(0.0, -2.0), (1.0, 0.0), (0.0, 1.0), (-1.0, 0.0)])
HOOK = np.array([[0, 0], [2, 0], [2, 0.5], [0.4, 0.5], [0.4, 3], [0, 3]])


def axes_of(points):
    curve = ClosedCurve(np.asarray(points, dtype=np.float64))
    return curve, MirrorAxes.of(curve, boundary_of([curve]).center, curve.sharp_places(0.3))


def turned(points, angle):
    cosine, sine = np.cos(angle), np.sin(angle)
    return points @ np.array([[cosine, sine], [-sine, cosine]])


def star(count):
    angles = np.pi / 2 + np.arange(2 * count) * np.pi / count
    radii = np.where(np.arange(2 * count) % 2, 0.5, 1.0)
    return np.stack([radii * np.cos(angles), radii * np.sin(angles)], axis=1)


@pytest.mark.parametrize("angle", [0.0, 0.7, -2.0])
def test_a_kite_has_one_axis_through_its_tips(angle):
    curve, axes = axes_of(turned(KITE, angle))
    assert axes.is_best.sum() == 1
    best = int(np.flatnonzero(axes.is_best)[0])
    assert np.sin(axes.angles[best] - angle - np.pi / 2) == pytest.approx(0.0, abs=1e-6)
    ends = curve.at(axes.places[best])
    assert sorted(np.linalg.norm(ends, axis=1)) == pytest.approx([1.0, 2.0])


@pytest.mark.parametrize(
    ("points", "count"), [(ellipse(radii=(2.0, 1.0)), 2), (rectangle((0, 0), (3, 1)), 2), (star(5), 5), (star(8), 8)]
)
def test_axes_are_counted(points, count):
    assert axes_of(points)[1].is_best.sum() == count


def test_a_hook_has_no_axis_and_a_circle_has_all():
    assert not len(axes_of(HOOK)[1].angles)
    angles = np.sort(np.mod(axes_of(ellipse())[1].angles, np.pi))
    assert np.diff(angles).max() < 0.05
