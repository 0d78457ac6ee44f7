# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Places for changes, and those tried in vain."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from convwass_addon.geometry.level_sets.connectivity import Connectivity
from convwass_addon.geometry.level_sets.handle_places import REACH, Places, TriedPlaces
from convwass_addon.geometry.level_sets.handle_removal import FIRM, remove_handles
from convwass_addon.geometry.level_sets.isosurface import surface_at_level


@pytest.fixture
def places():
    cells = np.array([[10, 10, 10], [10, 10, 10], [40, 10, 10]])
    return Places(cells, np.array([0.8, 1.1, 0.8]), np.array([False, True, False]))


@pytest.fixture
def tried(places):
    tried = TriedPlaces()
    tried.begin(1.0)
    tried.add(places, np.array([2, 2, 4]))
    return tried


def test_only_as_many_widths_as_were_tried_are_left_out(places, tried):
    assert not len(tried.untried(places, 2).cells)
    np.testing.assert_array_equal(tried.untried(places, 4).cells, places.cells[:2])


def test_places_around_a_change_are_tried_again(places, tried):
    tried.forget_around(np.array([10, 10, 10 + 2 * REACH]))
    np.testing.assert_array_equal(tried.untried(places, 2).cells, places.cells[:2])


@pytest.mark.parametrize(("level", "left"), [(1.002, 0), (1.005, 3)])
def test_all_places_are_tried_again_at_another_level(places, tried, level, left):
    tried.begin(level)
    assert len(tried.untried(places, 2).cells) == left


def test_what_was_tried_in_vain_would_be_in_vain_again():
    """Random sponges, from which removals take what they can."""
    rng = np.random.default_rng(3)
    removed = 0
    for _ in range(3):
        sponge = gaussian_filter(rng.standard_normal((36, 36, 36)), 2.5)
        density = np.exp(sponge / sponge.std())
        density[[0, -1]] = density[:, [0, -1]] = density[:, :, [0, -1]] = 0.1
        excess = Connectivity.of(surface_at_level(density, 1.5)).handles
        once, twice, tried = density.copy(), density.copy(), TriedPlaces()
        for own, known in ((once, (None, None)), (twice, (tried, tried))):
            first = remove_handles(own, 1.5, excess, FIRM, known[0])
            removed += first + remove_handles(own, 1.5, excess - first, FIRM, known[1])
        np.testing.assert_array_equal(once, twice)
    assert removed > 0
