# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.blend_weights import normalized_weights
from convwass_addon.errors import InputError


def test_weights_are_scaled_to_sum_one():
    given = [3, 0, 1]
    np.testing.assert_array_equal(normalized_weights(given, 3), [0.75, 0.0, 0.25])
    assert given == [3, 0, 1]


@pytest.mark.parametrize(
    ("weights", "message"),
    [
        ([1.0], "each of the 2 inputs, but there are 1"),
        ([[1.0, 2.0]], "one weight for each"),
        ([1.0, -0.5], "zero or positive numbers"),
        ([1.0, np.nan], "zero or positive numbers"),
        ([np.inf, 1.0], "zero or positive numbers"),
        ([0.0, 0.0], "All weights are zero"),
        ([1e308, 1e308], "too large to be added"),
    ],
)
def test_invalid_weights_are_refused(weights, message):
    with pytest.raises(InputError, match=message):
        normalized_weights(weights, 2)
