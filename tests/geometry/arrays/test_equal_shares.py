# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Items in the middles of parts of equal weight."""

from __future__ import annotations

import numpy as np

from convwass_addon.geometry.arrays.equal_shares import at_equal_shares


def test_triangles_occur_by_their_area():
    np.testing.assert_array_equal(at_equal_shares(np.array([1.0, 0.0, 3.0, 2.0]), 6), [0, 2, 2, 2, 3, 3])


def test_a_surface_without_area_has_triangles_nevertheless():
    assert at_equal_shares(np.zeros(3), 2).max() <= 2
