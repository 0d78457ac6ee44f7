# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The order in which nodes are filled, and mixtures that never jump while finer levels take over."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from convwass_addon.applications.live.filling_lattice import (
    FINEST,
    LEVELS,
    FillingLattice,
    Wanted,
    count_of_nodes,
    fitting_levels,
)
from convwass_addon.applications.live.weight_layouts import (
    PathLayout,
    SquareLayout,
    TriangleLayout,
    WeightLayout,
    path_weights,
    square_weights,
)
from tests.applications.live.fields import ball_field

LAYOUTS = [PathLayout(2), TriangleLayout(), SquareLayout()]
HANDS = {1: (0.34, 0.66), 2: (0.2, 0.45, 0.35), 3: square_weights(0.3, 0.6)}
# A ball that grows by so little from node to node that no finer level is asked for.
FIELD = ball_field(6.0)


def by_type(layout: WeightLayout) -> str:
    return type(layout).__name__


def hand_of(layout: WeightLayout) -> np.ndarray:
    return np.asarray(HANDS[layout.count - 1])


def mean_weights(lattice: FillingLattice, names: dict, hand: np.ndarray, now: float) -> tuple[np.ndarray, float]:
    """Return the mean of the weights of the nodes that a blend is mixed from, and how much is missing."""
    found = lattice.mixture(hand, now)
    total = sum((share * names[id(field)] for field, share in zip(found.fields, found.shares, strict=True)), 0.0)
    return total, found.rest


@pytest.mark.parametrize("layout", LAYOUTS, ids=by_type)
def test_nodes_come_level_by_level_and_nearest_to_the_hand_first(layout):
    lattice, hand, order = FillingLattice(layout, LEVELS, 1000, 0.0), hand_of(layout), []
    while (wanted := lattice.next_wanted(hand)) is not None:
        order.append(wanted)
        lattice.add(wanted.node, FIELD, 0.0)
    ends = [count_of_nodes(layout, LEVELS[: place + 1]) for place in range(len(LEVELS))]
    assert len(order) == len({one.node for one in order}) == ends[-1] == lattice.filled
    for begin, end in zip([0, *ends], ends, strict=False):
        distances = [np.abs(np.array(one.weights) - hand).sum() for one in order[begin:end]]
        assert distances == sorted(distances)
    assert lattice.is_whole(LEVELS[-1]) and lattice.fraction == 1.0 and lattice.has_taken_over(0.0)


@pytest.mark.parametrize("layout", LAYOUTS, ids=by_type)
def test_mixtures_have_the_weights_of_the_hand_and_do_not_jump(layout):
    lattice, names = FillingLattice(layout, LEVELS, 1000, 1.0), {}
    start, hand, before = np.asarray(layout.weights(layout.nodes(1)[0], 1)), hand_of(layout), None
    seconds, step = 0.0, 0
    while (wanted := lattice.next_wanted(hand)) is not None or seconds < 30.0:
        seconds, step = seconds + 0.05, step + 1
        if wanted is not None:
            field = replace(FIELD)
            names[id(field)] = np.array(wanted.weights)
            lattice.add(wanted.node, field, seconds)
        # Back and forth across filled and empty places.
        share = 0.5 + 0.5 * np.sin(step / 40.0)
        weights = (1.0 - share) * start + share * hand
        mean, rest = mean_weights(lattice, names, weights, seconds)
        if layout.count == 3 or isinstance(layout, PathLayout):
            np.testing.assert_allclose(mean, (1.0 - rest) * weights, atol=1e-9)
        found = lattice.mixture(weights, seconds)
        shares = dict(zip(map(id, found.fields), found.shares, strict=True))
        if before is not None:
            moved = sum(abs(shares.get(one, 0.0) - before.get(one, 0.0)) for one in shares.keys() | before.keys())
            # A share changes by at most the step of the weights times the steps of the lattice, and by the fade.
            assert moved < 0.9
        before = shares
    assert rest == pytest.approx(0.0, abs=1e-12)


def test_a_finer_level_fades_in():
    lattice = FillingLattice(PathLayout(2), LEVELS, 100, 2.0)
    for number in range(5):
        lattice.add((8 * number,), FIELD, 0.0)
    assert lattice.mixture((0.5, 0.5), 0.0).rest == 1.0
    assert lattice.mixture((0.5, 0.5), 1.0).rest == pytest.approx(0.5)
    assert lattice.mixture((0.5, 0.5), 2.0).rest == 0.0
    eighth = replace(FIELD)
    lattice.add((20,), eighth, 10.0)
    shares = []
    for now in (10.0, 11.0, 12.0):
        found = lattice.mixture(path_weights(9 / 16, 2), now)
        shares.append(sum(share for field, share in zip(found.fields, found.shares, strict=True) if field is eighth))
    # Half way to a node that is not ready the finer level counts half, and the node half of that.
    assert shares == pytest.approx([0.0, 0.125, 0.25])


def test_neighbors_that_differ_too_much_are_refined():
    lattice = FillingLattice(PathLayout(2), LEVELS, 100, 0.0)
    radius = {place: 6.0 if place < 16 else 8.0 for place in range(33)}
    asked = []
    while (wanted := lattice.next_wanted((0.5, 0.5))) is not None:
        asked.append(wanted)
        lattice.add(wanted.node, ball_field(radius[wanted.node[0]]), 0.0)
    # Between 15 and 16 of 32 the ball grows at once; sixteenths are even numbers.
    assert asked[-1] == Wanted((15,), pytest.approx((17 / FINEST, 15 / FINEST)))
    assert count_of_nodes(PathLayout(2), LEVELS) == len(asked) - 1
    assert lattice.mixture(path_weights(15 / 32, 2), 0.0).shares == pytest.approx([1.0])
    # If memory suffices only for these nodes, there are no finer ones.
    small = FillingLattice(PathLayout(2), LEVELS, count_of_nodes(PathLayout(2), LEVELS), 0.0)
    while (wanted := small.next_wanted((0.5, 0.5))) is not None:
        small.add(wanted.node, ball_field(radius[wanted.node[0]]), 0.0)
    assert small.filled == count_of_nodes(PathLayout(2), LEVELS)


def test_levels_that_exceed_the_memory_are_left_out():
    triangle = TriangleLayout()
    assert fitting_levels(triangle, 1000) == LEVELS
    assert fitting_levels(triangle, 60) == (4, 8)
    assert fitting_levels(triangle, 0) == (4,)


def test_a_complete_lattice_mixes_no_more_than_the_nodes_around_a_blend():
    lattice = FillingLattice(TriangleLayout(), LEVELS, 1000, 1.0)
    while (wanted := lattice.next_wanted((0.2, 0.3, 0.5))) is not None:
        lattice.add(wanted.node, FIELD, 0.0)
    for weights in np.random.default_rng(3).dirichlet(np.ones(3), 20):
        found = lattice.mixture(weights, 1.0)
        assert len(found.fields) == 3 and found.rest == 0.0
    assert len(lattice.mixture(weights, 0.5).fields) > 3
