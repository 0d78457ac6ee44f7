# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import label

from convwass_addon.geometry.level_sets.gaps import densest_gaps


def row():
    """Three boxes in a row: the density falls to 0.4 between the first two, and to 0.2 between the others."""
    density = np.full((40, 10, 10), 0.01)
    for start, stop in ((4, 12), (16, 24), (28, 36)):
        density[start:stop, 3:7, 3:7] = 1.0
    density[12:16, 5, 4] = [0.6, 0.4, 0.45, 0.6]
    density[24:28, 5, 4] = [0.6, 0.2, 0.25, 0.6]
    return density, label(density > 0.7)[0]


def test_gaps_are_sorted_by_density_at_their_thinnest_cell():
    density, labels = row()
    first, second = densest_gaps(density, labels, 0.1, 5)
    assert first.place == (13, 5, 4)
    assert second.place == (25, 5, 4)
    assert first.width == pytest.approx(5.0)


def test_the_number_and_depth_of_gaps_are_limited():
    density, labels = row()
    assert [gap.place[0] for gap in densest_gaps(density, labels, 0.1, 1)] == [13]
    assert [gap.place[0] for gap in densest_gaps(density, labels, 0.3, 5)] == [13]
    assert densest_gaps(density, labels, 0.5, 5) == []


def test_a_gap_between_components_joined_by_a_denser_one_is_left_out():
    density, labels = row()
    density[12:16, 4, 4] = 0.3
    assert len(densest_gaps(density, labels, 0.1, 5)) == 2
