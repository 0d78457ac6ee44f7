# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Strokes are flat shapes with two sides along a center line."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.plane.closed_curves import ClosedCurve, boundary_of
from convwass_addon.geometry.plane.plane_angles import rotated
from convwass_addon.geometry.plane.strokes import Stroke
from tests.flat_shapes import ellipse, rectangle


def stroke_of(ring, *holes):
    curve = ClosedCurve(np.asarray(ring, float))
    return Stroke.of(curve, boundary_of([curve, *map(ClosedCurve, holes)]))


def ribbon(line, width):
    """A line, (n, 2), that is widened to both sides."""
    across = np.gradient(line, axis=0)[:, ::-1] * (-1.0, 1.0)
    across *= 0.5 * width / np.linalg.norm(across, axis=1, keepdims=True)
    return np.concatenate([line - across, (line + across)[::-1]])


def polar(radii, angles):
    return np.stack([radii * np.cos(angles), radii * np.sin(angles)], axis=1)


@pytest.mark.parametrize("angle", [0.0, 0.7, 3.0])
@pytest.mark.parametrize("size", [1.0, 1e-3, 1e4])
def test_a_bar_is_straight_between_its_ends(angle, size):
    found = stroke_of(size * rotated(rectangle((0, 0), (8, 1)), angle))
    assert found.widths == pytest.approx(size, rel=0.02)
    assert found.length == pytest.approx(7.4 * size, rel=0.02)
    directions = found.at(np.linspace(0.0, 1.0, 9)).directions()
    assert np.sin(directions - angle) == pytest.approx(0.0, abs=0.02)


def test_a_piece_of_a_ring_turns_evenly():
    angles = np.linspace(0.0, 1.5 * np.pi, 100)
    found = stroke_of(ribbon(polar(2.0, angles), 0.4))
    assert found.widths == pytest.approx(0.4, rel=0.04)
    directions = found.at(np.linspace(0.0, 1.0, 13)).directions()
    # The ends that are cut off have 0.3 widths each.
    turn = np.diff(directions).mean() * 12
    assert abs(turn) == pytest.approx(1.5 * np.pi - 0.12, rel=0.02)
    assert np.diff(directions) == pytest.approx(turn / 12, abs=0.02)


def test_coils_of_a_spiral_are_apart():
    """The gap between them is a third as wide as the stroke."""
    angles = np.linspace(np.pi, 6.0 * np.pi, 300)
    found = stroke_of(ribbon(polar(0.4 / (2.0 * np.pi) * angles, angles), 0.3))
    assert found.at(np.linspace(0.05, 0.95, 60)).widths == pytest.approx(0.3, rel=0.08)


def test_the_other_end_has_the_other_sides():
    there = stroke_of(ribbon(polar(1.0, np.linspace(0.0, 4.0, 80)), 0.2))
    back = there.from_other_end()
    for own, other in zip(there.chords, back.chords[::-1], strict=True):
        np.testing.assert_allclose(own, other[::-1], atol=1e-12)
    for own in (there, back):
        around = own.around(5)
        assert (np.diff(around) > 0.0).all()
        assert around[-1] - around[0] == pytest.approx(own.curve.length)


T = np.array([(-0.5, 0), (0.5, 0), (0.5, 4), (2, 4), (2, 5), (-2, 5), (-2, 4), (-0.5, 4)], float)


@pytest.mark.parametrize(
    "rings",
    [
        [T],
        [ellipse((0, 0), (1, 1), 80)],
        [rectangle((0, 0), (1, 1))],
        [rectangle((0, 0), (4, 1)), rectangle((0.2, 0.2), (3.8, 0.8))[::-1]],
    ],
    ids=["branch", "disk", "square", "frame"],
)
def test_what_branches_or_is_not_narrow_is_no_stroke(rings):
    assert stroke_of(*rings) is None
