# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
from scipy.spatial.distance import cdist

from convwass_addon.geometry.arrays.far_points import far_points


def test_every_point_is_the_farthest_from_those_before_it():
    points = np.random.default_rng(0).random((60, 3))
    chosen = far_points(points, 12)
    apart = cdist(points, points)
    assert chosen[0] == cdist(points, [points.mean(axis=0)]).argmax()
    for count in range(1, 12):
        assert apart[chosen[count], chosen[:count]].min() == apart[:, chosen[:count]].min(axis=1).max()


def test_the_first_of_nearly_equal_points_is_chosen():
    square = np.array([[1.0, 1.0, 0.0], [-1.0, 1.0, 0.0], [-1.0, -1.0, 0.0], [1.0, -1.0 - 1e-12, 0.0]])
    assert far_points(square, 1) == [3]
    assert far_points(square, 1, 1e-9) == [0]
