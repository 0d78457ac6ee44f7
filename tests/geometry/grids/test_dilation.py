# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import binary_dilation

from convwass_addon.geometry.grids.dilation import dilated


@pytest.mark.parametrize("shape", [(40,), (12, 17), (9, 8, 11), (5, 1, 6)])
@pytest.mark.parametrize("steps", [1, 3])
def test_agrees_with_scipy(shape, steps):
    inside = np.random.default_rng(1).random(shape) < 0.05
    before = inside.copy()
    np.testing.assert_array_equal(dilated(inside, steps), binary_dilation(inside, iterations=steps))
    np.testing.assert_array_equal(inside, before)
