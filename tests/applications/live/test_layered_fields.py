# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shares of layers that cover each other."""

from __future__ import annotations

import pytest

from convwass_addon.applications.live.filling_lattice import LEVELS, FillingLattice
from convwass_addon.applications.live.layered_fields import LayeredFields
from convwass_addon.applications.live.level_fields import LevelField
from convwass_addon.applications.live.weight_layouts import PathLayout
from tests.applications.live.fields import ball_field

HAND = (0.5, 0.5)
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
    layers = LayeredFields()
    assert not layers.mixture(HAND, 0.0).fields and layers.coverage(HAND, 0.0) == 0.0
    layers.set_hand(HAND, single)
    layers.cover(filled_layer(older, 0.0))
    layers.cover(filled_layer(newer, 0.5))
    found = layers.mixture(HAND, 1.0)
    # The newer layer is a quarter of the way, the older one half.
    assert found.shares == pytest.approx((0.25, 0.375, 0.375))
    assert [field.volume for field in found.fields] == [newer.volume, older.volume, single.volume]
    assert layers.coverage(HAND, 1.0) == pytest.approx(0.625)
    assert layers.mixture(HAND, 3.0).shares == pytest.approx((1.0,))


def test_layers_that_are_covered_are_dropped():
    layers, lower, upper = LayeredFields(), filled_layer(ball_field(6.0), 0.0), filled_layer(ball_field(7.0), 0.0)
    layers.cover(lower)
    layers.cover(upper)
    assert layers.newest is upper and layers.oldest is lower and layers.filled == 10
    layers.settle(0.5 * FADE)
    assert layers.oldest is lower
    layers.settle(FADE)
    assert layers.oldest is upper and layers.filled == 5
