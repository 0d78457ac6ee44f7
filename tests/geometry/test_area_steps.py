# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangles at equal steps of area."""

from __future__ import annotations

import numpy as np

from convwass_addon.geometry.area_steps import at_equal_areas


def test_triangles_occur_by_their_area():
    np.testing.assert_array_equal(at_equal_areas(np.array([1.0, 0.0, 3.0, 2.0]), 6), [0, 2, 2, 2, 3, 3])


def test_a_surface_without_area_has_triangles_nevertheless():
    assert at_equal_areas(np.zeros(3), 2).max() <= 2
