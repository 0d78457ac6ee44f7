# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np

from convwass_addon.geometry.algebra.quotients import quotients


def test_only_positive_divisors_divide():
    with np.errstate(all="raise"):
        found = quotients(np.array([6.0, 6.0, 0.0]), np.array([[2.0, 0.0, 0.0], [3.0, -1.0, 4.0]]), 1.0)
    np.testing.assert_array_equal(found, [[3.0, 1.0, 1.0], [2.0, 1.0, 0.0]])
