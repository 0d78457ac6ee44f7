# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.grid_halving import doubled, halved

RANDOM = np.random.default_rng(6)


@pytest.mark.parametrize("shape", [(8, 6, 4), (7, 5, 3, 2), (1, 1, 1)])
def test_sums_are_kept(shape):
    field = RANDOM.uniform(size=shape)
    np.testing.assert_allclose(halved(field).sum() * 8.0, field.sum())
    assert halved(field).shape[:3] == tuple((size + 1) // 2 for size in shape[:3])


def test_linear_fields_stay_linear_inside():
    centers = np.moveaxis(np.indices((10, 8, 12)), 0, -1) + 0.5
    field = centers @ (1.0, -2.0, 0.5)
    np.testing.assert_allclose(
        halved(field), 2.0 * (np.moveaxis(np.indices((5, 4, 6)), 0, -1) + 0.5) @ (1.0, -2.0, 0.5)
    )
    found = doubled(halved(field), field.shape)
    np.testing.assert_allclose(found[1:-1, 1:-1, 1:-1], field[1:-1, 1:-1, 1:-1])


def test_odd_sides_are_restored():
    assert doubled(np.ones((4, 3, 2, 5)), (7, 5, 3)).shape == (7, 5, 3, 5)


def test_other_axes_are_left_alone():
    field = RANDOM.uniform(size=(6, 5, 4))
    flat = halved(field, dimensions=2)
    assert flat.shape == (3, 3, 4)
    np.testing.assert_allclose(flat[1, 1], field[2:4, 2:4].mean(axis=(0, 1)))
