# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
from scipy.ndimage import label

from convwass_addon.geometry.level_sets.gap_bridging import growing_tip, raised_along, way_across
from convwass_addon.geometry.level_sets.gaps import Gap

GAP = Gap((12, 10, 4), 8.0, 0.6, (1, 2))


def two_blocks():
    """Two blocks connected by a straight thin corridor and by a denser detour."""
    density = np.full((24, 16, 9), 0.02)
    density[2:8, 4:12, 2:7] = density[16:22, 4:12, 2:7] = 1.0
    density[8:16, 5, 4] = 0.3
    density[8:16, 10, 4] = 0.6
    return density, label(density > 0.9)[0]


def test_a_path_between_components_prefers_dense_cells():
    density, labels = two_blocks()
    way = way_across(density, labels, ([1], [2]), GAP)
    assert labels[tuple(way[0])] == 1
    assert labels[tuple(way[-1])] == 2
    assert np.abs(np.diff(way, axis=0)).max() == 1
    between = way[(way[:, 0] >= 8) & (way[:, 0] < 16)]
    assert (between[:, 1:] == [10, 4]).all()


def test_raising_makes_only_a_bridge():
    density, labels = two_blocks()
    way = way_across(density, labels, ([1], [2]), GAP)
    box, raised = raised_along(density, way, 0.9, 1.0)
    after = density.copy()
    after[box] = raised
    assert after[tuple(way.T)].min() >= 0.9 - 1e-9
    assert (after >= density).all()
    low, high = way.min(axis=0), way.max(axis=0)
    assert all(span.start >= a - 3 and span.stop <= b + 4 for span, a, b in zip(box, low, high, strict=True))
    assert after[12, 5, 4] < 0.31


def test_a_branch_ends_at_its_length():
    most = growing_tip((slice(0, 20), slice(2, 3), slice(2, 3)), np.array([3, 2, 2]), 8.0)[:, 0, 0]
    assert most[11] == 1.0
    assert (most[:11] > 1.0).all()
    assert (most[12:] < 1.0).all()
