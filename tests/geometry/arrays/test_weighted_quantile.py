# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Quantiles of weighted values, compared with a sorted list that repeats each value as often as its weight."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.arrays.weighted_quantile import weighted_quantile


@pytest.mark.parametrize("share", [0.0, 0.3, 0.5, 0.95, 1.0])
def test_integer_weights_act_like_repeated_values(share):
    rng = np.random.default_rng(4)
    values, weights = rng.normal(size=40), rng.integers(1, 6, size=40).astype(float)
    repeated = np.sort(np.repeat(values, weights.astype(int)))

    expected = np.quantile(repeated, share, method="inverted_cdf")

    assert weighted_quantile(values, weights, share) == expected


def test_values_with_weight_zero_are_ignored():
    assert weighted_quantile(np.array([5.0, 1.0, 9.0]), np.array([1.0, 1.0, 0.0]), 1.0) == 5.0
