# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shares of layers that cover each other, and their common box."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.live.filling_lattice import LEVELS, FillingLattice
from convwass_addon.applications.live.layered_fields import LayeredFields
from convwass_addon.applications.live.level_fields import FieldBox, LevelField
from convwass_addon.applications.live.weight_layouts import PathLayout
from tests.applications.live.fields import BOX, ball_field

HAND = (0.5, 0.5)
LARGER = FieldBox(BOX.low - 4, tuple(int(n) + 9 for n in BOX.shape))
# A layer takes over within this time.
FADE = 2.0


def filled_layer(field: LevelField, now: float) -> FillingLattice:
    """Return a lattice of one level whose nodes all have the same field."""
    lattice = FillingLattice(PathLayout(2), LEVELS[:1], 100, FADE)
    while (wanted := lattice.next_wanted(HAND)) is not None:
        lattice.add(wanted.node, field, now)
    return lattice


def test_each_layer_takes_its_share_of_what_newer_ones_leave():
    single, older, newer = (ball_field(radius) for radius in (5.0, 6.0, 7.0))
    layers = LayeredFields(BOX)
    assert not layers.mixture(HAND, 0.0).fields and layers.coverage(HAND, 0.0) == 0.0
    layers.set_hand(HAND, single)
    layers.cover(filled_layer(older, 0.0), BOX)
    layers.cover(filled_layer(newer, 0.5), BOX)
    found = layers.mixture(HAND, 1.0)
    # The newer layer is a quarter of the way, the older one half.
    assert found.shares == pytest.approx((0.25, 0.375, 0.375))
    assert [field.volume for field in found.fields] == [newer.volume, older.volume, single.volume]
    assert layers.coverage(HAND, 1.0) == pytest.approx(0.625)
    assert layers.mixture(HAND, 3.0).shares == pytest.approx((1.0,))


def test_layers_that_are_covered_are_dropped():
    layers, lower, upper = LayeredFields(BOX), filled_layer(ball_field(6.0), 0.0), filled_layer(ball_field(7.0), 0.0)
    layers.cover(lower, BOX)
    layers.cover(upper, BOX)
    assert layers.newest is upper and layers.oldest is lower and layers.filled == 10
    layers.settle(0.5 * FADE)
    assert layers.oldest is lower
    layers.settle(FADE)
    assert layers.oldest is upper and layers.filled == 5


def test_all_fields_are_in_the_box_of_the_newest_layer():
    layers, small, large = LayeredFields(BOX), ball_field(6.0), ball_field(7.0)
    layers.set_hand(HAND, small)
    layers.cover(filled_layer(small, 0.0), BOX)
    layers.cover(filled_layer(large.within(LARGER), 0.0), LARGER)
    found = layers.mixture(HAND, 0.5 * FADE)
    assert [field.box for field in found.fields] == [LARGER] * 3
    assert layers.bytes == 10 * LARGER.field_bytes
    # A field that was begun in the smaller box arrives later.
    layers.set_hand(HAND, large)
    assert layers.hand.field.box is LARGER and layers.hand.field.volume == large.volume
    np.testing.assert_array_equal(layers.hand.field.span + LARGER.low, large.span + BOX.low)
