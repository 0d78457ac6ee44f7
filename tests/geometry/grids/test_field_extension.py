# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.grids.field_extension import extended

RANDOM = np.random.default_rng(4)


@pytest.mark.parametrize("shape", [(24, 17, 9), (8, 8, 8), (3, 5, 2)])
def test_constant_fields_stay_constant(shape):
    weights = np.zeros(shape)
    weights[1, 2, 1] = 0.4
    weights[2, 3, 0] = 1.0
    values = np.where(weights[..., None] > 0, (1.5, -2.0), 1e6)
    found = extended(values, weights)
    assert found.shape == values.shape
    np.testing.assert_allclose(found, np.broadcast_to((1.5, -2.0), found.shape), atol=1e-9)


def test_the_nearest_value_has_the_largest_weight():
    weights = np.zeros((40, 12, 12))
    weights[4:8, 4:8, 4:8] = weights[32:36, 4:8, 4:8] = 1.0
    values = np.where(np.arange(40)[:, None, None, None] < 20, 1.0, -1.0) * weights[..., None]
    found = extended(values, weights)[..., 0]
    assert (found[5:7, 5:7, 5:7] > 0.99).all()
    assert (found[33:35, 5:7, 5:7] < -0.99).all()
    assert (np.diff(found[6:34, 6, 6]) <= 1e-9).all()
    assert abs(found[19:21, 6, 6].mean()) < 1e-9
    assert np.abs(np.diff(found, axis=0)).max() < 0.5


def test_values_stay_within_the_known_range():
    weights = RANDOM.uniform(size=(16, 12, 20)) * (RANDOM.uniform(size=(16, 12, 20)) > 0.9)
    values = RANDOM.uniform(-3.0, 2.0, (16, 12, 20, 1))
    found = extended(values, weights)
    assert found.min() >= -3.0
    assert found.max() <= 2.0
