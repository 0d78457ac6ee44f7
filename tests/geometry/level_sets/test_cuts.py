# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np

from convwass_addon.geometry.level_sets.cuts import Cuts


def ring():
    """A square ring of bars with 2 x 2 cells, and a separate rod."""
    inside = np.zeros((24, 14, 6), bool)
    inside[2:12, 2:12, 2:4] = True
    inside[4:10, 4:10, 2:4] = False
    inside[14:22, 2:4, 2:4] = True
    return inside


def slab(inside, x, y):
    """Cells of the solid in ranges of x and y."""
    taken = np.zeros_like(inside)
    taken[slice(*x), slice(*y)] = inside[slice(*x), slice(*y)]
    return np.argwhere(taken)


LEFT, RIGHT = ((6, 8), (2, 4)), ((6, 8), (10, 12))


def test_only_one_of_two_cuts_through_a_ring_is_taken():
    inside = ring()
    for first, second in ((0, 1), (1, 0)):
        cuts = Cuts(inside, {0: slab(inside, *LEFT), 1: slab(inside, *RIGHT)})
        assert cuts.take(first)
        assert not cuts.take(second)


def test_a_rod_may_be_shortened_but_not_cut():
    inside = ring()
    assert not Cuts(inside, {0: slab(inside, (17, 19), (2, 4))}).take(0)
    assert Cuts(inside, {0: slab(inside, (20, 22), (2, 4))}).take(0)


def test_a_cut_through_two_bars_at_once_is_refused():
    inside = ring()
    assert not Cuts(inside, {0: np.concatenate([slab(inside, *LEFT), slab(inside, *RIGHT)])}).take(0)


def test_a_cut_overlapping_a_taken_one_provides_no_connection():
    inside = ring()
    cuts = Cuts(inside, {0: slab(inside, *LEFT), 1: slab(inside, (7, 9), (2, 4)), 2: slab(inside, *RIGHT)})
    assert cuts.take(0)
    assert not cuts.take(2)


def test_cuts_that_make_a_hollow_are_refused():
    solid = np.zeros((9, 9, 9), bool)
    solid[1:8, 1:8, 1:8] = True
    assert not Cuts(solid, {0: np.array([[4, 4, 4]])}).take(0)
    assert Cuts(solid, {0: np.array([[1, 4, 4]])}).take(0)


def test_unclassified_cuts_are_refused():
    assert not Cuts(ring(), {}).take(0)
