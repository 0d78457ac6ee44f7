# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Samples of a path between those that were computed."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.one_mesh.refined_samples import RefinedPath, with_middles


def test_cubic_paths_are_exact():
    coefficients = np.random.default_rng(2).normal(size=(4, 5, 3))
    path = np.polynomial.polynomial.polyval(np.linspace(0.0, 1.0, 6), coefficients)
    found = with_middles(np.moveaxis(path, -1, 0))
    expected = np.polynomial.polynomial.polyval(np.linspace(0.0, 1.0, 11), coefficients)
    np.testing.assert_allclose(found, np.moveaxis(expected, -1, 0), atol=1e-12)


def test_a_swing_of_120_degrees_takes_sixteen_steps():
    def arc(count):
        angles = np.linspace(0.0, np.radians(120.0), count)
        return np.stack([np.cos(angles), np.sin(angles)], axis=1)[:, None]

    away = np.linalg.norm(with_middles(arc(17)) - arc(33), axis=2)
    step = np.radians(120.0) / 16
    assert away[3:-3].max() == pytest.approx(3.0 / 128.0 * step**4, rel=0.05)
    assert away.max() == pytest.approx(5.0 / 128.0 * step**4, rel=0.1)


def test_refined_paths_are_means_of_their_samples():
    samples = np.random.default_rng(3).normal(size=(9, 20, 3))
    path = RefinedPath.of(samples, 2)
    assert len(path) == 33
    np.testing.assert_allclose(path.mean(path.weights), with_middles(with_middles(samples)), atol=1e-14)
    np.testing.assert_array_equal(path.mean(path.weights[::4]), samples)
