# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Barycenters of images compared with another library."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.transport import Grid, barycenter
from tests.transport.gaussians import gaussian


def images(count, size):
    """Uneven patches separated by empty cells."""
    rng = np.random.default_rng(1)
    found = []
    for _ in range(count):
        center = rng.uniform(0.35, 0.65, 2) * size
        patch = gaussian((size, size), center, rng.uniform(2.0, 4.0) ** 2) * (0.2 + rng.random((size, size)))
        found.append(patch * (patch > 1e-3 * patch.max()))
    return np.array(found)


@pytest.mark.parametrize("count", [1, 2, 3, 10])
def test_agrees_with_python_optimal_transport(count):
    """Its kernel is exp(-d^2 / reg) with the image's axes from 0 to 1: reg = 2 (sigma / (size - 1))^2.

    Measured: 2e-8 of the mass.
    """
    with np.errstate(all="ignore"):
        ot = pytest.importorskip("ot")
    size, sigma = 32, 1.6
    mus = images(count, size)
    weights = np.random.default_rng(count).dirichlet(np.ones(count))
    theirs = ot.bregman.convolutional_barycenter2d(
        mus / mus.sum(axis=(1, 2), keepdims=True),
        2.0 * (sigma / (size - 1)) ** 2,
        weights=weights,
        numItermax=3000,
        stopThr=1e-10,
        warn=False,
    )
    ours = barycenter(mus, weights, Grid((size, size), sigma), tolerance=1e-7, max_iterations=1500)
    assert ours.converged
    assert np.abs(ours.density / size**2 - theirs / theirs.sum()).sum() < 1e-7


@pytest.mark.parametrize("corner", [0, 2])
def test_a_corner_of_the_simplex_and_inputs_without_weight(corner):
    """An input of weight zero has no effect: the result is the barycenter of the others."""
    mus, grid = images(3, 32), Grid((32, 32), 1.6)
    with_third = barycenter(mus, [0.4, 0.6, 0.0], grid)
    np.testing.assert_array_equal(with_third.density, barycenter(mus[:2], [0.4, 0.6], grid).density)
    np.testing.assert_array_equal(with_third.active, [0, 1])
    alone = barycenter(mus, np.eye(3)[corner], grid, tolerance=1e-9, max_iterations=1000).density
    # The plan of a single input has a free end: it is the kernel, normalized near walls by the mass that stays inside.
    expected = grid.apply(mus[corner] / grid.apply(np.ones((32, 32))))
    np.testing.assert_allclose(alone, expected / expected.mean(), atol=1e-7)
