# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.arrays.steps import linear_step, smooth_step

VALUES = np.linspace(-1.0, 4.0, 51)


def test_a_linear_step_interpolates_and_stays_between_0_and_1():
    np.testing.assert_allclose(linear_step(VALUES, 1.0, 3.0), np.interp(VALUES, [1.0, 3.0], [0.0, 1.0]), atol=1e-15)


@pytest.mark.parametrize("step", [linear_step, smooth_step])
def test_steps_fall_if_the_value_of_zero_is_the_larger_one(step):
    np.testing.assert_allclose(step(VALUES, 3.0, 1.0), 1.0 - step(VALUES, 1.0, 3.0), atol=1e-15)


def test_a_smooth_step_has_the_slope_of_its_polynomial():
    inside = np.linspace(1.0, 3.0, 101)
    share = (inside - 1.0) / 2.0
    slopes = (smooth_step(inside + 1e-6, 1.0, 3.0) - smooth_step(inside - 1e-6, 1.0, 3.0)) / 2e-6
    np.testing.assert_allclose(slopes, 3.0 * share * (1.0 - share), atol=2e-6)
