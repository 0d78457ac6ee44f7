# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Large products computed by NumPy are recorded; test_installed.py finds none in the whole extension."""

from __future__ import annotations

import numpy as np
import pytest

from tests.large_products import is_large_product, noted_products


@pytest.mark.parametrize(
    "multiply",
    [
        lambda a: a @ a,
        lambda a: np.matmul(a, a),
        lambda a: np.dot(a, a),
        lambda a: np.tensordot(a, a, 1),
        lambda a: np.einsum("ij,jk->ik", a, a, optimize=True),
        lambda a: np.linalg.solve(a, a),
        lambda a: np.linalg.eigh(a),
    ],
)
def test_large_products_are_recorded(multiply):
    square = np.eye(64)
    with noted_products() as noted:
        before = multiply(square)
    assert len(noted) == 1
    np.testing.assert_array_equal(np.asarray(multiply(square)[0]), np.asarray(before[0]))
    assert len(noted) == 1


def test_small_and_narrow_products_are_ignored():
    points, turn = np.ones((100_000, 3)), np.eye(3)
    with noted_products() as noted:
        assert (points @ turn).shape == points.shape
        assert np.ones(1000) @ np.ones((1000, 1000)) is not None
    assert noted == []
    assert not is_large_product((4,), (4,))
