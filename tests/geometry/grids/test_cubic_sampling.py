# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np

from convwass_addon.geometry.grids.cubic_sampling import cubic_samples

SHAPE = (9, 8, 7)
PLACES = np.stack(np.meshgrid(*[np.arange(n, dtype=float) for n in SHAPE], indexing="ij"), axis=-1)


def points(count, seed):
    return 1.0 + np.random.default_rng(seed).random((count, 3)) * (np.array(SHAPE) - 3.0)


def quadratic(place):
    x, y, z = np.moveaxis(place, -1, 0)
    return 0.3 * x * x - 0.2 * y * z + 0.1 * z * z + x - 2.0 * y + 0.5


def test_polynomials_of_second_degree_are_exact():
    at = points(3000, seed=1)
    found = cubic_samples(quadratic(PLACES).astype(np.float32), at)
    np.testing.assert_allclose(found.values, quadratic(at), atol=2e-5)
    x, y, z = at.T
    np.testing.assert_allclose(
        found.gradients, np.stack([0.6 * x + 1.0, -0.2 * z - 2.0, 0.2 * z - 0.2 * y], axis=1), atol=5e-5
    )


def test_samples_are_interpolated():
    field = np.random.default_rng(2).random(SHAPE).astype(np.float32)
    inner = PLACES[1:-1, 1:-1, 1:-1].reshape(-1, 3)
    np.testing.assert_allclose(cubic_samples(field, inner).values, field[1:-1, 1:-1, 1:-1].ravel(), atol=1e-6)


def test_gradients_agree_with_the_values():
    field = np.random.default_rng(3).random(SHAPE).astype(np.float32)
    at, step = points(200, seed=4), 1e-2
    found = cubic_samples(field, at).gradients
    for axis, move in enumerate(np.eye(3) * step):
        ahead, behind = (cubic_samples(field, at + side * move).values for side in (1, -1))
        np.testing.assert_allclose(found[:, axis], (ahead - behind) / (2 * step), atol=5e-3)
