# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Matched curves beside exhaustive search, and between curves whose match is known."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from convwass_addon.geometry.plane import curve_matching
from convwass_addon.geometry.plane.closed_curves import ClosedCurve
from convwass_addon.geometry.plane.curve_maps import even_map, smooth_map
from convwass_addon.geometry.plane.curve_matching import CurveSamples, MatchWeights, match_work, matched_curves
from tests.flat_shapes import ellipse, rectangle

HOOK = np.array([[0, 0], [2, 0], [2, 0.5], [0.4, 0.5], [0.4, 3], [0, 3]]) - [0.6, 1.2]
WEIGHTS = MatchWeights(0.3, 2.0, 0.2, 8.0, 0.02)


def samples(points, seed=None):
    """Closed samples of a polygon; with random features if there is a seed."""
    curve = ClosedCurve(np.asarray(points, dtype=np.float64))
    shape = np.zeros((len(points), 1)) if seed is None else np.random.default_rng(seed).random((len(points), 1))
    along = np.roll(points, -1, axis=0) - points
    before = np.roll(along, 1, axis=0)
    turns = np.arctan2(before[:, 0] * along[:, 1] - before[:, 1] * along[:, 0], (before * along).sum(axis=1))
    closed = (np.concatenate([own, own[:1]]) for own in (np.asarray(points), turns, shape))
    return CurveSamples(curve.starts / curve.length, *closed)


def even(curve, count, start=0.0):
    return curve.at(start + np.arange(count) * curve.length / count)


def test_the_match_has_the_least_work_of_all():
    random = np.random.default_rng(7)
    one, other = samples(random.random((9, 2)), 1), samples(random.random((11, 2)), 2).twice_around()
    apart = np.square(one.shape[:, None] - other.shape).sum(axis=-1)
    works = {step: curve_matching._works(one, other, step, WEIGHTS, apart) for step in curve_matching._STEPS}

    @cache
    def least(row, column, end):
        """Least work from samples of both to the end."""
        if row == 9 or column == end:
            return 0.0 if (row, column) == (9, end) else np.inf
        steps = [(p, q) for p, q in works if row + p <= 9 and column + q <= end]
        return min((works[p, q][row, column] + least(row + p, column + q, end) for p, q in steps), default=np.inf)

    found = matched_curves(one, other, range(11), 11, WEIGHTS)
    assert found.cost == pytest.approx(min(least(0, start, start + 11) for start in range(11)))
    pieces = zip(np.diff(found.first), np.diff(found.second), found.first, found.second, strict=False)
    assert sum(works[p, q][row, column] for p, q, row, column in pieces) == pytest.approx(found.cost)
    assert match_work(one, other, found, WEIGHTS) == pytest.approx(found.cost)
    assert (found.first[[0, -1]].tolist(), found.second[-1] - found.second[0]) == ([0, 9], 11)


@pytest.mark.parametrize("shift", [0, 5, 17])
def test_a_curve_matches_itself_from_any_start(shift):
    points = even(ClosedCurve(HOOK), 40)
    found = matched_curves(
        samples(points), samples(np.roll(points, shift, axis=0)).twice_around(), range(40), 40, WEIGHTS
    )
    assert found.cost == pytest.approx(0.0, abs=1e-12)
    assert found.second[0] == shift
    assert (np.diff(found.second) == 1).all()


def test_turned_samples_match_without_work_after_the_turn():
    points = even(ClosedCurve(HOOK), 40)
    other = samples(points).turned(1.0)
    assert matched_curves(samples(points), other, range(1), 40, WEIGHTS).cost > 0.1
    assert matched_curves(samples(points).turned(1.0), other, range(1), 40, WEIGHTS).cost == pytest.approx(
        0.0, abs=1e-12
    )


def test_smooth_maps_keep_corners_and_increase():
    square, circle = ClosedCurve(rectangle((-1, -1), (1, 1))), ClosedCurve(ellipse())
    # A match at uneven speed: corners lie at every second place.
    places = np.arange(9.0)
    images = circle.length * np.array([0.0, 0.15, 0.25, 0.33, 0.5, 0.66, 0.75, 0.85, 1.0])
    none = np.empty(0)
    found = smooth_map((square, circle), (square.starts[:-1], none), places, images)
    assert found(places[::2]) == pytest.approx(images[::2])
    assert (np.diff(found(np.linspace(0.0, 8.0, 500))) > 0).all()
    every = np.linspace(-9.0, 20.0, 300)
    assert found.inverse()(found(every)) == pytest.approx(every)
    assert found(every + 8.0) == pytest.approx(found(every) + circle.length)


def test_even_maps_have_constant_speed():
    square, circle = ClosedCurve(rectangle((-1, -1), (1, 1))), ClosedCurve(ellipse())
    assert even_map(square, circle)(np.array([-2.0, 0.0, 4.0])) == pytest.approx(
        circle.length * np.array([-0.25, 0, 0.5])
    )
