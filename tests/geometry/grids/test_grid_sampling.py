# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import map_coordinates

from convwass_addon.geometry.grids.grid_sampling import sampled

RANDOM = np.random.default_rng(1)


def test_linear_fields_are_sampled_exactly():
    centers = np.moveaxis(np.indices((5, 6, 7)), 0, -1) + 0.5
    field = centers @ RANDOM.normal(size=(3, 2)) + 3.0
    slope, offset = (
        np.linalg.lstsq(np.c_[centers.reshape(-1, 3), np.ones(field[..., 0].size)], field.reshape(-1, 2), rcond=None)[
            0
        ][:3],
        3.0,
    )
    points = RANDOM.uniform(0.5, 4.5, (200, 3))
    np.testing.assert_allclose(sampled(field, points), points @ slope + offset, atol=1e-12)


@pytest.mark.parametrize("spread", [1.0, 3.0])
def test_agrees_with_scipy_inside_and_outside(spread):
    field = RANDOM.normal(size=(4, 3, 2, 3))
    points = (RANDOM.uniform(-0.5, 0.5, (20_000, 3)) * spread + 0.5) * (4, 3, 2)
    expected = [map_coordinates(field[..., c], points.T - 0.5, order=1, mode="nearest") for c in range(3)]
    np.testing.assert_allclose(sampled(field, points), np.stack(expected, axis=1), atol=1e-12)
