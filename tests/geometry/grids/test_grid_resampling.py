# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Interpolation at the points of another grid."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import affine_transform

from convwass_addon.geometry.grids.grid_resampling import resampled

SHAPE, FIRST, STEP = (9, 12, 10), np.array([0.3, 1.2, 0.7]), 0.6


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_linear_functions_are_exact(dtype):
    x, y, z = np.indices((7, 10, 8)).astype(dtype)
    found = resampled(2.0 * x - y + 0.5 * z, FIRST, STEP, SHAPE)
    i, j, k = FIRST[:, None, None, None] + STEP * np.indices(SHAPE)
    assert found.dtype == dtype
    np.testing.assert_allclose(found, 2.0 * i - j + 0.5 * k, atol=1e-5)


def test_noise_is_interpolated_as_by_scipy():
    field = np.random.default_rng(1).random((7, 10, 8))
    expected = affine_transform(field, np.full(3, STEP), FIRST, SHAPE, order=1)
    np.testing.assert_allclose(resampled(field, FIRST, STEP, SHAPE), expected, atol=1e-12)


def test_the_field_fades_to_zero_within_a_cell():
    found = resampled(np.ones((2, 2, 2)), np.array([-1.5, 0.0, 0.0]), 0.5, (7, 1, 1))
    np.testing.assert_allclose(found.ravel(), [0.0, 0.0, 0.5, 1.0, 1.0, 1.0, 0.5])
